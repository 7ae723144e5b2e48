"""Runtime guards: each warns, and each stops (pywrap/lithofrac/guards.py)."""

import json
import re
from dataclasses import fields, replace

import meshio
import numpy as np
import pandas as pd
import pytest
from contact_models import UNIT, contact_problem, crushed_rubble
from models import Elastic, hold, problem, rectangle

from lithofrac.cli import main
from lithofrac.config import Material
from lithofrac.core import Energy, Run
from lithofrac.errors import CoreError, GuardError
from lithofrac.guards import GUARDS, LOOK_STEPS, Watch
from lithofrac.problem import Contact, Fracture, Guards, PressureLoad, Ramp
from lithofrac.results import checkpoint
from lithofrac.run import simulate
from lithofrac.stability.families.scales import bases

NEVER = {"element_area_stop": 0.0, "time_step_stop": 0.0, "unconverged_stop": 1.0}
NEVER |= {f"{name}_stop": 1e9 for name in ("overlap", "speed", "energy_residual", "contact_work")}


def thrown(speed=0.3):
    """A block that is led faster and faster, up to `speed` of its P waves."""
    mesh, rock = rectangle(3, 3, 0.01, 0.01), Elastic()
    everyone, way = np.arange(len(mesh.nodes)), Ramp(0.0, 1e-4)
    fast = speed * np.sqrt(rock.modulus / rock.density)
    loads = (hold("x", everyone, 0, fast, ramp=way), hold("y", everyone, 1))
    return problem(mesh, rock, velocity_loads=loads, end_time=1.2e-4, records=40, fields=0)


def crushed():
    """A block that is pressed to less than half of its height."""
    mesh = rectangle(3, 3, 0.01, 0.01)
    loads = (
        hold("bottom", mesh.nodes_of("bottom"), 1),
        hold("top", mesh.nodes_of("top"), 1, -50.0, ramp=Ramp(0.0, 5e-5)),
    )
    return problem(mesh, velocity_loads=loads, end_time=1.2e-4, records=40, fields=0)


def ring():
    """A strip bent to more than a whole turn: its ends lie on each other, which the refusal of an
    overlap at the start does not look for."""
    turn, width = 2.0 * np.pi + 0.25, 0.3
    mesh = rectangle(40, 2, turn, width)
    angle, radius = mesh.nodes[:, 0], 2.0 - mesh.nodes[:, 1] + 0.01 * mesh.nodes[:, 0]
    bent = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    bent = replace(mesh, nodes=bent, edge_sets={})
    return contact_problem(bent, UNIT, end_time=0.5, records=10, fields=0)


def torn():
    """A plate of rock that is pulled apart through its elements."""
    mesh = rectangle(4, 4, 0.1, 0.1, jitter=0.2)
    rock = Material.load("sandstone").model_copy(update={"fracture_energy_J_m2": 50.0})
    loads = (hold("l", mesh.nodes_of("left"), 0, -1.5), hold("r", mesh.nodes_of("right"), 0, 1.5))
    cracks = Fracture("intra_element", reset="paper")
    given = problem(mesh, rock, velocity_loads=loads, end_time=5e-4, records=100, fields=0)
    return replace(given, contact=Contact(default_friction=0.4), fracture=cracks)


def rubble():
    """Single triangles between two plates, too many for the sweeps of some steps."""
    crowd = crushed_rubble(0.9, speed=5.0).problem
    return replace(crowd, end_time=5e-5, records=40, fields=0)


def stacked():
    """Two blocks that are pressed together: waves that cross the contact give a little energy."""
    return replace(bases()["contact"], records=40, fields=0)


NODE = r"step \d+, time \d\.\d{4}E-?\+?\d+ s, node \d+ at \(\S+, \S+\) mm"
FASTEST = NODE.replace("node", "fastest node")
ELEMENT = NODE.replace("node", "element")
TRIGGERS = {  # problem, place, limits of a warning, limits of a stop; without: the usual ones
    "speed": (thrown, NODE, {}, {}),
    "element_area": (crushed, ELEMENT, {"element_area_warning": 0.8}, {"element_area_stop": 0.7}),
    "overlap": (ring, rf"{NODE}, element \d+ at \(\S+, \S+\) mm", {}, {}),
    "time_step": (torn, ELEMENT, {"time_step_warning": 0.95}, {"time_step_stop": 0.9}),
    "unconverged": (rubble, FASTEST, {"unconverged_warning": 0.01}, {"unconverged_stop": 0.02}),
    "contact_work": (stacked, FASTEST, {"contact_work_warning": 1e-4}, {"contact_work_stop": 1e-4}),
    "energy_residual": (
        rubble, FASTEST, {"energy_residual_warning": 1e-11}, {"energy_residual_stop": 1e-10},
    ),
}  # fmt: skip


@pytest.mark.parametrize("guard", GUARDS, ids=lambda guard: guard.name)
def test_a_value_is_beyond_a_limit_on_the_bad_side_and_where_it_is_no_number(guard):
    worse = guard.worse(0.1, 0.2)
    assert guard.is_bad(worse, 0.15)
    assert not guard.is_bad(0.3 - worse, 0.15)
    assert guard.is_bad(float("nan"), 0.15)
    assert not guard.is_bad(0.15, 0.15)


def test_energy_without_cause_is_held_against_the_largest_so_far():
    """Where a body has come to rest, or let go, what is left is no measure."""
    watch = Watch(Run(thrown()), 10)
    none = dict.fromkeys((field.name for field in fields(Energy)), 0.0)
    assert watch._unexplained(Energy(**none | {"elastic": 100.0})) == 0.0
    assert watch._unexplained(Energy(**none | {"elastic": 1.0, "turning": 1.0})) == 0.01


def test_every_guard_has_a_trigger():
    assert set(TRIGGERS) == {guard.name for guard in GUARDS}


@pytest.mark.parametrize("name", TRIGGERS)
def test_a_guard_warns_once_and_the_run_goes_on(tmp_path, name):
    make, place, limits, _ = TRIGGERS[name]
    said = []
    guarded = replace(make(), guards=Guards(**(NEVER | limits)))
    summary = simulate(guarded, tmp_path, warn=said.append)
    assert summary["status"] == "completed"
    (warning,) = [text for text in said if f"guards.{name}_warning" in text]
    assert re.fullmatch(
        rf"{place}: .* is \S+, (above|below) guards\.{name}_warning = \S+; try .*", warning
    )
    (note,) = [text for text in summary["notes"] if f"guards.{name}_warning" in text]
    assert note.startswith(warning.partition("; try")[0])
    assert "; the worst was " in note
    assert len(said) == len(summary["notes"])


@pytest.mark.parametrize("name", TRIGGERS)
def test_a_guard_stops_and_leaves_what_is_needed_to_see_why(tmp_path, name):
    make, place, _, limits = TRIGGERS[name]
    guarded = make()
    others = {key: value for key, value in NEVER.items() if not key.startswith(name)}
    warning = {key.replace("stop", "warning"): value for key, value in limits.items()}
    guarded = replace(guarded, guards=Guards(**(others | warning | limits)))
    with pytest.raises(GuardError) as stopped:
        simulate(guarded, tmp_path)
    message = str(stopped.value)
    assert re.fullmatch(
        rf"{place}: .* is \S+, (above|below) guards\.{name}_stop = \S+; try .*", message
    )
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert (summary["status"], summary["message"]) == ("failed", message)
    step = int(message.split(",")[0].removeprefix("step "))
    assert summary["steps"] == step
    failed = meshio.read(tmp_path / "fields" / "failed.vtu")
    assert failed.point_data["node"].tolist() == list(range(1, len(failed.points) + 1))
    assert len(failed.cell_data["element"][0]) == len(failed.cells[0].data)
    with np.load(tmp_path / checkpoint.FAILED) as kept:
        assert int(kept["state"][0]) == step
    history = pd.read_parquet(tmp_path / "history.parquet")
    assert history["step"].iloc[-1] == step


@pytest.mark.parametrize("records", [10, 1000])
def test_a_step_that_is_too_long_is_noticed_before_numbers_overflow(tmp_path, records):
    """At 1.35 times the limit of the elements the mesh blows up within a hundred steps."""
    mesh = rectangle(8, 16, 0.01, 0.02)
    loads = (
        hold("bottom", mesh.nodes_of("bottom"), 1),
        hold("top", mesh.nodes_of("top"), 1, -0.5, ramp=Ramp(0.0, 2e-5)),
    )
    wild = problem(mesh, velocity_loads=loads, end_time=1e-3, fields=0, records=records)
    with pytest.raises(CoreError, match=r"step \d+, time .*, (node|element) \d+.*; try a smaller"):
        simulate(replace(wild, time_step_factor=1.35), tmp_path)
    kept = checkpoint.read(tmp_path, checkpoint.fingerprint(replace(wild, time_step_factor=1.35)))
    assert np.isfinite(kept.arrays["state"]).all()
    assert (tmp_path / checkpoint.FAILED).exists()


def test_a_load_that_is_let_go_at_once_is_noticed(tmp_path):
    """Confinement far above the strength of steel comes without a ramp."""
    mesh = rectangle(4, 4, 0.01, 0.01)
    sides = tuple(PressureLoad(name, mesh.edge_sets[name], 30e9) for name in ("left", "right"))
    burst = problem(mesh, Elastic(), pressure_loads=sides, end_time=1e-4, records=100, fields=0)
    with pytest.raises(CoreError, match=r"step \d+, .*(node|element) \d+.*; try"):
        simulate(burst, tmp_path)


@pytest.mark.restart
def test_a_stopped_run_goes_on_once_its_limit_is_raised(tmp_path):
    """From the last good checkpoint, which the failed state has not replaced."""
    free = replace(thrown(), guards=Guards(**NEVER))
    simulate(free, tmp_path / "whole")
    out = tmp_path / "stopped"
    with pytest.raises(GuardError):
        simulate(thrown(), out)
    assert (out / checkpoint.FAILED).exists()
    summary = simulate(free, out, resume=True)
    assert summary["status"] == "completed"
    assert not (out / checkpoint.FAILED).exists()
    assert not (out / "fields" / "failed.vtu").exists()
    one, two = (pd.read_parquet(run / "history.parquet") for run in (tmp_path / "whole", out))
    pd.testing.assert_frame_equal(one, two, check_exact=True)


@pytest.mark.restart
def test_a_warning_outlives_an_interruption(tmp_path):
    guarded = replace(thrown(), guards=Guards(**NEVER))
    unbroken = simulate(guarded, tmp_path / "whole")
    warned = []

    def interrupt(now):
        if warned:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(guarded, tmp_path / "cut", progress=interrupt, warn=warned.append)
    again = []
    resumed = simulate(guarded, tmp_path / "cut", resume=True, warn=again.append)
    assert resumed["notes"] == unbroken["notes"] != []
    assert not again


@pytest.mark.restart
def test_limits_change_no_bit(tmp_path):
    tight = {guard.name: 1.0 if guard.falls else 0.0 for guard in GUARDS}
    tight = {f"{name}_warning": value for name, value in tight.items()}
    for name, limits in (("usual", {}), ("tight", tight)):
        simulate(replace(torn(), guards=Guards(**(NEVER | limits))), tmp_path / name)
    for table in ("history", "energy", "cracks"):
        one, two = (pd.read_parquet(tmp_path / run / f"{table}.parquet") for run in
                    ("usual", "tight"))  # fmt: skip
        pd.testing.assert_frame_equal(one, two, check_exact=True)


def test_a_start_that_fails_is_reported_as_any_failure(tmp_path):
    far = problem(rectangle(2, 2), end_time=1.0, fields=0)
    bad = replace(far, pressure_loads=(PressureLoad("left", far.mesh.edge_sets["left"], 1e308),))
    with pytest.raises(CoreError, match=r"step 0, .*not finite; try"):
        simulate(bad, tmp_path)
    assert json.loads((tmp_path / "summary.json").read_text())["status"] == "failed"
    assert (tmp_path / checkpoint.FAILED).exists()


def test_the_command_line_warns_and_stops_with_3(tmp_path, capsys):
    short = ["--set", "scene.element_size_mm=2.5", "--set", "output.records=20"]
    limit = ["--set", "guards.speed_warning=1e-12"]
    case = ["run", "bar_wave", *short, *limit, "--out", str(tmp_path / "a")]
    assert main(case) == 0
    warnings = [line for line in capsys.readouterr().err.splitlines() if "warning" in line]
    assert len(warnings) == 1
    assert re.match(r"bar_wave: warning: step \d+, time ", warnings[0])
    assert main([*case, "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    assert main([*case, "--set", "guards.speed_stop=1e-12", "--quiet"]) == 3
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert re.match(r"lithofrac: step \d+, time .*, node \d+ at .*; try .*\n", said)
    assert (tmp_path / "a" / checkpoint.FAILED).exists()
    assert main(case) == 0
    assert not (tmp_path / "a" / checkpoint.FAILED).exists()


@pytest.mark.parametrize("records", [2, 7, 1000])
def test_a_look_is_taken_every_two_hundred_steps_whatever_is_recorded(tmp_path, records):
    looks = []
    watch = Run.watch

    def counted(self):
        looks.append(self.step)
        return watch(self)

    mesh = rectangle(2, 2, 0.01, 0.01)
    still = problem(mesh, velocity_loads=(hold("bottom", mesh.nodes_of("bottom"), 1),), fields=0)
    still = replace(still, end_time=650.5 * Run(replace(still, end_time=1.0)).dt, records=records)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Run, "watch", counted)
        summary = simulate(still, tmp_path)
    assert summary["steps"] == 651
    assert looks == [0, LOOK_STEPS, 2 * LOOK_STEPS, 3 * LOOK_STEPS, 651]
    history = pd.read_parquet(tmp_path / "history.parquet")
    every = max(1, 651 // records)
    assert list(history["step"]) == sorted({*range(0, 651, every), 651})


def test_a_stop_between_two_records_is_recorded(tmp_path):
    """The block gathers speed over 700 steps and two records, and is stopped at step 400."""
    free = replace(thrown(), guards=Guards(**NEVER))
    step = Run(free).dt
    slow = replace(
        free,
        velocity_loads=tuple(
            replace(load, ramp=Ramp(0.0, 600 * step)) for load in free.velocity_loads
        ),
        end_time=700 * step,
        records=2,
        guards=Guards(**(NEVER | {"speed_warning": 0.1, "speed_stop": 0.2})),
    )
    with pytest.raises(GuardError, match=r"step 400, "):
        simulate(slow, tmp_path)
    history = pd.read_parquet(tmp_path / "history.parquet")
    assert list(history["step"]) == [0, 350, 400]
