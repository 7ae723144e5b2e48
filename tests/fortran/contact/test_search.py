"""Candidates of the search (fortran/contact/search.f90)."""

import numpy as np
import pytest
from contact_models import cut_all_edges, join, moved
from models import rectangle

from lithofrac.kernels import boundary_of, contact_candidates

SKIN = 0.3  # over the shortest edge


def by_brute_force(mesh, displacement):
    """All corners and node-edge pairs within the skin."""
    following, shortest = boundary_of(mesh)
    x, reach = mesh.nodes + displacement, SKIN * shortest
    nodes = np.flatnonzero(following >= 0)
    corners, pairs = [], []
    for i in nodes:
        for j in nodes:
            k = following[j]
            if i < j != following[i] and k != i and abs(x[i] - x[j]).max() <= reach:
                corners.append((i, j))
            if i in (j, k):
                continue
            along, arm = x[k] - x[j], x[i] - x[j]
            length = np.hypot(*along)
            across = (arm[0] * along[1] - arm[1] * along[0]) / length
            if abs(across) <= reach and -reach <= arm @ along / length <= length + reach:
                pairs.append((i, j))
    return corners, pairs


@pytest.mark.parametrize("seed", range(5))
def test_the_bins_find_what_a_look_at_every_pair_finds(seed):
    rng = np.random.default_rng(seed)
    rubble = cut_all_edges(rectangle(4, 4, jitter=0.2, seed=seed))
    plate = moved(rectangle(1, 1, 3.0, 1.0), (-1.0, -1.02))
    mesh = join(rubble=rubble, plate=plate)
    displacement = 0.02 * rng.normal(size=mesh.nodes.shape)
    corners, pairs = contact_candidates(mesh, displacement)
    expected_corners, expected_pairs = by_brute_force(mesh, displacement)
    assert [tuple(pair) for pair in corners] == expected_corners
    assert [tuple(pair) for pair in pairs] == expected_pairs
    assert len(corners) > 50
