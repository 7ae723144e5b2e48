"""Cohesive cracks from crown and invert of a hole under uniaxial compression along them.

The law of the runs without their mesh: a crack that bears ft where it is closed and nothing where
it has opened by w_c = 2 Gf / ft, linearly between (Hillerborg, Modeer & Petersson 1976, Cem.
Concr. Res. 6, 773), in an infinite elastic plate in plane strain. The crack is a row of edge
dislocations beside a free hole, by Muskhelishvili's potentials; the singular integral equation is
solved by Gauss-Chebyshev quadrature (Erdogan & Gupta 1972, Q. Appl. Math. 29, 525). Lengths are in
radii of the hole.
"""

from functools import cache, lru_cache

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from lithofrac.analysis.hole_theory import crown_hoop, plane_modulus

POINTS = 48  # of the quadrature
SHORTEST, LONGEST, FACTOR = 1e-4, 100.0, 1.2  # cracks tried, each so much longer than the last


def potentials(x: np.ndarray, x0: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Muskhelishvili's phi', phi'', psi' on the axis at x of a dislocation at x0 > 1.

    It opens the axis by 8 pi over the plane strain modulus; the hole |z| = 1 is free, and its image
    of the dislocation is the second part of each.
    """
    phi, dphi = 1.0 / (x - x0), -1.0 / (x - x0) ** 2
    psi = 1.0 / (x - x0) + x0 / (x - x0) ** 2
    edge = (1.0 - x0**2) / x0
    phi1 = -(1.0 / (x * (x0 * x - 1.0)) + edge / (1.0 - x0 * x) ** 2)
    dphi1 = (2.0 * x0 * x - 1.0) / (x * (x0 * x - 1.0)) ** 2
    dphi1 = dphi1 - 2.0 * x0 * edge / (1.0 - x0 * x) ** 3
    psi1 = -1.0 / (x * (x0 * x - 1.0)) - 1.0 / (x0 * x**2) + phi1 / x**2 - dphi1 / x
    return phi + phi1, dphi + dphi1, psi + psi1


def stress_across(x: np.ndarray, x0: np.ndarray) -> np.ndarray:
    """Stress across the axis at x of a dislocation at x0 and of its mirror image at -x0."""
    total = 0.0
    for side in (x, -x):
        phi, dphi, psi = potentials(side, x0)
        total = total + 2.0 * phi + side * dphi + psi
    return total


class CrackLine:
    """Quadrature of two equal cracks of a length in radii.

    Attributes
    ----------
    x : (n - 1,) where the stress is met, from the centre of the hole
    stress : (n - 1, n) stress there of the densities
    opening : (n - 1, n) opening there of the densities, times E' / R
    mouth : (n,) the same at the wall
    at_wall, at_tip : (n,) bounded part of the density at both ends
    """

    def __init__(self, length: float, n: int = POINTS) -> None:
        k, j = np.arange(1, n + 1), np.arange(1, n)
        node, angle = (2 * k - 1) * np.pi / (2 * n), j * np.pi / n
        x0 = 1.0 + 0.5 * length * (1.0 + np.cos(node))
        self.x = 1.0 + 0.5 * length * (1.0 + np.cos(angle))
        self.stress = stress_across(self.x[:, None], x0) * np.pi / n * 0.5 * length
        scale = 8.0 * np.pi * 0.5 * length / n
        waves = (np.sin(np.outer(angle, j)) / j) @ np.cos(np.outer(j, node))
        self.opening = scale * (angle[:, None] + 2.0 * waves)
        self.mouth = np.full(n, scale * np.pi)
        self.at_wall = (-1.0) ** (k + n) * np.tan(0.5 * node) / n
        self.at_tip = (-1.0) ** (k + 1) / np.tan(0.5 * node) / n


def stress_intensity(length: float, stress: np.ndarray | None = None, n: int = 300) -> float:
    """K / sqrt(pi a) of two free cracks; by default under unit compression along them.

    `stress` is a function of the distance from the centre, the stress across the closed cracks.
    """
    line = CrackLine(length, n)
    load = crown_hoop(line.x - 1.0) if stress is None else stress(line.x)
    system = np.vstack([line.stress, line.at_wall])
    density = np.linalg.solve(system, np.append(-load, 0.0))
    return float(2.0 * np.pi * np.sqrt(0.5) * line.at_tip @ density)


@lru_cache(maxsize=256)
def _at_length(length: float, brittleness: float) -> tuple[float, float]:
    """Pressure over ft, and opening of the mouth over w_c, of cohesive cracks of a length.

    Their tip bears no singular stress. `brittleness` is ft R / (E' w_c).
    """
    line = CrackLine(length)
    n = line.mouth.size
    system = np.zeros((n + 1, n + 1))
    system[: n - 1, :n] = line.stress + brittleness * line.opening
    system[: n - 1, n] = crown_hoop(line.x - 1.0)
    system[n - 1, :n], system[n, :n] = line.at_wall, line.at_tip
    known = np.append(np.ones(n - 1), [0.0, 0.0])
    solved = np.linalg.solve(system, known)
    return float(solved[n]), float(brittleness * line.mouth @ solved[:n])


@cache
def primary_cohesive(
    ft: float, young: float, poisson: float, gf: float, radius: float
) -> tuple[float, float]:
    """Pressure [Pa] and length [m] at which cohesive cracks come free; NaN where they never do.

    A crack grows steadily with the pressure until its mouth bears nothing any more, which is where
    a run inserts its first crack, or until it can grow at a falling pressure and runs on by itself.
    The latter comes first in holes that are large beside E' Gf / ft^2, and the pressure is near ft.
    In small ones the mouth opens as p R / E', so the pressure goes nearly as 1 / R.
    """
    brittleness = ft * radius / (plane_modulus(young, poisson) * 2.0 * gf / ft)

    def short_of_open(length: float) -> float:
        return _at_length(length, brittleness)[1] - 1.0

    def pressure(length: float) -> float:
        return _at_length(length, brittleness)[0]

    low = SHORTEST
    while low < LONGEST:
        high = FACTOR * low
        if pressure(high) < pressure(low):
            around = (low / FACTOR, high)
            length = minimize_scalar(lambda x: -pressure(x), bounds=around, method="bounded").x
            return ft * pressure(length), float(length) * radius
        if short_of_open(high) >= 0.0:
            length = brentq(short_of_open, low, high, rtol=1e-9)
            return ft * pressure(length), length * radius
        low = high
    return float("nan"), float("nan")
