"""Size law of the initiation stresses about a hole, and whether the radii fix its asymptote.

The paper sees initiation stresses that "appear to approach different asymptotes for large cavity
sizes" (Klerck 2004, section 3.3, Fig. 16) and fits none. The law here is

    sigma = asymptote (1 + length / R)^n,  n = 1/2 or 1,

which has the slopes that mechanics gives for small holes: -1/2 where a crack needs energy
(`hole_theory.primary_coupled`), -1 where its mouth must open by a fixed way. The power that fits
better is taken; left free it would trade against length and asymptote.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import optimize, stats

from lithofrac.analysis.hole_tables import GROUP, size_effect

POWERS = (0.5, 1.0)
FEWEST = 4  # radii
CONFIDENCE = 0.95
DETERMINED = 0.5  # largest half-width of an asymptote over its value
FITS = [
    *GROUP, "points", "power", "asymptote_MPa", "asymptote_low_MPa", "asymptote_high_MPa",
    "length_mm", "rms_percent", "note",
]  # fmt: skip


@dataclass(frozen=True)
class SizeLaw:
    """A fitted law; stresses in MPa, lengths in mm.

    low, high : interval of the asymptote at `CONFIDENCE`, cut off at 0
    slope : sigma^(1/n) R of small holes
    rms : relative residual of the points
    """

    power: float
    asymptote: float
    low: float
    high: float
    slope: float
    rms: float

    def at(self, radius_mm: np.ndarray) -> np.ndarray:
        """Stress [MPa] at radii [mm]."""
        radius = np.asarray(radius_mm, dtype=float)
        return (self.asymptote ** (1.0 / self.power) + self.slope / radius) ** self.power

    @property
    def length(self) -> float:
        """Radius [mm] at which the stress is 2^n times the asymptote; NaN without one."""
        return float("nan") if self.note else self.slope / self.asymptote ** (1.0 / self.power)

    @property
    def note(self) -> str:
        """Why the radii do not fix the asymptote; empty where they do."""
        if self.low <= 0.0:
            return "asymptote not determined: 0 is within its interval"
        if self.high - self.low > 2.0 * DETERMINED * self.asymptote:
            return "asymptote not determined: interval wider than its value"
        return ""


def fit_size_law(radius_mm: np.ndarray, stress: np.ndarray) -> SizeLaw | None:
    """Fit the law by least squares of relative differences; None below `FEWEST` points."""
    radius, stress = np.asarray(radius_mm, dtype=float), np.asarray(stress, dtype=float)
    if radius.size < FEWEST:
        return None
    return min((_fit(radius, stress, power) for power in POWERS), key=lambda law: law.rms)


def _fit(radius: np.ndarray, stress: np.ndarray, power: float) -> SizeLaw:
    """Law of one power; both parts of sigma^(1/n) = a + b / R are kept from being negative."""

    def misfit(parameters: np.ndarray) -> np.ndarray:
        return (parameters[0] + parameters[1] / radius) ** power / stress - 1.0

    raised = stress ** (1.0 / power)
    start = np.array([0.5 * raised.min(), 0.5 * float(np.mean(raised * radius))])
    fit = optimize.least_squares(misfit, start, bounds=(1e-12, np.inf), x_scale=start)
    freedom = radius.size - 2
    variance = float(fit.fun @ fit.fun) / freedom
    covariance = np.linalg.pinv(fit.jac.T @ fit.jac) * variance
    half = stats.t.ppf(0.5 + 0.5 * CONFIDENCE, freedom) * np.sqrt(covariance[0, 0])
    level, slope = (float(value) for value in fit.x)
    low, high = max(level - half, 0.0) ** power, (level + half) ** power
    rms = float(np.sqrt(np.mean(fit.fun**2)))
    return SizeLaw(power, level**power, float(low), float(high), slope, rms)


def hole_fits(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Size law through the means of each series, zone and criterion.

    Radii at which not every realisation initiates are left out: the mean of those that do is low.
    """
    rows = []
    for key, group in size_effect(inputs, data).groupby(GROUP, sort=False):
        group = group[group["found"] == group["runs"]]
        law = fit_size_law(group["radius_mm"], group["mean_MPa"])
        row = dict(zip(GROUP, key, strict=True)) | {"points": len(group)}
        if law is None:
            rows.append(row | {"note": f"fewer than {FEWEST} radii"})
            continue
        rows.append(
            row
            | {
                "power": law.power,
                "asymptote_MPa": law.asymptote,
                "asymptote_low_MPa": law.low,
                "asymptote_high_MPa": law.high,
                "length_mm": law.length,
                "rms_percent": 100.0 * law.rms,
                "note": law.note,
            }
        )
    return pd.DataFrame(rows, columns=FITS)
