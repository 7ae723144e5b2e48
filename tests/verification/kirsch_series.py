"""Elastic rectangular plate with a central hole under uniform tension, by Michell's series.

Independent of the code under test. The Airy function, even in x and y,

    phi = A ln r + B r^2 + sum over even n of (a r^n + b r^-n + c r^(n+2) + d r^(2-n)) cos(n theta)

solves the plane problem whatever its coefficients (Timoshenko & Goodier, Theory of Elasticity,
art. 43). A, b and d follow from B, a and c by the condition that the hole is free of traction, so
it is free exactly. B, a and c are fitted by least squares to the tractions on the outer boundary,
and what is left there is known: `Plate.misfit`. The stresses do not depend on the elastic
constants, because no net force acts on the hole.
"""

from dataclasses import dataclass

import numpy as np

ORDERS = 30  # even harmonics above n = 0
POINTS = 200  # on each half of an outer side


@dataclass(frozen=True)
class Plate:
    """A solved plate; the radius of the hole and the tension along y are one.

    coefficients : (1 + 2 k,) of the columns of `_modes`
    scale : radius at which the growing powers are of size one
    misfit : largest traction left over on the outer boundary
    """

    coefficients: np.ndarray
    scale: float
    misfit: float

    def stress(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Stress xx, yy, xy at points (n,) outside the hole -> (3, n)."""
        return _modes(x, y, self.scale, len(self.coefficients) // 2) @ self.coefficients

    @property
    def crown(self) -> float:
        """Hoop stress at the wall on the load axis; -1 in an infinite plate."""
        return float(self.stress(np.zeros(1), np.ones(1))[0, 0])

    @property
    def sidewall(self) -> float:
        """Hoop stress at the wall across the load axis; 3 in an infinite plate."""
        return float(self.stress(np.ones(1), np.zeros(1))[1, 0])


def plate(half_width: float, half_height: float, orders: int = ORDERS) -> Plate:
    """Solve the plate whose half sides are given in radii of the hole."""
    along = (np.arange(POINTS) + 0.5) / POINTS
    side = np.full(POINTS, half_width), half_height * along
    top = half_width * along, np.full(POINTS, half_height)
    scale = float(np.hypot(half_width, half_height))
    at_side, at_top = _modes(*side, scale, orders), _modes(*top, scale, orders)
    tractions = np.concatenate([at_side[0], at_side[2], at_top[1], at_top[2]])
    applied = np.repeat([0.0, 0.0, 1.0, 0.0], POINTS)
    size = np.linalg.norm(tractions, axis=0)
    coefficients = np.linalg.lstsq(tractions / size, applied, rcond=1e-14)[0] / size
    return Plate(coefficients, scale, float(abs(tractions @ coefficients - applied).max()))


def _modes(x: np.ndarray, y: np.ndarray, scale: float, orders: int) -> np.ndarray:
    """Stress xx, yy, xy of every mode that leaves the hole free -> (3, n, 1 + 2 orders).

    First B with its A, then every a and every c with their b and d.
    """
    r, theta = np.hypot(x, y), np.arctan2(y, x)
    # n = 0: B r^2 - 2 B ln r
    polar = [np.stack([2 - 2 / r**2, 2 + 2 / r**2, 0 * r])]
    for n in 2 * np.arange(1, orders + 1):
        for power in (n, n + 2):
            b, d = np.linalg.solve(_at_wall(n, [-n, 2 - n]), -_at_wall(n, [power])[:, 0])
            mode = _power(r, theta, n, power) + b * _power(r, theta, n, -n)
            mode += d * _power(r, theta, n, 2 - n)
            polar.append(mode * scale ** (2.0 - power))
    rr, tt, rt = np.stack(polar, axis=2)
    c, s = np.cos(theta)[:, None], np.sin(theta)[:, None]
    return np.stack(
        [
            rr * c**2 + tt * s**2 - 2 * rt * c * s,
            rr * s**2 + tt * c**2 + 2 * rt * c * s,
            (rr - tt) * c * s + rt * (c**2 - s**2),
        ]
    )


def _power(r: np.ndarray, theta: np.ndarray, n: int, m: int) -> np.ndarray:
    """Stress rr, tt, rt of phi = r^m cos(n theta) -> (3, n)."""
    cos, sin = np.cos(n * theta), np.sin(n * theta)
    return r ** (m - 2.0) * np.stack([(m - n**2) * cos, m * (m - 1) * cos, n * (m - 1) * sin])


def _at_wall(n: int, powers: list[int]) -> np.ndarray:
    """Amplitudes of the tractions rr and rt at r = 1 of phi = r^m cos(n theta) -> (2, powers)."""
    return np.array([[m - n**2 for m in powers], [n * (m - 1) for m in powers]], dtype=float)
