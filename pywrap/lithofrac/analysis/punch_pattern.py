"""What forms beneath the strip punch: failed zone, axial crack, first damage (Klerck 2004, Fig. 7).

Positions are those of the reference state; depth counts from the shoulders of the block down.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from lithofrac.analysis.bands import crack_angles
from lithofrac.analysis.inelastic import Inelastic, frame_at, load_inelastic
from lithofrac.analysis.localisation import localised
from lithofrac.analysis.runs import Run
from lithofrac.analysis.stages import find_stages

INSIDE = 0.95  # share of the failed area that its depth holds: a few stray elements lie deeper
STEEP_DEG = 45.0  # a segment within this angle of the axis follows it as far as a mesh lets it


@dataclass(frozen=True)
class Strip:
    """Where the strip stands; lengths in mm."""

    axis: float  # x of its middle
    width: float
    top: float  # y of the shoulders
    height: float  # of the block

    @classmethod
    def of(cls, run: Run) -> "Strip":
        """Strip of a run of the scene `punch`."""
        scene = run.case["scene"]
        height = float(scene["block_height_mm"])
        return cls(0.5 * scene["width_mm"], float(scene["strip_width_mm"]), height, height)

    def to_edge(self, points: np.ndarray) -> np.ndarray:
        """Distance of points (n, 2) from the nearer edge of the strip's foot, (n,)."""
        aside = np.abs(points[:, 0] - self.axis) - 0.5 * self.width
        return np.hypot(aside, points[:, 1] - self.top)


@dataclass(frozen=True)
class Zone:
    """Elements in which failure has localised.

    Attributes
    ----------
    depth_mm : depth that holds 95 % of their area, 0 without any
    taper : their mean distance from the axis in the upper half of that depth over that in the
        lower half; 3 where two flanks meet at that depth, 1 where they stand upright
    """

    depth_mm: float
    taper: float


def pattern_time(run: Run) -> float:
    """Moment of complete failure, stage D, or the end of a run that does not get there [s]."""
    table = run.history
    stages = find_stages(table["axial_strain"], table["axial_stress_MPa"])
    row = stages.d if stages.d is not None else len(table) - 1
    return float(table["time_s"].iloc[row])


def pattern(run: Run) -> Inelastic:
    """Inelastic strain in the frame of `pattern_time`."""
    return load_inelastic(run, *frame_at(run, pattern_time(run)))


def open_cracks(run: Run, time_s: float) -> pd.DataFrame:
    """Rows of `cracks.parquet` that have opened by a moment, with their middle `x_mm`, `y_mm`."""
    table = run.cracks[run.cracks["time_s"] <= time_s * (1.0 + 1e-9)]
    return table.assign(
        x_mm=0.5 * (table["x1_mm"] + table["x2_mm"]), y_mm=0.5 * (table["y1_mm"] + table["y2_mm"])
    )


def failed_zone(run: Run, state: Inelastic) -> Zone:
    """Zone of localised plastic strain beneath the strip, weighted by area."""
    strip, frame = Strip.of(run), state.frame
    failed = localised(frame)
    points, area = frame.centroids()[failed], frame.areas()[failed]
    if not area.size:
        return Zone(0.0, float("nan"))
    depth, aside = strip.top - points[:, 1], np.abs(points[:, 0] - strip.axis)
    order = np.argsort(depth)
    reached = np.searchsorted(np.cumsum(area[order]), INSIDE * area.sum())
    end = float(depth[order][reached])
    upper, lower = depth <= 0.5 * end, (depth > 0.5 * end) & (depth <= end)
    if not (upper.any() and lower.any()):
        return Zone(end, float("nan"))
    far, near = (np.average(aside[half], weights=area[half]) for half in (upper, lower))
    return Zone(end, float(far / near))


def axial_extent(run: Run, time_s: float) -> float:
    """Share of the block's height that steep cracks cover within half a strip of the axis."""
    strip, table = Strip.of(run), open_cracks(run, time_s)
    near = np.abs(table["x_mm"] - strip.axis) <= 0.5 * strip.width
    table = table[near & (crack_angles(table) <= STEEP_DEG)]
    ends = np.sort(np.clip(table[["y1_mm", "y2_mm"]].to_numpy(), 0.0, strip.top), axis=1)
    covered, reached = 0.0, 0.0
    for low, high in ends[np.argsort(ends[:, 0])]:
        covered += max(0.0, high - max(low, reached))
        reached = max(reached, high)
    return covered / strip.height


def compressive_share_below(run: Run, state: Inelastic) -> float:
    """Compressive part of the inelastic strain near the axis below the failed zone.

    Weighted by area, of the principal values in the plane, within half a strip of the axis; NaN
    where nothing is strained there.
    """
    strip, points = Strip.of(run), state.frame.centroids()
    below = strip.top - points[:, 1] > failed_zone(run, state).depth_mm
    chosen = below & (np.abs(points[:, 0] - strip.axis) <= 0.5 * strip.width)
    values, area = state.principal[0][chosen], state.frame.areas()[chosen, None]
    values = np.where(state.damaged[chosen, None], values, 0.0)
    whole = float((np.abs(values) * area).sum())
    return float((np.maximum(-values, 0.0) * area).sum() / whole) if whole > 0.0 else float("nan")
