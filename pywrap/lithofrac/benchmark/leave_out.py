"""What a scene saves by leaving out what it does not need, and whether any bit hangs on it.

python -m lithofrac.benchmark.leave_out SUITE [SUITE ...] [--out FILE] [--only CASE ...]

Each case runs twice at once, the two taking turns window by window from the start to the end:
once with only what it needs, without probes and fields, and once with everything forced on:
contact search on the whole boundary, the failure map, a yield check of infinite strength on
elastic bodies, Mohr-Coulomb planes of infinite cohesion on rock that has none, probes and fields.
In a continuum case the map looks for nodes that have failed, and no failure is enough for a crack.
Nothing is forced by a key of a case, only by its `Problem`.

A third run is that of `lithofrac run`; its time stands beside what `check` (from the mesh) and
`config/cost.py` (from the case alone) have predicted.

There is no failure map in axisymmetry; the column `not_forced` says so. What bounds a feature that
is on but idle has its own series in `lithofrac.benchmark.growth`.
"""

from __future__ import annotations

import argparse
import math
import statistics
import tempfile
import time
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.config import Case, Material, load_suite, predicted
from lithofrac.core import ElementState, Run
from lithofrac.guards import Watch
from lithofrac.plan import plan
from lithofrac.problem import NEVER, Contact, Fracture, Problem
from lithofrac.results.fields import write_frame
from lithofrac.results.files import write_whole
from lithofrac.results.recorder import Recorder
from lithofrac.run import simulate
from lithofrac.scenes import make_mesh, make_problem

WINDOWS = 20
FAR = 1e6  # [MPa] strength that no stress of a suite reaches
NO_LIMIT = 1e24  # [MPa] cohesion that sets no scale either (`never`, fortran/material/rock.f90)
FRAMES = 5
PROBES = 3
LEAST_SECONDS, MOST_PAIRS = 0.5, 5  # of a case that is short


class Stepping:
    """A run with its records, its guards and its frames, window by window, and its clock."""

    def __init__(self, problem: Problem, folder: Path) -> None:
        self.problem, self.folder = problem, folder
        self.windows: list[float] = []  # processor time [s]
        self.frames = 0
        start = time.process_time()
        self.run = Run(problem)
        self.recorder = Recorder(self.run)
        self.steps = math.ceil(problem.end_time / self.run.dt)
        self.every = max(1, self.steps // problem.records)
        self.watch = Watch(self.run, self.steps)
        self.start = time.process_time() - start

    @property
    def seconds(self) -> float:
        """Processor time so far [s]."""
        return self.start + sum(self.windows)

    def window(self, number: int) -> None:
        """Go on to the end of a window."""
        start = time.process_time()
        end = self.steps * (number + 1) // WINDOWS
        if number == 0:
            self.run.advance(0)
            self._note()
        while self.run.step < end:
            record = min((self.run.step // self.every + 1) * self.every, self.steps)
            self._advance(min(record, end))
            if self.run.step == record:
                self._note()
        self.windows.append(time.process_time() - start)

    def _advance(self, step: int) -> None:
        while self.run.step < step:
            self.run.advance(min(self.watch.steps_ahead(), step - self.run.step))
            self.watch.look()

    def _note(self) -> None:
        self.recorder.record()
        due = self.run.step / self.steps * max(1, self.problem.fields - 1)
        if self.problem.fields and due >= self.frames:
            write_frame(self.folder / f"frame_{self.frames:04d}.vtu", self.run)
            self.frames += 1


def needed(problem: Problem) -> Problem:
    """The problem without what only looks at it."""
    return replace(problem, probes={}, fields=0)


def forced(problem: Problem) -> Problem:
    """The problem with everything on; where it had no cracks, the failure map makes none."""
    more = np.linspace(0, len(problem.mesh.triangles) - 1, PROBES).astype(int)
    changes = {
        "materials": tuple(map(_checked, problem.materials)),
        "probes": problem.probes | {f"forced {i}": int(at) for i, at in enumerate(more)},
        "fields": max(problem.fields, FRAMES),
        "contact": problem.contact or Contact(),
    }
    if not problem.axisymmetric:
        changes["fracture"] = problem.fracture or Fracture(least_factor=NEVER)
    return replace(problem, **changes)


def _checked(material: Material) -> Material:
    """A material that is checked against all planes; those that it lacks, nothing reaches."""
    far = {
        "compression": True,
        "plastic_strain": (0.0,),
        "cohesion_MPa": (NO_LIMIT,),
        "friction_angle_deg": (0.0,),
        "dilation_angle_deg": (0.0,),
        "reference_size_mm": None,
    }
    if material.elastic:
        far |= {
            "elastic": False,
            "tensile_strength_MPa": FAR,
            "fracture_energy_J_m2": FAR**2,
        }
    elif material.compression:
        return material
    return material.model_copy(update=far)


def race(problem: Problem, folder: Path) -> tuple[Stepping, Stepping]:
    """Both runs to their end."""
    lean, full = (Stepping(made(problem), folder) for made in (needed, forced))
    for number in range(WINDOWS):
        for run in (lean, full):
            run.window(number)
    return lean, full


def difference(lean: Stepping, full: Stepping) -> str:
    """What differs between two runs, first to the bit; nothing if nothing does.

    Compared are the records, and at the end all nodes, the mesh with its cracks, and the state of
    all elements. Only what was forced on itself is left out: columns of contact where the lean run
    has none, and strengths of bodies that have none.
    """
    for name, one, other in _compared(lean, full):
        if one.shape != other.shape:
            return f"{name}: other shape"
        if not np.array_equal(one, other, equal_nan=True):
            one, other = one.astype(float), other.astype(float)
            largest = np.nanmax(np.abs(one)) or 1.0
            return f"{name}: {np.nanmax(np.abs(one - other)) / largest:.1e} of the largest"
    return ""


def _compared(lean: Stepping, full: Stepping) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Name and values of both runs, of everything that must not differ."""
    for name in ("history_table", "energy_table"):
        one, other = getattr(lean.recorder, name)(), getattr(full.recorder, name)()
        for column in one:
            yield column, one[column].to_numpy(), other[column].to_numpy()
    both = lean.run, full.run
    for names, arrays in (
        (("displacement", "velocity", "mass"), [run.nodes() for run in both]),
        (("reference nodes", "triangles", "body", "alive"), [run.mesh() for run in both]),
        (("failure factor", "resets"), [run.failure() for run in both]),
        (("cracks",), [(run.cracks(),) for run in both]),
    ):
        yield from zip(names, *arrays, strict=True)
    states = [run.elements(np.arange(run.sizes().elements)) for run in both]
    body = lean.run.mesh()[2]
    strong = ~np.array([material.elastic for material in lean.problem.materials])[body]
    for field in fields(ElementState):
        one, other = (getattr(state, field.name) for state in states)
        if field.name == "tensile_strength" and len(one) == len(other):
            one, other = one[strong], other[strong]
        yield field.name, one, other


def races(problem: Problem, folder: Path) -> tuple[Stepping, Stepping, list[float]]:
    """Pairs of runs, several of a short case: the last pair, and all ratios."""
    ratios, spent = [], 0.0
    while spent < LEAST_SECONDS and len(ratios) < MOST_PAIRS * WINDOWS:
        lean, full = race(problem, folder)
        ratios += [a / b for a, b in zip(full.windows, lean.windows, strict=True)]
        spent += lean.seconds
    return lean, full, ratios


def row(name: str, case: Case) -> dict:
    """Times and bits of one case, and what was predicted for it."""
    problem = make_problem(case, make_mesh(case))
    expected = plan(problem)
    with tempfile.TemporaryDirectory() as folder:
        lean, full, ratios = races(problem, Path(folder))
        taken = simulate(problem, Path(folder) / "run")["core_seconds"]
    differs = difference(lean, full)
    return {
        "case": name,
        "elements": expected["elements"],
        "steps": lean.steps,
        "leaves_out": ", ".join(key for key, used in expected["uses"].items() if not used),
        "needed_seconds": lean.seconds,
        "forced_seconds": full.seconds,
        "forced_over_needed": statistics.median(ratios),
        "same_bits": not differs,
        "differs_in": differs,
        "not_forced": "failure map: not in axisymmetry" if problem.axisymmetric else "",
        "continuum": problem.fracture is None,
        "run_seconds": taken,
        "check_seconds": expected["expected_seconds"],
        "cost_seconds": predicted(case).seconds,
        "check_over_measured": expected["expected_seconds"] / taken,
    }


def main(argv: list[str] | None = None) -> None:
    """Run the cases of a suite and write the table."""
    parser = argparse.ArgumentParser(
        prog="python -m lithofrac.benchmark.leave_out",
        description="Run cases of suites with what they need, and with everything on.",
    )
    parser.add_argument("suite", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, default=Path("out/tables/leave_out.csv"))
    parser.add_argument("--only", nargs="+", help="some cases of the suites")
    options = parser.parse_args(argv)
    suites, rows = [load_suite(path) for path in options.suite], []
    cases = {name: suite.case(name) for suite in suites for name in suite.names}
    for name in options.only or cases:
        rows.append(row(name, cases[name]))
        own = rows[-1]
        print(
            f"{name}: {own['needed_seconds']:.2f} s, forced {own['forced_seconds']:.2f} s, ratio "
            f"{own['forced_over_needed']:.2f}, same bits {own['same_bits']} {own['differs_in']}"
            f" {own['not_forced']}",
            flush=True,
        )
    options.out.parent.mkdir(parents=True, exist_ok=True)
    table = pd.DataFrame(rows)
    write_whole(options.out, lambda part: table.to_csv(part, index=False))


if __name__ == "__main__":
    main()
