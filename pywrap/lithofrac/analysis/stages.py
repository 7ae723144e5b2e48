"""Stages of a curve of load: A, B, C and D of the strip punch (Klerck 2004, Fig. 6a)."""

from dataclasses import dataclass

import numpy as np

from lithofrac.analysis.strength import DROP, first_peak

FAILED = 0.5  # of the first peak: complete failure leaves less, for good
RIPPLE = 0.01  # of the first peak: a rise by more ends the fall to stage D
PLATEAU = 0.05  # relative distance from the largest stress that counts as constant stress


@dataclass(frozen=True)
class Stages:
    """Rows of a curve; None where a stage does not exist.

    Attributes
    ----------
    a : first peak
    b : lowest after it, before the load is regained; without regain the lowest there is
    c : largest after B, before complete failure; None is "no regain"
    d : bottom of the fall to less than half of A to which the curve does not come back
    regain : largest rise after A, before the curve is below half of it for good, over A
    """

    a: int | None
    b: int | None
    c: int | None
    d: int | None
    regain: float


def find_stages(strain: np.ndarray, stress: np.ndarray, swing: float = DROP) -> Stages:
    """Stages of a curve by one rule: a swing counts from `swing` times the first peak on.

    Parameters
    ----------
    strain, stress : (n,) curve in order of loading, compression positive
    swing : relative, as the fall that makes a first peak
    """
    stress = np.asarray(stress, dtype=float)
    n = len(stress)
    peak = first_peak(strain, stress, swing)
    if peak is None:
        return Stages(None, None, None, None, float("nan"))
    rise = swing * peak.stress
    half = int(np.flatnonzero(stress >= FAILED * peak.stress)[-1]) + 1
    d = None if half == n else half + _bottom(stress[half:], RIPPLE * peak.stress)
    between = stress[peak.index : half]
    regain = float((between - np.minimum.accumulate(between)).max() / peak.stress)
    if regain < swing:
        b = d if d is not None else peak.index + int(np.argmin(between))
        return Stages(peak.index, b, None, d, regain)
    b = peak.index + _bottom(between, rise)
    c = b + int(np.argmax(stress[b:half]))
    return Stages(peak.index, b, c, d, regain)


def plateau(strain: np.ndarray, stress: np.ndarray) -> float:
    """Strain that is spent within 5 % of the largest stress, over the strain at that stress.

    A straight rise to a sharp peak has 0.05.
    """
    strain, stress = np.asarray(strain, dtype=float), np.asarray(stress, dtype=float)
    near = stress >= (1.0 - PLATEAU) * stress.max()
    spent = np.diff(strain)[near[1:] & near[:-1]].sum()
    return float(spent / strain[np.argmax(stress)])


def brittleness(strain: np.ndarray, stress: np.ndarray) -> float:
    """Strain from the largest stress to the first half of it; inf without such a fall."""
    return _to_half(strain, stress, int(np.argmax(stress)))


def final_fall(strain: np.ndarray, stress: np.ndarray) -> float:
    """Strain from the end of the plateau to the first half of the largest stress; or inf."""
    near = np.asarray(stress) >= (1.0 - PLATEAU) * np.max(stress)
    return _to_half(strain, stress, int(np.flatnonzero(near)[-1]))


def _to_half(strain: np.ndarray, stress: np.ndarray, start: int) -> float:
    below = np.flatnonzero(np.asarray(stress)[start:] < 0.5 * np.max(stress))
    strain = np.asarray(strain, dtype=float)
    return float(strain[start + below[0]] - strain[start]) if below.size else float("inf")


def _bottom(stress: np.ndarray, rise: float) -> int:
    """Row of the lowest value before the first rise of more than `rise`, or of all."""
    risen = stress > np.minimum.accumulate(stress) + rise
    end = int(np.argmax(risen)) if risen.any() else len(stress)
    return int(np.argmin(stress[:end]))
