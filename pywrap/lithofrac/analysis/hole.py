"""Initiation about a hole in a block, read from the runs (Klerck 2004, section 3.3, Figs 14-16).

Three zones: primary, the probes at the crown; sidewall, those at both sides; remote, the fan of
probes beside the primary crack. Three criteria, each gives an axial stress with an interval:

- `curvature`: the gauge leaves its straight line (`initiation.find_kink`), in tension not before
  its element softens; most extensional principal strain at crown and fan, most compressive one at
  the sidewalls, as in Fig. 15;
- `exhaustion`: the tensile strength of the gauge's element is used up;
- `crack`: the first discrete crack in the zone. It is tensile at crown and fan, where a crack of
  compressive dilation belongs to a shear band from the sidewall.

A zone with several gauges starts with the first of them. The paper has one remote gauge "adjacent
to the termination of the primary fracture", whose place is known only from an image. A gauge that
a primary crack passes bends as well, for the stress about it is redistributed, but its rock stays
whole. So a bend of the fan counts only if it is towards extension and the element has begun to
soften by then (by the upper end of the interval); else the search goes on behind it.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd

from lithofrac.analysis.hole_cracks import zoned_cracks
from lithofrac.analysis.initiation import Kink, find_kink
from lithofrac.analysis.runs import Run

ZONES = {"primary": "crown", "remote": "remote", "sidewall": "sidewall"}  # zone -> its probes
CRITERIA = ("curvature", "exhaustion", "crack")
RESOLUTION = 1e-6  # strain that a foil gauge tells apart
USED_UP = 0.01  # share of the tensile strength that counts as none
WHOLE = 1e-9  # share of the tensile strength that rounding may take
SOFTENED = 0.999  # share of the tensile strength below which an element has begun to soften

AFTER = "after the peak"  # note of an event of a block that has failed

NAME = re.compile(
    r"^hole_(?:(?P<series>mesh1mm|block150|null|elastic)_)?r(?P<radius>\d+(\.\d+)?)"
    r"(?:_(?P<variant>[a-z]\w*))?(?:@seed(?P<seed>\d+))?$"
)


@dataclass(frozen=True)
class Event:
    """Initiation in one zone by one criterion; stresses in MPa, NaN where there is none."""

    zone: str
    criterion: str
    probe: str
    stress: float
    low: float
    high: float
    time_s: float
    note: str


@dataclass(frozen=True)
class Gauge:
    """One probe of a run, over the rows of the history."""

    name: str
    strain: np.ndarray  # (n,) principal strain that the paper reads, tension positive
    strength: np.ndarray  # (n,) least tensile strength over the virgin one

    @property
    def softens(self) -> int:
        """First row in which the element has begun to soften; n when it never does."""
        rows = np.flatnonzero(self.strength < SOFTENED)
        return int(rows[0]) if rows.size else self.strength.size


class HoleRun:
    """A run of the hole scene with its gauges."""

    def __init__(self, run: Run) -> None:
        self.run = run
        found = NAME.match(run.name)
        self.series = (found["series"] or found["variant"] or "similar") if found else "other"
        self.seed = int(found["seed"] or 1) if found else 1
        self.radius_mm = float(run.case["scene"]["hole_radius_mm"])

    @cached_property
    def times(self) -> np.ndarray:
        """Moments of the records [s]."""
        return self.run.history["time_s"].to_numpy()

    @cached_property
    def stress(self) -> np.ndarray:
        """Axial stress at the records [MPa]."""
        return self.run.history["axial_stress_MPa"].to_numpy()

    @cached_property
    def gauges(self) -> dict[str, Gauge]:
        """All probes by name."""
        table = self.run.probes
        table = table[table["time_s"] >= self.times[0]]
        virgin = self.run.case["material"].get("tensile_strength_MPa")
        return {str(name): _gauge(str(name), own, virgin) for name, own in table.groupby("probe")}

    @cached_property
    def _zoned(self) -> pd.DataFrame:
        """Cracks with the zone that each is in."""
        return zoned_cracks(self.run)

    def zone(self, zone: str) -> list[Gauge]:
        """Gauges of a zone, those whose names begin as `ZONES` says."""
        return [gauge for name, gauge in self.gauges.items() if name.startswith(ZONES[zone])]

    def events(self) -> Iterator[Event]:
        """Initiation in every zone by every criterion."""
        for zone in ZONES:
            yield _first(self._bends(zone), zone, "curvature")
            yield _first([self._used_up(zone, g) for g in self.zone(zone)], zone, "exhaustion")
            yield self._crack(zone)

    def _bends(self, zone: str) -> list[Event]:
        """Changes of curvature of the gauges of a zone, those that soften first first.

        On the fan it is softening that makes a bend an event, so a gauge that softens after the
        first event is not asked.
        """
        events: list[Event] = []
        for gauge in sorted(self.zone(zone), key=lambda gauge: gauge.softens):
            first = min((e.time_s for e in events if not np.isnan(e.time_s)), default=np.inf)
            whole = gauge.softens == len(self.times)
            if zone == "remote" and not whole and self.times[gauge.softens] > first:
                break
            events.append(self._bend(zone, gauge))
        return events

    def _bend(self, zone: str, gauge: Gauge) -> Event:
        """Change of curvature of one gauge; on the fan only what is not the wake of a crack."""
        remote, start = zone == "remote", 0
        if remote and gauge.softens == len(self.times):
            return _none(zone, "curvature", "no element softens")
        while kink := find_kink(self.stress[start:], gauge.strain[start:], RESOLUTION):
            extends = kink.slope_after > kink.slope_before
            if not remote or (extends and self.stress[gauge.softens] <= kink.high):
                return self._bent(zone, gauge, kink)
            start += kink.last
        return _none(zone, "curvature", "bends without softening" if start else "no kink")

    def _bent(self, zone: str, gauge: Gauge, kink: Kink) -> Event:
        """A kink as an event. In tension a gauge cannot bend before its own element softens: two
        straight lines through a curve that bends on meet up to 5 % before that."""
        stress, low, high = kink.stress, kink.low, kink.high
        yielded = np.flatnonzero(gauge.strength < 1.0 - WHOLE)
        if zone != "sidewall" and yielded.size:
            before, after = map(float, self.stress[yielded[0] - 1 : yielded[0] + 1])
            if stress < after <= kink.window:
                stress, low, high = after, before, max(high, after)
        moment = float(self.times[int(np.argmax(self.stress >= stress))])
        return Event(zone, "curvature", gauge.name, stress, low, high, moment, "")

    def _used_up(self, zone: str, gauge: Gauge) -> Event:
        """Row from which no tensile strength is left; the interval is that between two records."""
        used = np.flatnonzero(gauge.strength <= USED_UP)
        if used.size == 0:
            return _none(zone, "exhaustion", "not used up")
        row = int(used[0])
        return self._at(zone, "exhaustion", gauge.name, row, self.times[row])

    def _crack(self, zone: str) -> Event:
        """First crack of a zone, by where its middle lies."""
        if not self.run.discrete:
            return _none(zone, "crack", "continuum")
        own = self._zoned[self._zoned["zone"] == zone]
        if own.empty:
            return _none(zone, "crack", "no crack")
        moment = float(own["time_s"].iloc[0])
        row = min(int(np.searchsorted(self.times, moment)), len(self.times) - 1)
        return self._at(zone, "crack", "", row, moment)

    def _at(self, zone: str, criterion: str, probe: str, row: int, moment: float) -> Event:
        """Event at a moment up to the record `row` and after the one before it."""
        before, after = self.stress[max(row - 1, 0)], self.stress[row]
        stress = float(np.interp(moment, self.times, self.stress))
        low, high = sorted((float(before), float(after)))
        note = AFTER if row > int(np.argmax(self.stress)) else ""
        return Event(zone, criterion, probe, stress, low, high, float(moment), note)


def _gauge(name: str, own: pd.DataFrame, virgin: float | None) -> Gauge:
    """Principal strain and least strength of one probe; `strain_xy` is engineering shear."""
    xx, yy, xy = (own[f"strain_{c}"].to_numpy() for c in ("xx", "yy", "xy"))
    radius = np.hypot(0.5 * (xx - yy), 0.5 * xy)
    sign = -1.0 if name.startswith(ZONES["sidewall"]) else 1.0
    strengths = own[[f"tensile_strength_{i}_MPa" for i in (1, 2, 3)]].to_numpy()
    if not virgin:  # an elastic rock has none to lose
        return Gauge(name, 0.5 * (xx + yy) + sign * radius, np.ones(len(own)))
    return Gauge(name, 0.5 * (xx + yy) + sign * radius, strengths.min(axis=1) / virgin)


def _none(zone: str, criterion: str, note: str) -> Event:
    nan = float("nan")
    return Event(zone, criterion, "", nan, nan, nan, nan, note)


def _first(events: list[Event], zone: str, criterion: str) -> Event:
    """Earliest of the events of a zone; where there is none, why, in the words of most gauges, of
    equally many in those of the gauge that softens first."""
    found = [event for event in events if not np.isnan(event.time_s)]
    if found:
        return min(found, key=lambda event: event.time_s)
    notes = [event.note for event in events] or ["no probe"]
    return replace(_none(zone, criterion, ""), note=max(dict.fromkeys(notes), key=notes.count))


def is_hole(run: Run) -> bool:
    """Whether a run is one of the hole scene with discrete gauges (not the quarter of Kirsch)."""
    return run.test == "hole"
