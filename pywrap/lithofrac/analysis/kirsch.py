"""Stress about a circular hole in an infinite elastic plate under uniaxial stress (Kirsch)."""

import numpy as np


def infinite_plate(points: np.ndarray, radius: float) -> np.ndarray:
    """Stress over the remote stress, which acts along y.

    Parameters
    ----------
    points : (n, 2) positions from the centre of the hole [m], outside it
    radius : of the hole [m]

    Returns
    -------
    (n, 3) components xx, yy, xy; at the wall xx = -1 at the crown (0, R), yy = 3 at the sidewall.
    """
    x, y = np.asarray(points, dtype=float).T
    q = radius**2 / (x**2 + y**2)
    angle = np.arctan2(x, y)  # from the load axis
    c, s = np.cos(2.0 * angle), np.sin(2.0 * angle)
    radial = 0.5 * (1.0 - q) + 0.5 * (1.0 - 4.0 * q + 3.0 * q**2) * c
    hoop = 0.5 * (1.0 + q) - 0.5 * (1.0 + 3.0 * q**2) * c
    shear = -0.5 * (1.0 + 2.0 * q - 3.0 * q**2) * s
    to_y, to_x = np.cos(angle), np.sin(angle)  # radial direction is (to_x, to_y)
    xx = radial * to_x**2 + hoop * to_y**2 + 2.0 * shear * to_x * to_y
    yy = radial * to_y**2 + hoop * to_x**2 - 2.0 * shear * to_x * to_y
    xy = (radial - hoop) * to_x * to_y - shear * (to_x**2 - to_y**2)
    return np.column_stack([xx, yy, xy])
