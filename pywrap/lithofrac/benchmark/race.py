"""Subjects that take turns, so that a machine that drifts or is shared moves all of them alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field

ELEMENT_STEPS = 2.0e7  # in one window
LEAST_STEPS = 100  # in one window


@dataclass(frozen=True)
class Subject:
    """Something that takes steps.

    steps : take that many
    share : of the steps of a window; less than 1 for what is slow
    count : steps of a window instead, or None
    threads : of the core
    has_setup : `steps(0)` takes time that belongs to no step, and is taken off
    """

    steps: Callable[[int], None]
    share: float = 1.0
    count: int | None = None
    threads: int = 1
    has_setup: bool = False


@dataclass
class Speeds:
    """Million element-steps per second of every window: of processor time of all threads, and of
    time on the wall."""

    core: list[float] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)


def race(subjects: dict[str, Subject], elements: int, repeat: int) -> dict[str, Speeds]:
    """Speeds of subjects that take turns, `repeat` windows each."""
    speeds = {name: Speeds() for name in subjects}
    for _ in range(repeat):
        for name, subject in subjects.items():
            count = steps_of(subject, elements)
            core, wall = _seconds(subject.steps, count)
            if subject.has_setup:
                before = _seconds(subject.steps, 0)
                core, wall = core - before[0], wall - before[1]
            speeds[name].core.append(elements * count / core / 1e6)
            speeds[name].wall.append(elements * count / wall / 1e6)
    return speeds


def steps_of(subject: Subject, elements: int) -> int:
    """Steps of a window, in whole hundreds unless they are given."""
    if subject.count is not None:
        return subject.count
    hundreds = round(subject.share * ELEMENT_STEPS / elements / 100)
    return max(LEAST_STEPS, hundreds * 100)


def seconds_a_step(speeds: list[float], elements: int) -> float:
    """Median time of a step [s] from speeds."""
    return elements / statistics.median(speeds) / 1e6


def median_ratio(a: list[float], b: list[float]) -> float:
    """Median of the ratios of paired windows."""
    return statistics.median(x / y for x, y in zip(a, b, strict=True))


def _seconds(steps: Callable[[int], None], count: int) -> tuple[float, float]:
    """Processor and wall time of some steps [s]."""
    core, wall = time.process_time(), time.perf_counter()
    steps(count)
    return time.process_time() - core, time.perf_counter() - wall
