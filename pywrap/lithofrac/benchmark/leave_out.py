"""What a scene saves by leaving out what it does not need, and whether any bit hangs on it.

python -m lithofrac.benchmark.leave_out SUITE [--out FILE] [--only CASE ...]

Each case runs twice at once, the two taking turns window by window from the start to the end:
once with only what it needs, without probes and fields, and once with everything forced on:
contact search on the whole boundary, the failure map, a yield check of infinite strength on
elastic bodies, probes and fields. Nothing is forced by a key of a case, only by its `Problem`.

A third run is that of `lithofrac run`; its time stands beside what `check` (from the mesh) and
`config/cost.py` (from the case alone) have predicted.

A `Problem` has no failure threshold: where a forced failure map makes a crack, the case is run
again without it; and there is none in axisymmetry. The column `not_forced` says which. What bounds
a feature that is on but idle has its own series in `lithofrac.benchmark.growth`.
"""

from __future__ import annotations

import argparse
import math
import statistics
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.config import Case, Material, load_suite, predicted
from lithofrac.core import Run
from lithofrac.guards import Watch
from lithofrac.problem import Contact, Fracture, Problem
from lithofrac.results.fields import write_frame
from lithofrac.results.files import write_whole
from lithofrac.results.recorder import Recorder
from lithofrac.run import plan, simulate
from lithofrac.scenes import make_mesh, make_problem

WINDOWS = 20
FAR = 1e6  # [MPa] strength that no stress of a suite reaches
FRAMES = 5
PROBES = 3
LEAST_SECONDS, MOST_PAIRS = 0.5, 5  # of a case that is short


class CrackedError(Exception):
    """A forced failure map has made a crack."""


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


def forced(problem: Problem, failure_map: bool) -> Problem:
    """The problem with everything on.

    Parameters
    ----------
    failure_map : look for cracks also in a case that has none
    """
    more = np.linspace(0, len(problem.mesh.triangles) - 1, PROBES).astype(int)
    changes = {
        "materials": tuple(map(_checked, problem.materials)),
        "probes": problem.probes | {f"forced {i}": int(at) for i, at in enumerate(more)},
        "fields": max(problem.fields, FRAMES),
        "contact": problem.contact or Contact(),
    }
    if failure_map and not problem.axisymmetric:
        changes["fracture"] = problem.fracture or Fracture()
    return replace(problem, **changes)


def _checked(material: Material) -> Material:
    """An elastic material as one that is checked against strengths which nothing reaches."""
    if not material.elastic:
        return material
    far = {
        "elastic": False,
        "compression": True,
        "tensile_strength_MPa": FAR,
        "fracture_energy_J_m2": FAR**2,
        "plastic_strain": (0.0,),
        "cohesion_MPa": (FAR,),
        "friction_angle_deg": (0.0,),
        "dilation_angle_deg": (0.0,),
        "reference_size_mm": None,
    }
    return material.model_copy(update=far)


def race(problem: Problem, failure_map: bool, folder: Path) -> tuple[Stepping, Stepping]:
    """Both runs to their end.

    Raises
    ------
    CrackedError
        Where the forced run cracks and the other cannot.
    """
    lean = Stepping(needed(problem), folder)
    full = Stepping(forced(problem, failure_map), folder)
    for number in range(WINDOWS):
        for run in (lean, full):
            run.window(number)
        if problem.fracture is None and full.run.sizes().cracks:
            raise CrackedError
    return lean, full


def difference(lean: Stepping, full: Stepping) -> str:
    """What differs between two runs, first to the bit; nothing if nothing does."""
    pairs = []
    for name in ("history_table", "energy_table"):
        one, other = getattr(lean.recorder, name)(), getattr(full.recorder, name)()
        pairs += [(column, one[column].to_numpy(), other[column].to_numpy()) for column in one]
    names = ("displacement", "velocity")
    pairs += zip(names, lean.run.nodes(), full.run.nodes(), strict=False)
    for name, one, other in pairs:
        if one.shape != other.shape:
            return f"{name}: other shape"
        if not np.array_equal(one, other, equal_nan=True):
            largest = np.nanmax(np.abs(one)) or 1.0
            return f"{name}: {np.nanmax(np.abs(one - other)) / largest:.1e} of the largest"
    return ""


def races(problem: Problem, folder: Path) -> tuple[Stepping, Stepping, list[float], str]:
    """Pairs of runs, several of a short case: the last pair, all ratios, what was not forced."""
    why, ratios, spent = "", [], 0.0
    if problem.axisymmetric:
        why = "failure map: not in axisymmetry"
    while spent < LEAST_SECONDS and len(ratios) < MOST_PAIRS * WINDOWS:
        try:
            lean, full = race(problem, not why, folder)
        except CrackedError:
            why = "failure map: it would crack"
            continue
        ratios += [a / b for a, b in zip(full.windows, lean.windows, strict=True)]
        spent += lean.seconds
    return lean, full, ratios, why


def row(name: str, case: Case) -> dict:
    """Times and bits of one case, and what was predicted for it."""
    problem = make_problem(case, make_mesh(case))
    expected = plan(problem)
    with tempfile.TemporaryDirectory() as folder:
        lean, full, ratios, why = races(problem, Path(folder))
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
        "not_forced": why,
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
        description="Run cases with what they need, and with everything on.",
    )
    parser.add_argument("suite", type=Path)
    parser.add_argument("--out", type=Path, default=Path("out/tables/leave_out.csv"))
    parser.add_argument("--only", nargs="+", help="some cases of the suite")
    options = parser.parse_args(argv)
    suite, rows = load_suite(options.suite), []
    for name in options.only or suite.names:
        rows.append(row(name, suite.case(name)))
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
