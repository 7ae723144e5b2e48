"""Direction of a shear band and of cracks, as angles to the load axis (y).

The paper sees bands whose cracks stand en echelon (Klerck 2004, section 3.2, Fig. 11): the
segments are near-vertical and the band is their arrangement. So both are measured apart.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from lithofrac.analysis.frames import Frame

SPREAD = 0.5  # share of the area above which plastic strain counts as spread uniformly
ELONGATION = 3.0  # least ratio of the axes; two bands at +-19 degrees or more have less
NEAR_AXIS_DEG = 20.0  # a segment within this angle of the load axis is near-vertical


@dataclass(frozen=True)
class Band:
    """Principal axis of a cloud of plastic strain.

    Attributes
    ----------
    angle_deg : of the long axis to the load axis, 0 to 90; NaN without plastic strain
    elongation : standard deviation along the long over that along the short axis
    spread : share of the area that the plastic strain takes, 1 where it is uniform
    """

    angle_deg: float
    elongation: float
    spread: float

    @property
    def note(self) -> str:
        """Why the cloud is no band; empty where it is one, and the angle that of a band."""
        if np.isnan(self.angle_deg):
            return "no plastic strain" if np.isnan(self.spread) else "uniform"
        if self.spread > SPREAD:
            return "spread out"
        return "" if self.elongation >= ELONGATION else "no single axis"


def find_band(frame: Frame) -> Band:
    """Band of the bodies that yield, from the centroids in the reference state."""
    strained = np.unique(frame.body[frame.plastic_strain > 0.0])
    own = np.isin(frame.body, strained)
    return band_of(frame.centroids()[own], frame.plastic_strain[own], frame.areas()[own])


def band_of(points: np.ndarray, strain: np.ndarray, area: np.ndarray) -> Band:
    """Principal axis of points weighted by area and by plastic strain above its median.

    The median over the area is the uniform part: a specimen that hardens everywhere would
    otherwise turn the axis towards its own shape. The spread is that of the whole strain,
    (sum of e A)^2 / (sum of e^2 A) over the area.

    Parameters
    ----------
    points : (m, 2) [mm]
    strain : (m,) effective plastic strain [-]
    area : (m,) [mm2]
    """
    if not np.any(strain > 0.0):
        return Band(float("nan"), float("nan"), float("nan"))
    spread = float((strain * area).sum() ** 2 / (strain**2 * area).sum() / area.sum())
    order = np.argsort(strain)
    half = np.searchsorted(np.cumsum(area[order]), 0.5 * area.sum())
    weight = area * np.maximum(strain - strain[order[half]], 0.0)
    if not np.any(weight > 0.0):
        return Band(float("nan"), 1.0, spread)
    offset = points - np.average(points, axis=0, weights=weight)
    moments, axes = np.linalg.eigh((weight[:, None] * offset).T @ offset / weight.sum())
    short, long = np.sqrt(np.maximum(moments, 0.0))
    elongation = float(long / short) if short > 0.0 else float("inf")
    return Band(angle_to_axis(axes[:, 1]), elongation, spread)


def angle_to_axis(direction: np.ndarray) -> np.ndarray | float:
    """Angle of directions (..., 2) to the load axis, 0 to 90 degrees."""
    return np.degrees(np.arctan2(np.abs(direction[..., 0]), np.abs(direction[..., 1])))


def crack_angles(cracks: pd.DataFrame) -> np.ndarray:
    """Angle of each crack segment to the load axis, 0 to 90 degrees, (n,)."""
    ends = cracks[["x1_mm", "y1_mm", "x2_mm", "y2_mm"]].to_numpy(dtype=float)
    return angle_to_axis(ends[:, 2:] - ends[:, :2])


def near_axis_share(cracks: pd.DataFrame, limit_deg: float = NEAR_AXIS_DEG) -> float:
    """Share of the crack length that runs within an angle of the load axis; NaN without cracks.

    Segments without a preferred direction have `limit_deg` / 90.
    """
    length = cracks["length_mm"].to_numpy(dtype=float)
    if not length.sum() > 0.0:
        return float("nan")
    return float(length[crack_angles(cracks) <= limit_deg].sum() / length.sum())
