"""What a problem of the sweep is, and what one run of it gives."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from lithofrac.core import Run
from lithofrac.problem import Problem

SHORT = 0.3  # core seconds below which a run is timed again
LOOKS = 1000  # at a run on its way, as a case has records
REPEATS = 3  # of a short run; the least counts

Setting = float | str


@dataclass(frozen=True)
class Outcome:
    """One run.

    Attributes
    ----------
    values : quantity -> relative error where the answer is known, else the quantity itself; NaN
        where the run has none
    core_seconds : of the run alone, without its mesh
    elements, steps : of the run
    """

    values: dict[str, float]
    core_seconds: float
    elements: int
    steps: int


@dataclass(frozen=True)
class Subject:
    """One problem, its knobs and what they are turned to.

    Attributes
    ----------
    name, title : short name, and what is computed
    run : takes all knobs by name
    default : value of every knob: that of the case files, where the problem is one of theirs
    sweep : knob -> other values, turned one at a time
    quantities : what is measured; keys of `Outcome.values`
    size : knob that refines, of which the observed order is taken
    finest : knobs of the solution that the others are held against; None: the answer is known
    reasons : quantity -> why the default costs more than the cheapest setting of its error
    """

    name: str
    title: str
    run: Callable[..., Outcome]
    default: dict[str, Setting]
    sweep: dict[str, tuple[Setting, ...]]
    quantities: tuple[str, ...]
    size: str = "element_size_mm"
    finest: dict[str, Setting] | None = None
    reasons: dict[str, str] = field(default_factory=dict)

    def settings(self) -> list[tuple[str, dict[str, Setting]]]:
        """Knob that was turned (or `default`, `finest`) and all knobs of every run."""
        runs = [("default", self.default)]
        for knob, values in self.sweep.items():
            runs += [(knob, self.default | {knob: value}) for value in values]
        if self.finest is not None:
            runs.append(("finest", self.default | self.finest))
        return runs


def timed_run(
    problem: Problem,
    displacement: np.ndarray | None = None,
    velocity: np.ndarray | None = None,
    look: Callable[[Run], None] | None = None,
) -> tuple[Run, float]:
    """Run a problem to its end; short ones several times, for other work disturbs them most.

    Parameters
    ----------
    displacement, velocity : (n, 2) [m], [m/s] at time 0; both or neither
    look : called `LOOKS` times on the way of every run

    Returns
    -------
    tuple
        The run at its end, and its core seconds, the least of its repeats.
    """
    least = np.inf
    for _ in range(REPEATS):
        start = time.process_time()
        run = Run(problem)
        if displacement is not None:
            run.set_motion(displacement, velocity)
        steps = math.ceil(problem.end_time / run.dt)
        for i in range(1, LOOKS + 1) if look else ():
            run.advance(steps * i // LOOKS - run.step)
            look(run)
        run.advance(steps - run.step)
        least = min(least, time.process_time() - start)
        if least > SHORT:
            break
    return run, least


def outcome(values: dict[str, float], run: Run, core_seconds: float) -> Outcome:
    """What a run at its end has given."""
    return Outcome(values, core_seconds, len(run.problem.mesh.triangles), run.step)
