"""Distance of a computed curve from a reference."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class CurveError:
    """Difference of two curves where both are known; unit of the curves unless said otherwise."""

    rms: float
    rms_relative: float  # rms over the largest reference value
    max_relative: float  # largest difference over the largest reference value
    points: int  # reference points compared
    left_out: int  # reference points beyond the computed curve


def compare(x: np.ndarray, y: np.ndarray, x_ref: np.ndarray, y_ref: np.ndarray) -> CurveError:
    """Compare a computed curve with reference points, at the points' own abscissas.

    The computed curve is taken as piecewise linear in x, which need not be sorted but must not
    take one value twice (a snap-back has no y(x)). Reference points outside it are left out and
    counted: extrapolating would invent an error.

    Raises
    ------
    ValueError
        When no reference point lies within the computed curve, or all reference values are 0.
    """
    order = np.argsort(x)
    x, y = np.asarray(x, dtype=float)[order], np.asarray(y, dtype=float)[order]
    x_ref, y_ref = np.asarray(x_ref, dtype=float), np.asarray(y_ref, dtype=float)
    inside = (x_ref >= x[0]) & (x_ref <= x[-1])
    if not inside.any():
        raise ValueError("no reference point lies within the computed curve")
    difference = np.interp(x_ref[inside], x, y) - y_ref[inside]
    scale = float(np.abs(y_ref[inside]).max())
    if scale == 0.0:
        raise ValueError("all reference values are 0, expected a scale for relative errors")
    rms = float(np.sqrt(np.mean(difference**2)))
    largest = float(np.abs(difference).max())
    return CurveError(rms, rms / scale, largest / scale, int(inside.sum()), int((~inside).sum()))
