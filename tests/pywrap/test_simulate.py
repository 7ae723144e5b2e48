"""A run from start to end: tables, frames, resume, failures (pywrap/lithofrac/run.py)."""

import json
import os
import signal
from dataclasses import replace

import meshio
import numpy as np
import pandas as pd
import pytest
from models import Elastic, hold, problem, rectangle

from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.errors import CoreError
from lithofrac.plan import plan
from lithofrac.problem import Damping, Measures, PressureLoad, Ramp
from lithofrac.run import simulate


def specimen(**changes):
    mesh = rectangle(4, 8, 0.01, 0.02, jitter=0.2)
    base = problem(
        mesh,
        Material.load("sandstone"),
        velocity_loads=(
            hold("bottom", mesh.nodes_of("bottom"), 1),
            hold("left", mesh.nodes_of("left"), 0),
            hold("top", mesh.nodes_of("top"), 1, -0.5, ramp=Ramp(0.0, 2e-5)),
        ),
        pressure_loads=(PressureLoad("side", mesh.edge_sets["right"], 1e6, 0.0, Ramp(0.0, 2e-5)),),
        damping=Damping(0.3),
        measures=Measures("top", 0.01, 0.02, "side", 0.01),
        probes={"corner": 0, "middle": 30},
        end_time=4e-4,
        records=40,
        fields=3,
    )
    return replace(base, **changes)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    out = tmp_path_factory.mktemp("run")
    return out, simulate(specimen(), out, meta={"case": "specimen"})


def test_summary_names_what_a_reader_needs(done):
    out, summary = done
    assert summary == json.loads((out / "summary.json").read_text())
    assert summary["status"] == "completed"
    assert summary["case"] == "specimen"
    assert summary["elements"] == 64
    assert summary["energy_residual"] < 1e-6
    assert summary["element_steps_per_core_second"] > 0
    assert summary["max_plastic_strain"] > 1e-4


def test_history_measures_the_specimen(done):
    history = pd.read_parquet(done[0] / "history.parquet")
    assert history["axial_strain"].iloc[-1] == pytest.approx(
        -history["top_displacement_mm"].iloc[-1] / 20.0
    )
    np.testing.assert_allclose(history["axial_stress_MPa"], -history["top_force_N"] / 0.01 / 1e6)
    np.testing.assert_allclose(
        history["volumetric_strain"], history["lateral_strain"] - history["axial_strain"]
    )
    assert history["axial_stress_MPa"].max() > 50.0
    assert history["lateral_strain"].iloc[-1] > 0.0


def test_the_lateral_strain_of_a_cylinder_counts_twice_in_its_volume(tmp_path):
    simulate(specimen(axisymmetric=True, end_time=5e-5, fields=0), tmp_path)
    history = pd.read_parquet(tmp_path / "history.parquet")
    assert history["lateral_strain"].abs().max() > 0.0
    np.testing.assert_allclose(
        history["volumetric_strain"], 2 * history["lateral_strain"] - history["axial_strain"]
    )


def test_probes_and_ledger_have_a_row_a_record(done):
    probes = pd.read_parquet(done[0] / "probes.parquet")
    energy = pd.read_parquet(done[0] / "energy.parquet")
    assert len(probes) == 2 * len(energy)
    assert set(probes["probe"]) == {"corner", "middle"}
    inside = energy[["kinetic_J", "elastic_J", "compressive_dissipation_J"]].sum(axis=1)
    inside += energy["fracture_dissipation_J"]
    outside = energy["external_J"] + energy["damping_J"] + energy["turning_J"]
    np.testing.assert_allclose(inside - outside, energy["residual_J"], atol=1e-9)


def test_fields_are_read_back_by_meshio(done):
    out, _ = done
    text = (out / "fields.pvd").read_text()
    frames = sorted((out / "fields").glob("*.vtu"))
    assert len(frames) == 3
    assert all(f"fields/{frame.name}" in text for frame in frames)
    last = meshio.read(frames[-1])
    assert last.cells[0].type == "triangle"
    assert last.cell_data["plastic_strain"][0].max() > 0.0
    assert last.point_data["displacement_m"].shape == (45, 3)


@pytest.mark.restart
def test_resumed_run_gives_the_same_tables(done, tmp_path):
    stop = 17

    def interrupt(now):
        nonlocal stop
        stop -= 1
        if stop == 0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(specimen(), tmp_path, progress=interrupt)
    assert json.loads((tmp_path / "summary.json").read_text())["status"] == "interrupted"
    simulate(specimen(), tmp_path, resume=True)
    for name in ("history", "energy", "probes"):
        one = pd.read_parquet(done[0] / f"{name}.parquet")
        two = pd.read_parquet(tmp_path / f"{name}.parquet")
        pd.testing.assert_frame_equal(one, two, check_exact=True)
    frames = [sorted(p.name for p in (f / "fields").iterdir()) for f in (done[0], tmp_path)]
    assert frames[0] == frames[1]


@pytest.mark.restart
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_in_the_middle_of_the_steps_loses_no_row(done, tmp_path, monkeypatch, number):
    """Delivered while the core is at work, before its record is taken."""
    advance, calls = Run.advance, []

    def interrupted(self, steps, threads=1):
        advance(self, steps, threads)
        calls.append(steps)
        if len(calls) == 9:
            os.kill(os.getpid(), number)

    with monkeypatch.context() as patch:
        patch.setattr(Run, "advance", interrupted)
        with pytest.raises(KeyboardInterrupt):
            simulate(specimen(), tmp_path)
    simulate(specimen(), tmp_path, resume=True)
    for name in ("history", "energy", "probes"):
        one = pd.read_parquet(done[0] / f"{name}.parquet")
        two = pd.read_parquet(tmp_path / f"{name}.parquet")
        pd.testing.assert_frame_equal(one, two, check_exact=True)


def test_element_that_turns_inside_out_is_named(tmp_path):
    mesh = rectangle(2, 2, 0.01, 0.01)
    crush = problem(
        mesh,
        velocity_loads=(
            hold("bottom", mesh.nodes_of("bottom"), 1),
            hold("top", mesh.nodes_of("top"), 1, -50.0),
        ),
        end_time=1e-3,
        fields=0,
    )
    with pytest.raises(CoreError, match=r"element \d+: it has turned inside out"):
        simulate(crush, tmp_path)


def test_failure_leaves_a_state_to_look_at_and_a_checkpoint(tmp_path):
    wild = specimen(materials=(Elastic(),), time_step_factor=3.0, end_time=5e-3)
    with pytest.raises(CoreError, match=r"step \d+, time .* s, (node|element) \d+"):
        simulate(wild, tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["status"] == "failed"
    assert "step" in summary["message"]
    assert (tmp_path / "fields" / "failed.vtu").exists()
    assert (tmp_path / "checkpoint.npz").exists()


def test_plan_counts_steps_and_names_what_is_left_out():
    expected = plan(specimen(probes={}, damping=Damping()))
    assert expected["elements"] == 64
    assert expected["steps"] == int(np.ceil(4e-4 / expected["time_step_s"]))
    assert expected["uses"]["yield check"]
    assert not expected["uses"]["probes"]
    assert not expected["uses"]["damping"]
    assert not expected["uses"]["axisymmetry"]
