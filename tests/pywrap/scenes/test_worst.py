"""A longer step for graded meshes (pywrap/lithofrac/scenes/_worst.py)."""

import numpy as np
import pytest

from lithofrac.config import find_case
from lithofrac.core import Run
from lithofrac.scenes import make, punch
from lithofrac.scenes._rectangle import rectangle
from lithofrac.scenes._worst import improved


@pytest.fixture(scope="module")
def mesh():
    return rectangle(6.0, 6.0, 1.0, structured=True, seed=1)


def boundary_of(mesh):
    return np.unique(np.concatenate(list(mesh.edge_sets.values())))


def altitudes(nodes, triangles):
    corners = nodes[triangles]
    sides = corners - np.roll(corners, 1, axis=1)
    ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.abs(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])
    return area / np.linalg.norm(sides, axis=2).max(axis=1)


@pytest.mark.no_core
def test_a_displaced_node_comes_back_and_the_boundary_stays(mesh):
    boundary = boundary_of(mesh)
    inner = np.setdiff1d(np.arange(len(mesh.nodes)), boundary)
    disturbed = mesh.nodes.copy()
    disturbed[inner[7]] += [0.5, -0.2]
    found = improved(disturbed, mesh.triangles, boundary)
    before = altitudes(mesh.nodes, mesh.triangles).min()
    assert altitudes(disturbed, mesh.triangles).min() < 0.8 * before
    assert altitudes(found, mesh.triangles).min() > 0.95 * before
    assert np.array_equal(found[boundary], mesh.nodes[boundary])


@pytest.mark.no_core
def test_triangles_may_run_either_way_round(mesh):
    disturbed = mesh.nodes.copy()
    disturbed[np.setdiff1d(np.arange(len(mesh.nodes)), boundary_of(mesh))[7]] += [0.5, -0.2]
    found = improved(disturbed, mesh.triangles, boundary_of(mesh))
    turned = improved(disturbed, mesh.triangles[:, ::-1], boundary_of(mesh))
    assert altitudes(turned, mesh.triangles).min() == pytest.approx(
        altitudes(found, mesh.triangles).min(), rel=0.05
    )


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_step_of_a_punch_is_a_sixth_longer(seed, monkeypatch):
    """And where elements grow is as it was: the areas of almost all are the same."""
    case = find_case("punch_gf60", None, {})
    after = make.make_mesh(case, seed)
    monkeypatch.setattr(punch, "improved", lambda nodes, *rest: nodes)
    before = make.make_mesh(case, seed)
    longer = step_of(case, after) / step_of(case, before)
    assert longer > 7 / 6
    change = np.sort(after.areas()) / np.sort(before.areas()) - 1
    assert np.median(abs(change)) < 0.01


def step_of(case, mesh):
    return Run(make.make_problem(case, mesh)).critical_step[0]
