"""Initiation about a circular hole under uniaxial compression, from ft, E, nu and Gf alone.

Independent of the finite elements and of the crack band: infinite plate, plane strain. Pressures p
are positive in compression and act along the load axis; the primary cracks run along it, from the
crown and the invert of a hole of radius R.

Sources: Kirsch (1898), Z. Ver. Dtsch. Ing. 42, 797; Lajtai (1972), Int. J. Rock Mech. Min. Sci. 9,
569; Whitney & Nuismer (1974), J. Compos. Mater. 8, 253; Leguillon (2002), Eur. J. Mech. A 21, 61;
Cornetti, Pugno, Carpinteri & Taylor (2006), Eng. Fract. Mech. 73, 2021; Taylor (2008), Eng. Fract.
Mech. 75, 1696; Tada, Paris & Irwin, The Stress Analysis of Cracks Handbook, two equal cracks from
a circular hole in an infinite plate.
"""

from functools import cache

import numpy as np
from scipy.optimize import brentq

from lithofrac.analysis.mohr_coulomb import first_yield, peak_strength

CROWN, SIDEWALL = 1.0, 3.0  # hoop tension and hoop compression at the wall over p (Kirsch)
GAUSS = np.polynomial.legendre.leggauss(48)  # points and weights on (-1, 1)
LONGEST = 3.0  # crack over radius, beyond which the mean release rate has long been falling


def plane_modulus(young: float, poisson: float) -> float:
    """Plane strain modulus E / (1 - nu^2), unit of E."""
    return young / (1.0 - poisson**2)


def toughness(young: float, poisson: float, gf: float) -> float:
    """K_IC = sqrt(E' Gf) in plane strain [Pa sqrt(m)] (Irwin)."""
    return float(np.sqrt(plane_modulus(young, poisson) * gf))


def crown_hoop(distance: np.ndarray) -> np.ndarray:
    """Hoop tension on the load axis over p, at `distance` from the wall in radii (Kirsch).

    1 at the wall, 0 at sqrt(3) - 1, compressive beyond; its integral to infinity is 0.
    """
    q = 1.0 / (1.0 + np.asarray(distance, dtype=float)) ** 2
    return 1.5 * q**2 - 0.5 * q


def mean_crown_hoop(length: np.ndarray) -> np.ndarray:
    """Mean of `crown_hoop` from the wall to `length` [radii], in closed form."""
    length = np.asarray(length, dtype=float)
    t = 1.0 / (1.0 + length)
    return 0.5 * t**2 * (1.0 + t)  # (t - t^3) / (2 length) without its 0/0 at the wall


def primary_kirsch(ft: float) -> float:
    """Pressure [Pa] at which the hoop tension at the crown reaches ft, at any radius (Kirsch)."""
    return ft / CROWN


def sidewall_yield(table: np.ndarray) -> float:
    """Pressure [Pa] at which the sidewall first yields: 3 p is the uniaxial yield (Kirsch).

    `table` is a hardening table as in `Material.table`. The sidewall is free of confinement, and
    Mohr-Coulomb does not see the out-of-plane stress (Klerck 2004, eq. 6).
    """
    return first_yield(table, 0.0) / SIDEWALL


def sidewall_strength(table: np.ndarray) -> float:
    """Pressure [Pa] at which 3 p is the uniaxial strength; without redistribution (Kirsch)."""
    return peak_strength(table, 0.0)[0] / SIDEWALL


def characteristic_length(ft: float, young: float, poisson: float, gf: float) -> float:
    """Length [m] over which stress is averaged, 2/pi (K_IC / ft)^2.

    With it the average over a line ahead of a long sharp crack reaches ft where K = K_IC (Taylor
    2008, line method); so ft and Gf leave nothing to be fitted.
    """
    return 2.0 / np.pi * (toughness(young, poisson, gf) / ft) ** 2


def primary_average(ft: float, length: float, radius: float) -> float:
    """Pressure [Pa] at which the hoop tension averaged over `length` [m] reaches ft.

    Lajtai (1972); Whitney & Nuismer (1974), average stress criterion. Towards ft in large holes,
    2 ft (length / R)^2 in small ones.
    """
    return float(ft / mean_crown_hoop(length / radius))


def crack_factors(length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Factors F0 and F1 of two equal cracks from a hole, for cracks of `length` in radii.

    K_I = sigma sqrt(pi a) [(1 - lambda) F0 + lambda F1] under sigma across the cracks and
    lambda sigma along them (Tada, Paris & Irwin, with s = a / (R + a)).
    """
    s = np.asarray(length, dtype=float) / (1.0 + np.asarray(length, dtype=float))
    f0 = 0.5 * (3.0 - s) * (1.0 + 1.243 * (1.0 - s) ** 3)
    f1 = 1.0 + (1.0 - s) * (0.5 + 0.743 * (1.0 - s) ** 2)
    return f0, f1


def axial_crack_factor(length: np.ndarray) -> np.ndarray:
    """K_I / (p sqrt(pi a)) of two cracks along the load, from the crown and the invert: F0 - F1.

    1.1215 for short cracks, an edge crack under the hoop tension p; 1/2 (R / a)^3 for long ones.
    """
    f0, f1 = crack_factors(length)
    return f0 - f1


def mean_release(length: float) -> float:
    """Mean of K_I^2 / (p^2 R) over cracks from 0 to `length` [radii].

    E' times the mean energy released by a crack that appears at once; Gauss's rule, whose error is
    that of rounding up to `LONGEST`.
    """
    a = 0.5 * length * (1.0 + GAUSS[0])
    return float(0.5 * GAUSS[1] @ (np.pi * a * axial_crack_factor(a) ** 2))


@cache
def easiest_length() -> float:
    """Length [radii] whose mean energy release is the largest; the same for every hole."""
    lengths = np.linspace(0.01, LONGEST, 1000)
    return float(lengths[np.argmax([mean_release(x) for x in lengths])])


def primary_coupled(
    ft: float, young: float, poisson: float, gf: float, radius: float
) -> tuple[float, float]:
    """Pressure [Pa] and length [m] of the primary cracks by finite fracture mechanics.

    The smallest p for which some length meets both conditions: the mean hoop tension over it is at
    least ft, and the energy that its appearance releases is at least Gf times its area (Leguillon
    2002; in this averaged form Cornetti et al. 2006). Towards ft in large holes, where stress
    rules; proportional to 1 / sqrt(R) in small ones, where energy alone does.
    """
    k_over = toughness(young, poisson, gf) / np.sqrt(radius)

    def stress(x: float) -> float:
        return ft / float(mean_crown_hoop(x))

    def energy(x: float) -> float:
        return k_over / np.sqrt(mean_release(x))

    best = easiest_length()
    if stress(best) <= energy(best):  # energy alone rules: stress is high enough all along
        return energy(best), best * radius
    length = brentq(lambda x: stress(x) - energy(x), 1e-12, best, xtol=1e-14)
    return stress(length), length * radius
