"""Meshes of all scenes (pywrap/lithofrac/scenes/)."""

import subprocess
import sys
from collections import Counter

import numpy as np
import pytest

from lithofrac.scenes import _gmsh
from lithofrac.scenes._rectangle import rectangle

pytestmark = pytest.mark.no_core

SCENES = [
    "single_element_sandstone",
    "sandstone_triaxial_p00",
    "sandstone_plane_strain_k02_p00",
    "sandstone_soft_p00",
    "sandstone_plane_strain_p00",
    "punch_gf60",
    "brazilian",
    "hole_r06.4",
    "hole_block150_r31.0",
    "kirsch",
    "bar_wave",
]
ARC = np.radians(6.0)
AREA_mm2 = {
    "single_element_sandstone": 0.125,
    "sandstone_triaxial_p00": 5 * 15,
    "sandstone_plane_strain_k02_p00": 10 * 30,
    "sandstone_soft_p00": 10 * 30 + 2 * 14 * 5,
    "sandstone_plane_strain_p00": 10 * 30 + 2 * 9.9 * 10 + 2 * 30 * 10,
    "punch_gf60": 80 * 80 + 10 * 1 + 12 * 10 + 2 * 80 * 10,
    # without the segments beyond the flats of 6 degrees, with the platens
    "brazilian": 20**2 * (np.pi - ARC + np.sin(ARC)) + 2 * (40 * np.sin(ARC / 2) + 6) * 5,
    "hole_r06.4": 6.4**2 * (8 * 4 - np.pi / 2 + 8.2),
    "hole_block150_r31.0": 150 * 75 - np.pi * 31**2 / 2 + 155 * 25,
    "kirsch": 100**2 - np.pi * 25**2 / 4,
    "bar_wave": 5 * 100,
}


@pytest.fixture(params=SCENES)
def name(request):
    return request.param


@pytest.fixture
def mesh(name, problem_of):
    return problem_of(name)[1].mesh


def test_triangles_are_counter_clockwise_and_cover_the_scene(name, mesh):
    assert (mesh.areas() > 0).all()
    # polygons along arcs differ a little from them
    tolerance = 1e-12 if name.startswith(("s", "p", "bar")) else 1e-3
    assert mesh.areas().sum() * 1e6 == pytest.approx(AREA_mm2[name], rel=tolerance)


def test_edge_sets_are_the_whole_boundary_with_material_on_the_left(mesh):
    sides = Counter()
    for i in range(3):
        sides.update(map(tuple, mesh.triangles[:, [i, (i + 1) % 3]].tolist()))
    boundary = {(a, b) for a, b in sides if (b, a) not in sides}
    named = [tuple(edge) for edges in mesh.edge_sets.values() for edge in edges.tolist()]
    assert len(named) == len(set(named))
    assert set(named) == boundary


def test_every_node_belongs_to_a_triangle(mesh):
    assert np.array_equal(np.unique(mesh.triangles), np.arange(len(mesh.nodes)))


def test_elements_are_sorted_by_their_lowest_node(mesh):
    assert (np.diff(mesh.triangles.min(axis=1)) >= 0).all()


def test_neighbours_in_the_mesh_are_neighbours_in_memory(mesh):
    spread = np.ptp(mesh.triangles, axis=1).max()
    assert spread <= 3 * np.sqrt(len(mesh.nodes)) + 2


def test_triangles_are_well_shaped(mesh):
    sides = np.linalg.norm(
        mesh.nodes[mesh.triangles] - mesh.nodes[np.roll(mesh.triangles, 1, axis=1)], axis=2
    )
    altitude = 2 * mesh.areas() / sides.max(axis=1)
    assert (altitude / sides.max(axis=1)).min() > 0.4  # 0.87 is equilateral


@pytest.mark.parametrize("name", ["sandstone_triaxial_p00", "kirsch"])
def test_a_seed_gives_always_the_same_mesh_and_another_seed_another_one(name, problem_of):
    script = (
        "from lithofrac.config import find_case; from lithofrac.scenes import make_mesh;"
        f"m = make_mesh(find_case('{name}'), 1);"
        "print(m.nodes.tobytes().hex() + m.triangles.tobytes().hex())"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    first, second = (problem_of(name, seed)[1].mesh for seed in (1, 2))
    assert done.stdout.strip() == first.nodes.tobytes().hex() + first.triangles.tobytes().hex()
    same = len(first.nodes) == len(second.nodes) and np.allclose(first.nodes, second.nodes)
    assert not same
    assert len(second.triangles) == pytest.approx(len(first.triangles), rel=0.03)


def test_element_size_is_the_nominal_one(problem_of):
    mesh = problem_of("sandstone_plane_strain_k02_p00")[1].mesh
    sides = np.linalg.norm(
        mesh.nodes[mesh.triangles] - mesh.nodes[np.roll(mesh.triangles, 1, axis=1)], axis=2
    )
    assert sides.mean() == pytest.approx(0.5e-3, rel=0.05)


def test_elements_of_the_hole_grow_from_wall_to_face(problem_of):
    mesh = problem_of("kirsch")[1].mesh
    assert np.hypot(*mesh.nodes[mesh.nodes_of("hole")].T) == pytest.approx(25e-3, rel=1e-9)

    def mean_length(name):
        ends = mesh.nodes[mesh.edge_sets[name]]
        return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean()

    assert mean_length("hole") == pytest.approx(25e-3 / 12, rel=0.1)
    assert mean_length("top") == pytest.approx(25e-3 / 3, rel=0.15)


def test_blocks_of_any_radius_have_the_same_mesh(problem_of):
    small, large = (problem_of(name)[1].mesh for name in ("hole_r01.6", "hole_r31.0"))
    assert np.array_equal(small.triangles, large.triangles)
    np.testing.assert_allclose(small.nodes / 1.6, large.nodes / 31.0, rtol=0, atol=1e-15)


def test_elements_of_the_punch_are_small_in_and_under_the_strip(problem_of):
    mesh = problem_of("punch_gf60")[1].mesh
    rock = mesh.body == 0
    away = np.hypot(*(mesh.centroids()[rock] - [0.04, 0.08]).T)
    size = np.sqrt(mesh.areas()[rock] * 4 / np.sqrt(3))
    assert size[away < 15e-3].mean() == pytest.approx(1e-3, rel=0.1)
    assert size[away > 75e-3].mean() == pytest.approx(4e-3, rel=0.15)
    ends = mesh.nodes[mesh.edge_sets["strip"]]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) == pytest.approx(1e-3, rel=0.1)


def test_structured_rectangles_have_equal_triangles_and_seeds_move_inner_nodes_only():
    regular, moved = (rectangle(2.0, 3.0, 0.5, True, seed) for seed in (1, 2))
    assert regular.areas() == pytest.approx(np.full(48, 0.125))
    assert (moved.areas() > 0).all()
    assert moved.areas().std() > 0.005
    assert moved.areas().sum() == pytest.approx(6.0, rel=1e-14)


def test_a_mesher_that_fails_is_reported_with_its_last_words():
    with pytest.raises(_gmsh.MeshError, match=r"^gmsh gave no "):
        _gmsh.mesh_from("Nonsense(1) = {;\n")


def test_a_missing_mesher_is_reported(monkeypatch, tmp_path):
    monkeypatch.setattr(_gmsh.sys, "executable", str(tmp_path / "python"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(_gmsh.MeshError, match=r"^gmsh is not installed"):
        _gmsh.mesh_from("")
