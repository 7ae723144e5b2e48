"""Runtime guards: what a run says while something goes wrong, and when it stops.

Thresholds stand in `Problem.guards`. A look is taken every `LOOK_STEPS` steps, at the start and at
the end, whether there is a record or not; it changes no bit of the run.

The core itself ends a run that cannot go on: no return of a trial stress, parts that pass each
other too fast, a velocity that is not finite, an element that has turned inside out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from lithofrac.core import Energy, Run
from lithofrac.errors import GuardError

LOOK_STEPS = 200  # a look takes the time of one step, and a mesh of a few elements that of four
SLOWER = "try a smaller time_step_factor or loading speed"


@dataclass(frozen=True)
class Guard:
    """One guard; `NAME_warning` and `NAME_stop` are its thresholds in `Problem.guards`."""

    name: str
    what: str
    advice: str = SLOWER
    falls: bool = False  # bad when small

    def is_bad(self, value: float, limit: float) -> bool:
        """Whether a value is beyond a limit; NaN is beyond any."""
        return not (value >= limit if self.falls else value <= limit)

    def worse(self, one: float, other: float) -> float:
        """The worse of two values."""
        return min(one, other) if self.falls else max(one, other)


# The cause before what follows from it: the first that is beyond its limit is the one named.
GUARDS = (
    Guard(
        "time_step",
        "its critical time step over that of the mesh at the start",
        "try fracture.mode inter_element or a smaller time_step_factor",
        falls=True,
    ),
    Guard(
        "element_area",
        "its area over that in the undeformed mesh",
        "try a smaller time_step_factor, loading speed or end strain, or a finer mesh",
        falls=True,
    ),
    Guard(
        "overlap",
        "the depth of the node over the shortest edge of the boundary",
        "try a smaller time_step_factor, loading speed or contact.tolerance",
    ),
    Guard("unconverged", "the share of all steps in which contact did not converge"),
    Guard("speed", "its speed over that of P waves"),
    Guard(
        "contact_work",
        "the energy that contact pressure has given, over the largest energy so far,",
        "try a smaller time_step_factor, or damping",
    ),
    Guard("energy_residual", "energy that has no cause, over the largest so far,"),
)


# Of what `Watch.arrays` gives, see `results.checkpoint.Layout`.
LAYOUT = {
    "guards_scale": ("f8", ()),
    "guards": ("U", ("guards",)),
    "guards_first": ("U", ("guards",)),
    "guards_worst": ("f8", ("guards",)),
}


class Reading(NamedTuple):
    """A value and where it is; -1 for no node or no element."""

    value: float
    node: int = -1
    element: int = -1


class Watch:
    """Holds a run against its guards; goes into the checkpoint and comes back from it.

    Parameters
    ----------
    run : what to look at
    steps : that the whole run will take
    """

    def __init__(self, run: Run, steps: int) -> None:
        self.run, self.steps = run, steps
        limits = vars(run.problem.guards)
        self.stops = {guard.name: limits[f"{guard.name}_stop"] for guard in GUARDS}
        self.warnings = {guard.name: limits[f"{guard.name}_warning"] for guard in GUARDS}
        self.scale = 0.0  # largest energy so far [J]
        self.first: dict[str, str] = {}  # guard -> sentence of its first warning
        self.worst: dict[str, float] = {}  # and the worst value since

    def steps_ahead(self) -> int:
        """Steps from here to the next look."""
        return min(LOOK_STEPS - self.run.step % LOOK_STEPS, self.steps - self.run.step)

    def look(self) -> list[str]:
        """Sentences of the guards that warn for the first time; none where no look is due.

        Raises
        ------
        GuardError
            At the first guard that stops the run.
        """
        step = self.run.step
        if step % LOOK_STEPS and step < self.steps:
            return []
        ledger = self.run.energy()
        found = self._walk() | {"energy_residual": Reading(self._unexplained(ledger))}
        if self.run.problem.contact is not None:
            given = max(ledger.contact, 0.0) / self.scale if self.scale > 0.0 else 0.0
            found["contact_work"] = Reading(given)
            unconverged = self.run.contact_statistics().unconverged_steps
            found["unconverged"] = Reading(unconverged / self.steps)
        new = []
        for guard in GUARDS:
            if guard.name in found:
                new += self._hold(guard, found[guard.name])
        return new

    def notes(self) -> list[str]:
        """One sentence for every guard that has warned."""
        return [
            f"{self.first[guard.name]}; the worst was {self.worst[guard.name]:.3g}; {guard.advice}"
            for guard in GUARDS
            if guard.name in self.first
        ]

    def arrays(self) -> dict[str, np.ndarray]:
        """What a checkpoint keeps."""
        names = list(self.first)
        return {
            "guards_scale": np.array(self.scale),
            "guards": np.array(names, dtype=str),
            "guards_first": np.array([self.first[name] for name in names], dtype=str),
            "guards_worst": np.array([self.worst[name] for name in names], dtype=float),
        }

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Take back what `arrays` gave."""
        self.scale = float(arrays["guards_scale"])
        names = [str(name) for name in arrays["guards"]]
        self.first = dict(zip(names, map(str, arrays["guards_first"]), strict=True))
        self.worst = dict(zip(names, map(float, arrays["guards_worst"]), strict=True))

    def _unexplained(self, ledger: Energy) -> float:
        """Residual of the ledger, and what the time step gained or lost as elements turned; both
        over the largest energy so far.

        The second has an entry of its own because it is known, but no rock gives or takes it.
        """
        energies = (ledger.initial, ledger.internal, abs(ledger.external), ledger.kinetic)
        self.scale = max(self.scale, *energies)
        turning = abs(ledger.turning) / self.scale if self.scale > 0.0 else 0.0
        return abs(ledger.residual) + turning

    def _walk(self) -> dict[str, Reading]:
        """What takes a walk over the mesh; a value that is not finite ends the run at once."""
        sight = self.run.watch()
        if sight.bad_node >= 0 or sight.bad_element >= 0:
            what = "its motion" if sight.bad_node >= 0 else "its state"
            where = self._where(Reading(np.nan, sight.bad_node, sight.bad_element))
            raise GuardError(f"{where}: {what} is not finite; {SLOWER}")
        return {
            "time_step": Reading(sight.step, element=sight.step_element),
            "element_area": Reading(sight.area, element=sight.area_element),
            "overlap": Reading(sight.overlap, sight.overlap_node, sight.overlap_element),
            "speed": Reading(sight.speed, sight.speed_node),
        }

    def _hold(self, guard: Guard, reading: Reading) -> list[str]:
        """Hold one reading against its limits; the sentence of a first warning."""
        name, value = guard.name, reading.value
        if guard.is_bad(value, self.stops[name]):
            raise GuardError(f"{self._said(guard, reading, 'stop')}; {guard.advice}")
        if not guard.is_bad(value, self.warnings[name]):
            return []
        if name in self.first:
            self.worst[name] = guard.worse(value, self.worst[name])
            return []
        said = self._said(guard, reading, "warning")
        self.first[name], self.worst[name] = said, value
        return [f"{said}; {guard.advice}"]

    def _said(self, guard: Guard, reading: Reading, kind: str) -> str:
        """Where and how far a value is beyond a limit."""
        limit = (self.stops if kind == "stop" else self.warnings)[guard.name]
        side = "below" if guard.falls else "above"
        beyond = f"is {reading.value:.3g}, {side} guards.{guard.name}_{kind} = {limit:g}"
        return f"{self._where(reading)}: {guard.what} {beyond}"

    def _where(self, reading: Reading) -> str:
        """Step, time, and the place in the undeformed mesh; the fastest node if it has none."""
        run = self.run
        words = [f"step {run.step}", f"time {run.step * run.dt:.4E} s"]
        nodes, triangles, _, _ = run.mesh()
        node, element, fastest = reading.node, reading.element, ""
        if node < 0 and element < 0:
            node, fastest = run.watch().speed_node, "fastest "
        if node >= 0:
            words.append(f"{fastest}node {node + 1} at {_position(nodes[node])}")
        if element >= 0:
            words.append(f"element {element + 1} at {_position(nodes[triangles[element]].mean(0))}")
        return ", ".join(words)


def _position(point: np.ndarray) -> str:
    """A point [m] in words."""
    return f"({1e3 * point[0]:.5g}, {1e3 * point[1]:.5g}) mm"
