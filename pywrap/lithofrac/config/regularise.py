"""Where a hardening table starts to soften, and how wide a band may be that follows it.

Tables are as `Material.table`: (4, k), rows plastic strain, cohesion [Pa], friction, dilation
[rad]. `fortran/material/regularise.f90` does the stretching.
"""

from itertools import pairwise

import numpy as np


def softening_onset(table: np.ndarray) -> int:
    """Row of the largest uniaxial strength 2 c sqrt(N), N = (1 + sin phi)/(1 - sin phi).

    The last of equal ones. Cohesion alone falls from the first row on while friction still
    rises: that is no softening. Without a row after it the table never softens.
    """
    strength = _strength(table[1], table[2])
    return len(strength) - 1 - int(np.argmax(strength[::-1]))


def width_limit(table: np.ndarray, young: float, poisson: float, reference: float) -> float:
    """Band width [m] from which on a homogeneous element under axial control snaps back.

    There the strength falls faster with the axial plastic strain than elastic unloading lets it:
    E of an element under equal lateral pressures, E / (1 - nu^2) of one in plane strain, whose
    flow has no part across the plane (eqs 7 and 8). The steepest end of any segment decides.

    Parameters
    ----------
    table : (4, k), see above
    young, poisson : elasticity [Pa], [-]
    reference : width [m] for which the table holds as it stands
    """
    first = softening_onset(table)
    steepest = 0.0
    for low, high in pairwise(range(first, table.shape[1])):
        slope = (table[:, high] - table[:, low]) / (table[0, high] - table[0, low])
        for row in (low, high):
            _, cohesion, friction, dilation = table[:, row]
            root = np.sqrt(_flow_number(friction))
            fall = -(2.0 * slope[1] * root + cohesion * (1.0 + root**2) * slope[2])
            a, b = 0.5 * (1.0 + np.sin(dilation)), 0.5 * (1.0 - np.sin(dilation))
            triaxial = b / np.sqrt((a**2 + 2.0 * b**2) / 3.0)
            plane = b / np.sqrt((a**2 + b**2) * 2.0 / 3.0)
            steepest = max(
                steepest,
                fall / triaxial / young,
                fall / plane / (young / (1.0 - poisson**2)),
            )
    return reference / steepest if steepest > 0.0 else float("inf")


def _flow_number(friction):
    return (1.0 + np.sin(friction)) / (1.0 - np.sin(friction))


def _strength(cohesion, friction):
    """Uniaxial strength [Pa]."""
    return 2.0 * cohesion * np.sqrt(_flow_number(friction))
