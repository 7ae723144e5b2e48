"""Try a cell: run it, hold it against its limits, and find the time step at which it breaks."""

from __future__ import annotations

import re
import time
from dataclasses import dataclass, replace

import numpy as np

from lithofrac.config.errors import ConfigError
from lithofrac.core import Energy, Run
from lithofrac.errors import CoreError
from lithofrac.kernels import boundary_of
from lithofrac.stability.cell import Cell, Left, Limits, Refused, Sound, Stable, Trial

RECORDS = 100  # looks at a run on its way
RUNAWAY = 100.0  # internal energy over that put in, of a run that has broken
LOST = 1e-2  # residual of a ledger of a run that has broken
HIGHEST = 32.0  # time step factor of the search
RESOLUTION = 0.01  # of the margin, relative
MOST_LOOKED_AT = 5000  # elements of a mesh in which all overlaps are looked for
COLUMNS = (
    "family",
    "extreme",
    "mesh",
    "verdict",
    "margin",
    "energy_residual",
    "internal_over_put_in",
    "speed_over_wave",
    "penetration_over_h",
    "overlap_over_h",
    "contact_work",
    "turning",
    "cracks",
    "elements",
    "steps",
    "note",
    "seconds",
)


@dataclass
class Seen:
    """The worst of a run, and how it ended."""

    residual: float = 0.0
    gain: float = 0.0
    speed: float = 0.0
    penetration: float = 0.0
    overlap: float | None = None  # where it was looked for
    contact_work: float = 0.0
    turning: float = 0.0
    cracks: int = 0
    elements: int = 0
    steps: int = 0
    ended: str = ""  # why it did not reach its end
    note: str = ""

    @property
    def broke(self) -> bool:
        """It did not reach its end."""
        return bool(self.ended)


def judge(cell: Cell) -> dict:
    """A row of the table; see `COLUMNS`."""
    start = time.perf_counter()
    row = _blank(cell)
    expected = cell.expected
    if isinstance(expected, Left):
        row |= {"verdict": "n/a", "note": expected.reason}
    elif isinstance(expected, Refused):
        row |= _refused(expected)
    elif isinstance(expected, Sound):
        row |= _sound(expected)
    else:
        row |= _stable(expected)
    return row | {"seconds": time.perf_counter() - start}


def lost(cell: Cell) -> dict:
    """A row of a cell whose process died."""
    return _blank(cell) | {
        "verdict": "lost",
        "note": "its process died, or that of another cell before it was tried",
        "seconds": 0.0,
    }


def _blank(cell: Cell) -> dict:
    said = {"family": cell.family, "extreme": cell.extreme, "mesh": cell.mesh, "note": ""}
    return dict.fromkeys(COLUMNS) | said


def _refused(expected: Refused) -> dict:
    try:
        expected.call()
    except (CoreError, ConfigError, ValueError) as error:
        said = str(error)
        if re.search(expected.words, said):
            return {"verdict": "refused", "note": said}
        return {"verdict": "wrong words", "note": f"{said} (expected: {expected.words})"}
    return {"verdict": "not refused", "note": f"expected: {expected.words}"}


def _sound(expected: Sound) -> dict:
    try:
        return {"verdict": "stable", "note": expected.call()}
    except (CoreError, AssertionError) as error:
        return {"verdict": "broken", "note": str(error)}


def _stable(expected: Stable) -> dict:
    try:
        trial = expected.make()
        seen = run_trial(trial, closely=True)
    except (CoreError, ConfigError) as error:  # refused though it should run
        return {"verdict": "broken", "note": str(error)}
    faults = [seen.ended] if seen.broke else faults_of(seen, expected.limits)
    row = {
        "verdict": "broken" if faults else "stable",
        "energy_residual": seen.residual,
        "internal_over_put_in": seen.gain,
        "speed_over_wave": seen.speed,
        "penetration_over_h": seen.penetration if trial.problem.contact else None,
        "overlap_over_h": seen.overlap,
        "contact_work": seen.contact_work if trial.problem.contact else None,
        "turning": seen.turning,
        "cracks": seen.cracks if trial.problem.fracture else None,
        "elements": seen.elements,
        "steps": seen.steps,
        "note": "; ".join([*faults, *filter(None, [seen.note])]),
    }
    if faults:
        return row
    if not expected.margin:
        return row | {"note": "; ".join(filter(None, [seen.note, expected.why]))}
    margin, ended = find_margin(trial)
    return row | {"margin": margin, "note": "; ".join(filter(None, [seen.note, ended]))}


def faults_of(seen: Seen, limits: Limits) -> list[str]:
    """What a run that reached its end did not keep."""
    least, most = limits.contact_work
    return [
        f"{name} {value:.1e}, expected {words}"
        for name, value, words, good in (
            (
                "energy residual",
                seen.residual,
                f"at most {limits.residual:g}",
                seen.residual <= limits.residual,
            ),
            (
                "internal energy over that put in",
                seen.gain,
                f"at most {limits.gain:g}",
                seen.gain <= limits.gain,
            ),
            (
                "speed over that of waves",
                seen.speed,
                f"at most {limits.speed:g}",
                seen.speed <= limits.speed,
            ),
            (
                "penetration over h",
                seen.penetration,
                f"at most {limits.penetration:g}",
                seen.penetration <= limits.penetration,
            ),
            (
                "overlap at the end over h",
                seen.overlap or 0.0,
                f"at most {limits.overlap:g}",
                (seen.overlap or 0.0) <= limits.overlap,
            ),
            (
                "work of contact over the energy put in",
                seen.contact_work,
                f"{least:g} to {most:g}",
                least <= seen.contact_work <= most,
            ),
            (
                "energy of turns over that put in",
                seen.turning,
                f"at most {limits.turning:g}",
                abs(seen.turning) <= limits.turning,
            ),
        )
        if not good
    ]


def find_margin(trial: Trial) -> tuple[float, str]:
    """Smallest time step factor at which a trial breaks, to `RESOLUTION`, and how it ends there.

    The factor of the trial is known to be good. Doubled until it breaks, then bisected. `HIGHEST`
    where nothing breaks up to it.
    """
    low, high = trial.problem.time_step_factor, 2.0
    while not (ended := run_trial(trial, high).ended):
        if high >= HIGHEST:
            return high, f"stable at {high:g}, not tried beyond"
        low, high = high, 2.0 * high
    while high - low > RESOLUTION * low:
        middle = 0.5 * (low + high)
        found = run_trial(trial, middle)
        if found.broke:
            high, ended = middle, found.ended
        else:
            low = middle
    return high, f"breaks: {ended}"


def run_trial(trial: Trial, factor: float | None = None, closely: bool = False) -> Seen:
    """Run a trial to its end, or until it breaks.

    Parameters
    ----------
    factor : time step factor, default that of the problem
    closely : look for overlaps and ask the trial for its note at the end

    Raises
    ------
    CoreError
        Where the core refuses the problem; a step that fails is a result.
    """
    problem = trial.problem
    if factor is not None:
        problem = replace(problem, time_step_factor=factor)
    run = Run(problem)
    if trial.displacement is not None:
        run.set_motion(trial.displacement, trial.velocity)
    steps = max(1, round(problem.end_time / run.dt))
    every = max(1, steps // RECORDS)
    eye = _Eye(run)
    seen = eye.seen
    try:
        run.advance(0)
        eye.look()
        while run.step < steps and not seen.broke:
            run.advance(min(every, steps - run.step))
            eye.look()
    except CoreError as error:
        seen.ended = str(error)
    seen.steps = run.step
    if closely and not seen.broke:
        run.check()
        if problem.contact is not None and seen.elements <= MOST_LOOKED_AT:
            seen.overlap = deepest_overlap(run)
        if trial.watch is not None:
            seen.note = trial.watch(run)
    return seen


class _Eye:
    """Looks at a run on its way and keeps the worst."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.seen = Seen(elements=len(run.problem.mesh.triangles))
        self.wave = max(map(wave_speed, run.problem.materials))  # [m/s]
        self.put_in = self.scale = 0.0  # largest so far [J]
        self.left_over = self.contact = self.turning = 0.0  # worst so far [J]

    def look(self) -> None:
        """Note the worst so far; say when there is no use in going on."""
        run, seen, energy = self.run, self.seen, self.run.energy()
        fastest = float(np.hypot(*run.nodes()[1].T).max())
        seen.speed = max(seen.speed, fastest / self.wave)
        seen.penetration = run.contact_statistics().max_penetration_over_h
        seen.cracks = run.sizes().cracks
        self.put_in = max(self.put_in, energy.initial + max(0.0, energy.external))
        self.scale = max(self.scale, self.put_in, abs(energy.external), energy.internal)
        self.left_over = max(self.left_over, abs(left_over(energy)))
        self.contact = max(self.contact, energy.contact, key=abs)
        self.turning = max(self.turning, energy.turning, key=abs)
        if self.put_in > 0.0:
            seen.gain = max(seen.gain, energy.internal / self.put_in)
            seen.contact_work = self.contact / self.put_in
            seen.turning = self.turning / self.put_in
        if self.scale > 0.0:
            seen.residual = self.left_over / self.scale
        if not np.isfinite(energy.residual):
            seen.ended = f"step {run.step}: the energy is not finite"
        elif not seen.gain <= RUNAWAY:
            seen.ended = f"step {run.step}: internal energy {seen.gain:.0f} times that put in"
        elif not seen.residual <= LOST:
            seen.ended = f"step {run.step}: energy residual {seen.residual:.1e}"


def deepest_overlap(run: Run) -> float:
    """Deepest node inside an element that it does not belong to, over the shortest edge, by
    looking at all nodes and all elements."""
    nodes, triangles, _, alive = run.mesh()
    x = nodes + run.nodes()[0]
    deepest = 0.0
    for triangle in triangles[alive]:
        corner = x[triangle]
        inside = ((x > corner.min(axis=0)) & (x < corner.max(axis=0))).all(axis=1)
        inside[triangle] = False
        along = np.roll(corner, -1, axis=0) - corner
        along /= np.hypot(*along.T)[:, None]
        arm = x[inside][:, None] - corner
        left_of = along[:, 0] * arm[..., 1] - along[:, 1] * arm[..., 0]
        deepest = max(deepest, float(left_of.min(axis=1).max(initial=0.0)))
    return deepest / boundary_of(run.problem.mesh)[1]


def left_over(energy: Energy) -> float:
    """What the two sides of the ledger differ by [J]."""
    outside = energy.external + energy.damping + energy.contact + energy.friction
    outside += energy.insertion + energy.relump + energy.turning
    return energy.kinetic + energy.internal - energy.initial - outside


def wave_speed(material) -> float:
    """Speed of plane pressure waves [m/s]."""
    nu = material.poisson
    modulus = material.young * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    return (modulus / material.density) ** 0.5
