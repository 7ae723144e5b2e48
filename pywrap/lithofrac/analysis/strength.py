"""Strength of a specimen from its stress-strain curve."""

from dataclasses import dataclass

import numpy as np

DROP = 0.03  # smallest relative fall after a maximum that makes it a peak


@dataclass(frozen=True)
class Peak:
    """A peak of a stress-strain curve, compression positive."""

    strain: float  # [-]
    stress: float  # unit of the curve
    index: int  # row of the curve


def first_peak(strain: np.ndarray, stress: np.ndarray, drop: float = DROP) -> Peak | None:
    """First local maximum that is followed by a fall of at least `drop` of its value.

    Ripples smaller than `drop` do not count: a maximum stands until the curve has fallen that far
    below it, and gives way to any higher value before.

    Parameters
    ----------
    strain, stress : (n,) curve in order of loading, compression positive
    drop : relative fall, 0 < drop < 1

    Returns
    -------
    The peak, or None when the curve never falls that far ("no peak").
    """
    stress = np.asarray(stress, dtype=float)
    highest = np.maximum.accumulate(stress)
    fallen = (highest > 0) & (stress <= (1.0 - drop) * highest)
    if not fallen.any():
        return None
    index = int(np.argmax(stress[: int(np.argmax(fallen))]))
    return Peak(float(np.asarray(strain)[index]), float(stress[index]), index)
