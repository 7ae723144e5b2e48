"""What a cell of the matrix is: an extreme on one kind of mesh, and what is expected of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from lithofrac.problem import Problem

CONTINUUM, CONTACT, CRACKED = "continuum", "contact", "cracked"
MESHES = (CONTINUUM, CONTACT, CRACKED)


@dataclass(frozen=True)
class Limits:
    """What a stable run keeps; the figures of the benchmark's acceptance, fixed beforehand.

    Attributes
    ----------
    residual : largest residual of the energy ledger, over the energy scale of the ledger
    gain : largest internal energy over the energy put in. A mode at 0.95 of its limit stores ten
        times its energy at the turning point, so that less is no sign of instability
    speed : largest speed of a node over that of the fastest pressure waves
    penetration : deepest of a pair at any time, over the shortest boundary edge h
    overlap : deepest node inside an element at the end, over h; all nodes against all elements
    contact_work : (least, most) work of contact pressure over the energy put in
    turning : what the finite step itself gains or loses as elements turn, over the energy put in
    """

    residual: float = 1e-6
    gain: float = 10.0
    speed: float = 0.2
    penetration: float = 1e-5
    overlap: float = 5e-4
    contact_work: tuple[float, float] = (-1e-2, 1e-2)
    turning: float = 1e-3


USUAL = Limits()
CRACKS = Limits(penetration=5e-4, contact_work=(-0.2, 1e-3))  # pieces collide
LARGE = Limits(penetration=5e-4)  # faces turn and slide far
RUBBLE = Limits(residual=1e-5, penetration=5e-3, contact_work=(-0.2, 1e-3))  # flies freely


@dataclass(frozen=True)
class Trial:
    """One simulation; its time step factor is that of the problem, or what the search asks for.

    Attributes
    ----------
    problem : what is run, to its end time
    displacement, velocity : (n, 2) [m], [m/s] at time 0; both or neither
    watch : looks at the run at its end and says something worth a note
    """

    problem: Problem
    displacement: np.ndarray | None = None
    velocity: np.ndarray | None = None
    watch: Callable | None = None


@dataclass(frozen=True)
class Stable:
    """The run must reach its end within `limits`."""

    make: Callable[[], Trial]
    limits: Limits = USUAL
    margin: bool = True
    why: str = ""  # said in place of the margin where there is none


@dataclass(frozen=True)
class Sound:
    """No run in time: `call` checks a kernel and gives a note; it raises where that is wrong."""

    call: Callable[[], str]


@dataclass(frozen=True)
class Refused:
    """`call` must raise one of the errors a user sees, with `words` (a pattern) in its message."""

    call: Callable[[], object]
    words: str


@dataclass(frozen=True)
class Left:
    """There is no such thing on this mesh."""

    reason: str


@dataclass(frozen=True)
class Cell:
    """One cell: a row of the table."""

    family: str
    extreme: str
    mesh: str
    expected: Stable | Sound | Refused | Left = field(repr=False)
    slow: bool = False  # longer than a few seconds

    @property
    def name(self) -> str:
        """`family: extreme (mesh)`."""
        return f"{self.family}: {self.extreme} ({self.mesh})"
