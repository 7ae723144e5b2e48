"""What is forced on and what must not change (benchmark/leave_out.py)."""

import numpy as np
import pytest

from lithofrac.benchmark import blocks, leave_out
from lithofrac.config import Material, load_suite
from lithofrac.problem import Ramp, VelocityLoad

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


def test_everything_is_forced_on_an_elastic_body():
    lean = leave_out.needed(problem(elastic=True))
    full = leave_out.forced(lean, failure_map=True)
    assert (lean.contact, lean.fracture, lean.probes, lean.fields) == (None, None, {}, 0)
    assert full.contact is not None
    assert full.fracture is not None
    assert list(full.materials[0].options[2:]) == [1, 1]  # planes, and a check
    assert len(full.probes) == 3
    assert full.fields == 5


@pytest.mark.parametrize("elastic", [True, False])
def test_what_is_left_out_changes_no_bit(elastic, tmp_path):
    lean, full, ratios, why = leave_out.races(problem(elastic=elastic), tmp_path)
    assert why == ""
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


def test_a_map_that_would_crack_is_left_off_and_said_so(tmp_path):
    torn = problem(end_time=1.5e-4, speed=5.0)
    _, full, _, why = leave_out.races(torn, tmp_path)
    assert why == "failure map: it would crack"
    assert full.problem.fracture is None
    assert full.problem.contact is not None


def test_the_row_of_a_case_is_whole(monkeypatch):
    suite = load_suite("configs/suite_quick.yaml")
    row = leave_out.row("bar_wave", suite.case("bar_wave"))
    assert set(row) >= COLUMNS
    assert row["same_bits"]
    assert row["continuum"]
    assert "contact" in row["leaves_out"]
    assert row["check_over_measured"] == pytest.approx(row["check_seconds"] / row["run_seconds"])
    assert np.isfinite(row["cost_seconds"])
