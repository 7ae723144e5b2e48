"""What is forced on and what must not change (benchmark/leave_out.py)."""

from dataclasses import fields, replace

import numpy as np
import pytest

from lithofrac.benchmark import blocks, leave_out
from lithofrac.config import Material, load_suite
from lithofrac.core import ElementState, Run
from lithofrac.errors import CoreError
from lithofrac.problem import NEVER, Contact, Fracture, Ramp, VelocityLoad

COLUMNS = {"needed_seconds", "forced_seconds", "forced_over_needed", "same_bits", "check_seconds"}


@pytest.fixture(autouse=True)
def short(monkeypatch):
    monkeypatch.setattr(leave_out, "LEAST_SECONDS", 1e-9)
    monkeypatch.setattr(leave_out, "WINDOWS", 4)


def problem(end_time=2e-5, speed=-0.1, **material):
    mesh = blocks.square(6)
    rock = Material.load("quartzite").model_copy(update=material)
    loads = (
        VelocityLoad("bottom", mesh.nodes_of("bottom"), 1),
        VelocityLoad("top", mesh.nodes_of("top"), 1, speed, Ramp(0.0, 1e-6)),
    )
    return blocks.Problem(mesh, False, (rock,), loads, (), end_time, records=20)


@pytest.fixture
def pair(tmp_path):
    """Two runs of one problem, lean and forced."""
    return leave_out.race(problem(), tmp_path)


def test_everything_is_forced_on_an_elastic_body():
    lean = leave_out.needed(problem(elastic=True))
    full = leave_out.forced(lean)
    assert (lean.contact, lean.fracture, lean.probes, lean.fields) == (None, None, {}, 0)
    assert full.contact is not None
    assert full.fracture.least_factor == NEVER
    assert list(full.materials[0].options[2:]) == [1, 1]  # planes, and a check
    assert len(full.probes) == 3
    assert full.fields == 5


@pytest.mark.parametrize("elastic", [True, False])
def test_what_is_left_out_changes_no_bit(elastic, tmp_path):
    lean, full, ratios = leave_out.races(problem(elastic=elastic), tmp_path)
    assert lean.run.step == full.run.step == lean.steps
    assert len(ratios) == leave_out.WINDOWS
    assert leave_out.difference(lean, full) == ""
    assert len(lean.recorder.history) == len(full.recorder.history) > 10
    assert len(list(tmp_path.glob("frame_*.vtu"))) == full.frames == 5
    assert full.recorder.probes
    assert not lean.recorder.probes


def test_a_difference_is_named(tmp_path):
    lean = leave_out.Stepping(problem(elastic=True), tmp_path)
    other = leave_out.Stepping(problem(elastic=True, young_modulus_GPa=68.1), tmp_path)
    for number in range(leave_out.WINDOWS):
        lean.window(number)
        other.window(number)
    assert leave_out.difference(lean, other).endswith("of the largest")


def test_rock_without_compression_is_checked_against_planes_that_never_act():
    lean = problem(compression=False, plastic_strain=None, cohesion_MPa=None)
    assert list(lean.materials[0].options[2:]) == [0, 1]
    (rock,) = leave_out.forced(lean).materials
    assert list(rock.options[2:]) == [1, 1]
    assert rock.table[1, 0] == 1e6 * leave_out.NO_LIMIT
    assert rock.tensile_strength_MPa == lean.materials[0].tensile_strength_MPa


def test_a_map_that_would_crack_looks_and_makes_no_crack(tmp_path):
    torn = problem(end_time=1.5e-4, speed=5.0)
    cracked = leave_out.Stepping(
        replace(torn, contact=Contact(), fracture=Fracture(), probes={}), tmp_path
    )
    for number in range(leave_out.WINDOWS):
        cracked.window(number)
    assert cracked.run.sizes().cracks > 0
    lean, full, _ = leave_out.races(torn, tmp_path)
    factor, _ = full.run.failure()
    assert factor.max() > 1.0
    assert full.run.sizes().cracks == 0
    assert leave_out.difference(lean, full) == ""


def test_a_threshold_below_one_is_refused():
    with pytest.raises(CoreError, match="least_factor must be at least 1"):
        Run(replace(problem(), contact=Contact(), fracture=Fracture(least_factor=0.99)))


def changed(monkeypatch, run, name, index):
    """Let a face of a run give another number in one of its arrays."""
    given = [array.copy() for array in getattr(run, name)()]
    given[index].flat[-1] += 1
    monkeypatch.setattr(run, name, lambda: given)


@pytest.mark.parametrize(
    ("name", "index", "said"),
    [
        ("nodes", 0, "displacement"),
        ("nodes", 1, "velocity"),
        ("nodes", 2, "mass"),
        ("mesh", 1, "triangles"),
        ("failure", 0, "failure factor"),
    ],
)
def test_a_difference_in_nodes_or_mesh_alone_is_seen(monkeypatch, pair, name, index, said):
    lean, full = pair
    assert leave_out.difference(lean, full) == ""
    changed(monkeypatch, full.run, name, index)
    assert leave_out.difference(lean, full).startswith(f"{said}: ")


@pytest.mark.parametrize("field", [field.name for field in fields(ElementState)])
def test_a_difference_in_the_state_of_one_element_is_seen(monkeypatch, pair, field):
    lean, full = pair
    state = full.run.elements(np.arange(full.run.sizes().elements))
    other = getattr(state, field).copy()
    other.flat[-1] += 1.0
    monkeypatch.setattr(full.run, "elements", lambda _: replace(state, **{field: other}))
    assert leave_out.difference(lean, full).startswith(f"{field}: ")


def test_a_crack_more_or_another_record_is_seen(monkeypatch, pair):
    lean, full = pair
    monkeypatch.setattr(full.run, "cracks", lambda: np.zeros((1, 16)))
    assert leave_out.difference(lean, full) == "cracks: other shape"
    full.recorder.energy[3] = full.recorder.energy[3] + 1.0
    assert "of the largest" in leave_out.difference(lean, full)


def test_strengths_that_are_forced_on_an_elastic_body_are_no_difference(tmp_path):
    lean, full, _ = leave_out.races(problem(elastic=True), tmp_path)
    strengths = [run.elements(np.arange(1)).tensile_strength for run in (lean.run, full.run)]
    assert (strengths[0] != strengths[1]).all()
    assert leave_out.difference(lean, full) == ""


def test_the_row_of_a_case_is_whole(monkeypatch):
    suite = load_suite("configs/suite_quick.yaml")
    row = leave_out.row("bar_wave", suite.case("bar_wave"))
    assert set(row) >= COLUMNS
    assert row["same_bits"]
    assert row["continuum"]
    assert "contact" in row["leaves_out"]
    assert row["check_over_measured"] == pytest.approx(row["check_seconds"] / row["run_seconds"])
    assert np.isfinite(row["cost_seconds"])


def test_the_cases_hold_every_kind_of_scene():
    suites = [load_suite(f"configs/{name}.yaml") for name in ("suite_quick", "suite_leave_out")]
    whole = load_suite("configs/suite.yaml")
    run = {suite.case(name).scene.kind for suite in suites for name in suite.names}
    assert run == {whole.case(name).scene.kind for name in whole.names}
    extra = suites[1]
    assert extra.case("punch_gf60").fracture.mode == "off"
    assert not extra.case("punch_tension_only").material.compression
