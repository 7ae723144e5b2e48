"""Geometries of one's own: meshes, groups and loads (scenes/gmsh_file.py)."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from own_geometry import (
    APART,
    CAP,
    GROUPS,
    KIRSCH_LOADING,
    MSH,
    OWN,
    SQUARE,
    by_gmsh,
    hole_as_geo,
    same,
)

from lithofrac.config import ConfigError, find_case, load_case
from lithofrac.config.setting import text_of
from lithofrac.scenes import make_mesh, make_problem

pytestmark = pytest.mark.no_core


def test_physical_groups_are_bodies_and_boundaries(case_of):
    mesh = make_mesh(case_of(SQUARE + GROUPS + CAP))
    assert mesh.body_names == ("rock", "cap")
    areas = [1e6 * mesh.areas()[mesh.body == i].sum() for i in (0, 1)]
    assert areas == pytest.approx([200.0, 50.0], rel=1e-12)
    assert set(mesh.edge_sets) == {"bottom", "right", "top", "back"}
    assert mesh.nodes[mesh.nodes_of("back"), 1] == pytest.approx(25e-3, rel=1e-15)
    sides = {(int(t[i]), int(t[(i + 1) % 3])) for t in mesh.triangles for i in range(3)}
    assert {tuple(edge) for edge in mesh.edge_sets["right"].tolist()} <= sides


def test_bodies_share_the_nodes_of_shared_curves_and_no_others(case_of):
    for text, shared in ((CAP, True), (APART, False)):
        mesh = make_mesh(case_of(SQUARE + GROUPS + text))
        rock, cap = (np.unique(mesh.triangles[mesh.body == i]) for i in (0, 1))
        both = np.intersect1d(rock, cap)
        assert np.array_equal(both, mesh.nodes_of("top") if shared else [])


@pytest.mark.parametrize(("unit", "height"), [("mm", 20e-3), ("cm", 0.2), ("m", 20.0)])
def test_lengths_are_in_the_unit_that_is_named(case_of, unit, height):
    mesh = make_mesh(case_of(SQUARE + GROUPS, scene__length_unit=unit))
    assert np.ptp(mesh.nodes[:, 1]) == pytest.approx(height, rel=1e-15)


@pytest.mark.parametrize(
    "options", [("-format", "msh22"), ("-format", "msh41"), ("-format", "msh41", "-bin")]
)
def test_a_mesh_file_is_read_as_it_is(case_of, tmp_path, options):
    whole = make_mesh(case_of(SQUARE + GROUPS + CAP))
    geo = "Mesh.Algorithm = 6;\nMesh.Smoothing = 10;\n" + SQUARE + GROUPS + CAP
    case = case_of("", MSH, name="own.msh")
    by_gmsh(geo, tmp_path / "own.msh", *options)
    read = make_mesh(case)
    if "msh22" in options:
        same(read, whole)
    assert read.areas().sum() == pytest.approx(whole.areas().sum(), rel=1e-12)
    assert read.edge_sets["top"].shape == whole.edge_sets["top"].shape


def test_a_curve_in_two_groups_needs_format_2(case_of, tmp_path):
    """meshio keeps one group of each curve of format 4."""
    case = case_of("", MSH, name="own.msh")
    geo = SQUARE + GROUPS + 'Physical Curve("ends") = {1, 3};\n'
    by_gmsh(geo, tmp_path / "own.msh", "-format", "msh22")
    sets = make_mesh(case).edge_sets
    both = np.concatenate([sets["bottom"], sets["top"]])
    assert np.array_equal(np.unique(sets["ends"], axis=0), np.unique(both, axis=0))
    by_gmsh(geo, tmp_path / "own.msh", "-format", "msh41")
    with pytest.raises(ConfigError, match=r"is empty; in format 4 .* expected format 2\.2$"):
        make_mesh(case)


def test_a_mesh_file_has_one_realisation(case_of, tmp_path):
    case = case_of("", MSH, name="own.msh")
    by_gmsh(SQUARE + GROUPS, tmp_path / "own.msh")
    with pytest.raises(ConfigError, match=r"^mesh\.seed = 2: a \.msh is one mesh, expected 1$"):
        make_mesh(case, 2)


def test_a_built_in_scene_written_as_a_geo_has_the_same_bits(case_of, monkeypatch):
    built_in = find_case("kirsch")
    mesh, geo = hole_as_geo(built_in, monkeypatch)
    text = OWN.split("loading")[0] + KIRSCH_LOADING
    material = {"extends": "tyndall_limestone", "elastic": True}
    own = case_of(geo, text, scene__length_unit="m", material=material)
    same(make_mesh(own), mesh)
    a, b = make_problem(own, mesh), make_problem(built_in, mesh)
    assert (a.end_time, a.damping, a.materials) == (b.end_time, b.damping, b.materials)
    for own_load, load in zip(a.pressure_loads, b.pressure_loads, strict=True):
        assert np.array_equal(own_load.edges, load.edges)
        assert (own_load.pressure, own_load.ramp) == (load.pressure, load.ramp)
    for own_load, load in zip(a.velocity_loads, b.velocity_loads, strict=True):
        assert np.array_equal(own_load.nodes, load.nodes)
        assert (own_load.component, own_load.speed) == (load.component, load.speed)


def test_a_seed_gives_always_the_same_mesh_and_another_seed_another_one(case_of):
    fine = SQUARE.replace("0, 3}", "0, 0.8}") + GROUPS
    case = case_of(fine)
    first, second = make_mesh(case), make_mesh(case, 2)
    same(make_mesh(case), first)
    same(make_mesh(case, 2), second)
    alike = len(first.nodes) == len(second.nodes) and np.allclose(first.nodes, second.nodes)
    assert not alike
    assert len(second.triangles) == pytest.approx(len(first.triangles), rel=0.08)


def test_loads_are_held_pressed_and_driven_in_turn(case_of):
    loading = """\
loading:
  kind: boundaries
  held: {bottom: xy}
  pressed_MPa: {right: 5}
  driven: {top: {x_mm: 0.05, y_mm: -0.1}}
  speed_m_s: 0.02
  ramp_transits: 10
"""
    case = case_of(SQUARE + GROUPS, OWN.split("loading")[0] + loading)
    problem = make_problem(case, make_mesh(case))
    loads = {load.name: load for load in problem.velocity_loads}
    assert set(loads) == {"bottom_x", "bottom_y", "top_x", "top_y"}
    speeds = {name: load.speed for name, load in loads.items()}
    assert speeds == {"bottom_x": 0.0, "bottom_y": 0.0, "top_x": 0.01, "top_y": -0.02}
    (pressure,) = problem.pressure_loads
    ramp = 10 * 20e-3 / case.material.wave_speed
    assert (pressure.pressure, pressure.ramp.start) == (5e6, 0.0)
    assert pressure.ramp.duration == pytest.approx(ramp, rel=1e-12)
    start = loads["top_y"].ramp.start
    assert start == pressure.ramp.duration
    assert problem.end_time == pytest.approx(start + ramp / 2 + 0.1e-3 / 0.02, rel=1e-12)
    assert problem.measures is None


def test_the_axial_measure_is_that_of_the_named_curve(case_of):
    driven = {"driven": {"top": {"x_mm": 0, "y_mm": -0.1}}, "speed_m_s": 0.02, "axial": "top"}
    loading = {"kind": "boundaries", "held": {"bottom": "xy"}, **driven}
    keys = {"scene__materials": {"cap": "steel"}, "contact": {}}
    case = case_of(SQUARE + GROUPS + APART, loading=loading, **keys)
    measures = make_problem(case, make_mesh(case)).measures
    assert measures.axial_load == "top_y"
    assert (measures.area, measures.length) == pytest.approx((10e-3, 25e-3), rel=1e-12)


def test_a_node_that_two_curves_hold_is_held_once(case_of):
    loading = {"kind": "boundaries", "held": {"bottom": "xy", "right": "x"}}
    case = case_of(SQUARE + GROUPS, loading=loading | {"pressed_MPa": {"top": 1}})
    problem = make_problem(case, make_mesh(case))
    held = [(int(n), load.component) for load in problem.velocity_loads for n in load.nodes]
    assert len(held) == len(set(held))


def test_bodies_have_their_own_materials_and_friction(case_of):
    case = case_of(
        SQUARE + GROUPS + APART,
        scene__materials={"cap": "steel"},
        contact={"friction": {"rock-cap": 0.1, "rock-rock": 1.2}},
    )
    problem = make_problem(case, make_mesh(case))
    assert [material.title.split()[0] for material in problem.materials] == ["Sandstone", "Steel"]
    assert problem.contact.table(problem.mesh)[0].tolist() == [1.2, 0.1]


def test_the_file_and_materials_stand_beside_the_file_that_names_them(case_of, tmp_path):
    case_of(SQUARE + GROUPS + CAP)
    (tmp_path / "soft.yaml").write_text(Path("configs/materials/sandstone.yaml").read_text())
    (tmp_path / "child").mkdir()
    child = tmp_path / "child" / "child.yaml"
    child.write_text("extends: ../own\nscene: {materials: {cap: ../soft.yaml}}\n")
    case = load_case(child)
    assert case.scene.path.resolve() == tmp_path / "own.geo"
    assert case.scene.materials["cap"].young == 28e9


def test_a_case_written_back_is_the_same_case(case_of, tmp_path):
    case = case_of(SQUARE + GROUPS + APART, scene__materials={"cap": "steel"})
    (tmp_path / "again.yaml").write_text(text_of(case))
    assert load_case(tmp_path / "again.yaml") == case


@pytest.mark.parametrize("name", ["two_holes", "stope"])
def test_the_examples_are_right(name):
    case = load_case(Path(f"configs/examples/{name}.yaml"))
    problem = make_problem(case, make_mesh(case))
    assert problem.fracture is not None
    assert len(problem.mesh.triangles) < 12_000


def test_gmsh_is_not_imported():
    code = "import sys, lithofrac.scenes; sys.exit('gmsh' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
