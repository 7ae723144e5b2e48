"""Strength of a homogeneous Mohr-Coulomb element in closed form, from its hardening table.

At effective plastic strain e and confinement p (compression positive) yield is at
sigma_1 = p N + 2 c sqrt(N), N = (1 + sin phi) / (1 - sin phi) (Klerck 2004, eq. 6), with c and phi
linear between the rows of the table and flat beyond them. Tables are as `Material.table`: (4, k),
rows plastic strain, cohesion [Pa], friction angle [rad], dilation angle [rad].
"""

import numpy as np
from scipy.optimize import minimize_scalar


def flow_number(friction: np.ndarray) -> np.ndarray:
    """N of a friction angle [rad]."""
    sine = np.sin(friction)
    return (1.0 + sine) / (1.0 - sine)


def yield_stress(table: np.ndarray, confinement: float, plastic_strain) -> np.ndarray:
    """Major principal stress at yield [Pa], shape of `plastic_strain`."""
    cohesion = np.interp(plastic_strain, table[0], table[1])
    number = flow_number(np.interp(plastic_strain, table[0], table[2]))
    return confinement * number + 2.0 * cohesion * np.sqrt(number)


def first_yield(table: np.ndarray, confinement: float) -> float:
    """Yield stress of the virgin element [Pa]."""
    return float(yield_stress(table, confinement, table[0, 0]))


def residual_strength(table: np.ndarray, confinement: float) -> float:
    """Yield stress beyond the last row of the table [Pa]."""
    return float(yield_stress(table, confinement, table[0, -1]))


def peak_strength(table: np.ndarray, confinement: float) -> tuple[float, float]:
    """Largest yield stress [Pa] over the plastic strain, and the plastic strain [-] it is at.

    Every row of the table is tried, and the inside of every interval: the angle grows while the
    cohesion falls, so the peak may lie between two rows (quartzite at 4.5 MPa).
    """
    strains = list(table[0])
    for low, high in zip(table[0, :-1], table[0, 1:], strict=True):
        found = minimize_scalar(
            lambda strain: -float(yield_stress(table, confinement, strain)),
            bounds=(low, high),
            method="bounded",
            options={"xatol": 1e-9 * (high - low)},
        )
        strains.append(found.x)
    stresses = yield_stress(table, confinement, np.array(strains))
    best = int(np.argmax(stresses))  # rows come first, so a tie goes to a row
    return float(stresses[best]), float(strains[best])


def peak_line(table: np.ndarray, confinements: np.ndarray) -> np.ndarray:
    """Peak strength [Pa] at each confinement [Pa], (n,)."""
    return np.array([peak_strength(table, float(p))[0] for p in confinements])
