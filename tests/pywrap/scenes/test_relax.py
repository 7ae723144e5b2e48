"""Evening out of uniform meshes (pywrap/lithofrac/scenes/_relax.py)."""

import numpy as np
import pytest

from lithofrac.scenes._rectangle import rectangle
from lithofrac.scenes._relax import relaxed

pytestmark = pytest.mark.no_core


def test_a_regular_mesh_comes_back_from_a_disturbed_one():
    mesh = rectangle(2.0, 2.0, 1.0, structured=True, seed=1)  # one inner node
    boundary = np.unique(np.concatenate(list(mesh.edge_sets.values())))
    inner = np.setdiff1d(np.arange(9), boundary)
    disturbed = mesh.nodes.copy()
    disturbed[inner] += [0.2, -0.1]
    back = relaxed(disturbed, mesh.triangles, boundary)
    assert back == pytest.approx(mesh.nodes, abs=1e-3)
    assert np.array_equal(back[boundary], mesh.nodes[boundary])


def test_the_smallest_altitude_of_a_specimen_is_above_half_an_element():
    mesh = rectangle(10.0, 30.0, 0.5, structured=False, seed=1)
    sides = np.linalg.norm(
        mesh.nodes[mesh.triangles] - mesh.nodes[np.roll(mesh.triangles, 1, axis=1)], axis=2
    )
    assert (2 * mesh.areas() / sides.max(axis=1)).min() > 0.29
