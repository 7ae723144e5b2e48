"""Runs of geometries of one's own: patches of two bodies, forces, bits, results folders."""

import numpy as np
import pandas as pd
import pytest
from own_geometry import APART, CAP, GROUPS, KIRSCH_LOADING, SQUARE, beside, hole_as_geo, sized

from lithofrac.cli import main
from lithofrac.config import find_case, load_case
from lithofrac.core import Run
from lithofrac.problem import Mesh
from lithofrac.run import simulate
from lithofrac.scenes import make_mesh, make_problem

pytestmark = pytest.mark.verification

BLOCK = sized(SQUARE + GROUPS + 'Physical Curve("left") = {4};\n', 2.5)
BONDED, LOOSE = sized(CAP, 2.5), sized(APART, 2.5)
CASE = """\
title: Two blocks
material: {extends: sandstone, elastic: true}
scene:
  kind: gmsh_file
  file: own.geo
  length_unit: mm
  materials: {cap: {extends: sandstone, elastic: true}}
contact: {default_friction: 0.5}
loading: {kind: boundaries, held: {bottom: y, left: x}, pressed_MPa: {back: 5}, hold_transits: 60}
damping: {relative_to: ground}  # the affine motion of a body rings long
output: {records: 50, fields: 0}
"""


@pytest.fixture
def case_file(tmp_path):
    """case_file(geo, case): path of a case beside its geometry."""

    return lambda geo, case=CASE: beside(tmp_path, geo, case)


@pytest.mark.parametrize("between", [BONDED, LOOSE], ids=["bonded", "contact"])
def test_two_bodies_carry_one_stress(case_file, tmp_path, between):
    case = load_case(case_file(BLOCK + between))
    problem = make_problem(case, make_mesh(case))
    simulate(problem, tmp_path / "out")
    force = pd.read_parquet(tmp_path / "out" / "history.parquet")["bottom_y_force_N"]
    assert force.iloc[-1] == pytest.approx(5e6 * 10e-3, rel=2e-3)  # the floor pushes upwards
    run = Run(problem)
    run.advance(int(problem.end_time / run.dt))
    stress = run.elements(np.arange(len(problem.mesh.triangles))).stress
    assert stress[:, 1] == pytest.approx(-5e6, rel=0.01)
    assert np.abs(stress[:, [0, 3]]).max() < 0.01 * 5e6


def test_a_built_in_scene_written_as_a_geo_runs_to_the_same_bits(case_file, monkeypatch):
    built_in = find_case("kirsch", None, {"scene.wall_elements_per_radius": 4})
    mesh, geo = hole_as_geo(built_in, monkeypatch)
    text = CASE.split("contact")[0].replace("  materials: {cap: {extends: sandstone, elastic", "#")
    text = text.replace("sandstone", "tyndall_limestone").replace("unit: mm", "unit: m")
    own = load_case(case_file(geo, text + KIRSCH_LOADING))
    states = []
    for case, its_mesh in ((built_in, mesh), (own, make_mesh(own))):
        run = Run(make_problem(case, its_mesh))
        run.advance(500)
        states.append((run.energy(), run.elements(np.arange(len(mesh.triangles))).stress))
    assert states[0][0] == states[1][0]
    assert np.array_equal(states[0][1], states[1][1])


def test_a_driven_curve_gives_force_and_way(case_file, tmp_path):
    driven = "driven: {back: {y_mm: -0.01}}, speed_m_s: 0.1, axial: back, ramp_transits: 5"
    text = CASE.replace("pressed_MPa: {back: 5}, hold_transits: 60", driven)
    case = load_case(case_file(BLOCK + BONDED, text))
    problem = make_problem(case, make_mesh(case))
    simulate(problem, tmp_path / "out")
    last = pd.read_parquet(tmp_path / "out" / "history.parquet").iloc[-1]
    step = Run(problem).dt
    assert last["back_y_displacement_mm"] == pytest.approx(-0.01, abs=1e3 * 0.1 * step)
    assert last["axial_strain"] == pytest.approx(0.01 / 25, rel=1e-2)
    assert last["axial_stress_MPa"] == pytest.approx(-last["back_y_force_N"] / 10e-3 / 1e6)
    stiffness = 28e3 / (1 - 0.25**2)  # MPa, free sides in plane strain
    assert last["axial_stress_MPa"] == pytest.approx(stiffness * 0.01 / 25, rel=0.1)


def test_a_results_folder_holds_its_geometry_and_runs_again(case_file, tmp_path, capsys):
    path = case_file(BLOCK + LOOSE, CASE.replace("hold_transits: 60", "hold_transits: 1"))
    first, again = tmp_path / "first", tmp_path / "again"
    assert main(["run", str(path), "--out", str(first), "--quiet"]) == 0
    path.with_name("own.geo").unlink()
    assert (first / "geometry.geo").read_text() == BLOCK + LOOSE
    assert main(["run", str(first / "case.yaml"), "--out", str(again), "--quiet"]) == 0
    a, b = (Mesh.load(folder / "mesh.npz") for folder in (first, again))
    assert np.array_equal(a.nodes, b.nodes)
    tables = [pd.read_parquet(folder / "history.parquet") for folder in (first, again)]
    pd.testing.assert_frame_equal(*tables, check_exact=True)
    (tmp_path / "third.yaml").write_text(CASE.replace("own.geo", str(again / "geometry.geo")))
    capsys.readouterr()
    assert main(["run", str(tmp_path / "third.yaml"), "--out", str(again)]) == 2
    assert "the run would replace its geometry" in capsys.readouterr().err
    assert (again / "geometry.geo").exists()
    assert (again / "summary.json").exists()


def test_what_a_file_lacks_is_said_with_the_name_of_the_case(case_file, tmp_path, capsys):
    path = case_file((BLOCK + LOOSE).replace('Curve("back")', 'Curve("beck")'))
    assert main(["run", str(path), "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: {path}: loading.pressed_MPa.back: no such physical curve, did you mean "
        "'beck'?\n"
    )
    assert not (tmp_path / "out").exists()
    case_file("Point(1) = {0, 0, 0};\nSave 'a.msh';\n")
    assert main(["check", str(path)]) == 2
    assert capsys.readouterr().err.startswith(
        f"lithofrac: {path}: scene.file = {path.with_name('own.geo')}: line 2: the word Save is "
    )


@pytest.fixture(scope="module")
def cracks_of(tmp_path_factory):
    """cracks_of(name): middles (n, 2) [m] of the cracks of an example, in their order in time."""

    def ran(name):
        case = load_case(f"configs/examples/{name}.yaml")
        out = tmp_path_factory.mktemp(name)
        summary = simulate(make_problem(case, make_mesh(case)), out)
        assert summary["energy_residual"] < 1e-6
        assert summary["contact_unconverged_steps"] < 1e-3 * summary["steps"]
        table = pd.read_parquet(out / "cracks.parquet").sort_values("time_s")
        ends = 1e-3 * table[["x1_mm", "y1_mm", "x2_mm", "y2_mm"]].to_numpy()
        return (ends[:, :2] + ends[:, 2:]) / 2

    return ran


@pytest.mark.slow
def test_the_bridge_between_two_holes_fails_first(cracks_of):
    middles = cracks_of("two_holes")
    assert len(middles) > 50
    assert np.abs(middles[:10]).max() < 9e-3


@pytest.mark.slow
def test_a_stope_cracks_at_its_faces_roof_and_floor(cracks_of):
    x, y = cracks_of("stope").T
    assert np.hypot(x, y).max() < 15.0
    for face in (-10.0, 10.0):
        assert np.any((np.abs(x - face) < 1.0) & (np.abs(y) < 1.0))
    for side in (-1.0, 1.0):
        assert np.any((np.abs(x) < 8.0) & (side * y > 1.0))
