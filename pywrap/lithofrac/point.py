"""The material point on a bench: strain it, or drive it through a laboratory test.

Arrays have one row per point. Components are xx, yy, zz, xy; stress is in pascal, tension
positive; shear strain is engineering. The law is Klerck, Sellers & Owen 2004, sections 2.2-2.4.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from lithofrac import kernels
from lithofrac.errors import CoreError

MPA = 1e6
TESTS = ("triaxial", "plane_strain", "extension", "tension", "stiff_confinement")
STEPS = 400  # of a test, besides those that land on the knots of the table


@dataclass(frozen=True)
class State:
    """What a batch of n points remembers.

    `tensile_strength[:, 0]` belongs to the in-plane axis at `axis_angle`, `[:, 1]` to the one
    at 90 degrees to it and `[:, 2]` to zz; so do the columns of `opening`.
    """

    stress: np.ndarray  # (n, 4) [Pa]
    plastic_strain: np.ndarray  # (n,) effective, eq. 7
    tensile_strength: np.ndarray  # (n, 3) [Pa]
    axis_angle: np.ndarray  # (n,) [rad], from x
    opening: np.ndarray  # (n, 3) positive inelastic strain that has accrued
    crack: np.ndarray  # (n, 2) eq. 13: sum of damage times (cos, sin) of the doubled direction

    @classmethod
    def virgin(cls, rock, n: int = 1) -> State:
        """Points without stress that have seen no inelastic strain."""
        strength = np.full((n, 3), as_material(rock).tensile_strength)
        return cls(
            np.zeros((n, 4)), np.zeros(n), strength, np.zeros(n), np.zeros((n, 3)), np.zeros((n, 2))
        )

    @property
    def crack_direction(self) -> np.ndarray:
        """Angle of the crack band's normal (n,) [rad], eq. 13; NaN without damage."""
        angle = 0.5 * np.arctan2(self.crack[:, 1], self.crack[:, 0])
        return np.where(np.hypot(*self.crack.T) > 0.0, angle, np.nan)


@dataclass(frozen=True)
class Info:
    """What happened in one step of n points."""

    code: np.ndarray  # (n,) 0, or 2 where no consistent return was found (state unchanged)
    inelastic_strain: np.ndarray  # (n, 3) increment along the axes of the new state
    compressive_strain: np.ndarray  # (n, 3) the part of it from Mohr-Coulomb planes
    inelastic_tensor: np.ndarray  # (n, 4) increment, engineering shear
    active: np.ndarray  # (n,) bits of `kernels.ACTIVE_PLANES`, 0 when elastic


def as_material(rock):
    """A `Material` from its name, the path of its file, or itself."""
    if isinstance(rock, str | Path):
        from lithofrac.config.material import Material

        return Material.load(rock)
    return rock


def softening_modulus(rock, length_m) -> np.ndarray:
    """H [Pa], not positive, of crack bands of width `length_m` [m] (eq. 16).

    Raises
    ------
    ValueError
        When a width is not positive, or lies above the limit |H| < 2 G of a unique answer or
        above that of compressive softening without snap-back.
    """
    rock = as_material(rock)
    length = np.asarray(length_m, dtype=float)
    if not np.all(length > 0.0):
        raise ValueError(f"length_m must be positive, got {float(np.min(length)):g}")
    if not rock.options[3]:
        return np.zeros_like(length)
    limit = kernels.rock_scales(rock).band_width_limit
    if np.any(length >= limit):
        raise ValueError(
            f"length_m = {float(np.max(length)):g} m: above {limit:.4g} m several crack planes "
            "have no unique return (|H| < 2 G); use smaller elements or a larger fracture energy"
        )
    limit = rock.compressive_width_limit
    if np.any(length >= limit):
        raise ValueError(
            f"length_m = {float(np.max(length)):g} m: above {limit:.4g} m compressive softening is "
            "steeper than elastic unloading; use smaller elements or a larger reference_size_mm"
        )
    return -length * rock.tensile_strength**2 / (2.0 * rock.fracture_energy)


def step(rock, strain_increment, state: State, length_m=1e-3) -> tuple[State, Info]:
    """Strain each point by one increment.

    Parameters
    ----------
    rock : name, path or `Material`
    strain_increment : (n, 4), engineering shear
    state : of n points; it is not changed
    length_m : crack band width [m], one number or (n,)

    Raises
    ------
    ValueError
        When a shape does not fit or the band is too wide.
    CoreError
        When the rock makes no sense.
    """
    rock = as_material(rock)
    strain = np.asarray(strain_increment, dtype=float)
    n = len(state.plastic_strain)
    if strain.shape != (n, 4):
        raise ValueError(f"strain_increment has shape {strain.shape}, expected {(n, 4)}")
    softening = np.broadcast_to(softening_modulus(rock, length_m), (n,))
    axis = np.column_stack([np.cos(2 * state.axis_angle), np.sin(2 * state.axis_angle)])
    stress, plastic, strength, opening, axis, crack, dep, compressive, active, code = (
        kernels.point_step(
            rock,
            softening,
            strain,
            state.stress,
            state.plastic_strain,
            state.tensile_strength,
            state.opening,
            axis,
            state.crack,
        )
    )
    angle = 0.5 * np.arctan2(axis[:, 1], axis[:, 0])
    info = Info(code, _along(dep, axis), _along(compressive, axis), dep, active)
    return State(stress, plastic, strength, angle, opening, crack), info


def drive(
    rock,
    test: str = "triaxial",
    confinement_MPa: float = 0.0,
    end_strain: float = 0.025,
    steps: int | Sequence[float] = STEPS,
    length_m: float = 1e-3,
    stiffness: float = 0.02,
) -> pd.DataFrame:
    """One element through a laboratory test, axis along y, from hydrostatic confinement.

    Parameters
    ----------
    rock : name, path or `Material`
    test : "triaxial" (xx = zz at constant pressure), "plane_strain" (xx at constant pressure, no
        strain along z), "stiff_confinement" (plane strain whose pressure grows by `stiffness`
        times Young's modulus times the lateral strain), "extension" (axial stretching at constant
        pressure) or "tension" (the same without pressure)
    confinement_MPa : initial pressure, not negative
    end_strain : axial strain at the end, a positive number also in extension; the default lies
        beyond the peak of all three rocks up to 40 MPa
    steps : number of equal steps, or the increasing positive axial strains to visit
    length_m : crack band width [m]

    Returns
    -------
    One row per step; steps are added where the plastic strain meets a knot of the table, so that
    peaks are not missed. Axial and lateral stresses and the axial strain are compression
    positive, the lateral strain extension positive, the volumetric strain dilation positive.

    Raises
    ------
    ValueError
        When there is no such test, or a number is outside the range named above.
    CoreError
        When no lateral strain meets the pressure, or no consistent return is found.
    """
    rock = as_material(rock)
    if test not in TESTS:
        raise ValueError(f"test '{test}': expected one of {', '.join(TESTS)}")
    if not confinement_MPa >= 0.0 or (test == "tension" and confinement_MPa):
        raise ValueError(f"confinement_MPa = {confinement_MPa:g} makes no sense in test '{test}'")
    bench = _Bench(rock, test, confinement_MPa * MPA, length_m, stiffness * rock.young)
    path = _path(end_strain, steps)
    sense = 1.0 if test in ("extension", "tension") else -1.0
    for strain in path:
        bench.advance(sense * float(strain))
    return bench.frame()


def _path(end_strain: float, steps: int | Sequence[float]) -> np.ndarray:
    """The axial strains to visit, all positive and each above the one before."""
    if not 0.0 < end_strain < np.inf:
        raise ValueError(f"end_strain = {end_strain:g}: expected a positive number in every test")
    if np.ndim(steps) == 0:
        if steps < 1:
            raise ValueError(f"steps = {steps}: expected at least one")
        return np.linspace(0.0, end_strain, int(steps) + 1)[1:]
    path = np.asarray(steps, dtype=float)
    if path.ndim != 1 or not np.all(np.diff(path, prepend=0.0) > 0.0):
        raise ValueError("steps: expected positive axial strains, each above the one before")
    return path


class _Bench:
    """One point under mixed control: axial strain and lateral pressure are prescribed."""

    def __init__(self, rock, test: str, pressure: float, length: float, spring: float):
        self.rock = rock
        self.triaxial = test in ("triaxial", "extension", "tension")
        self.pressure = pressure
        self.spring = spring if test == "stiff_confinement" else 0.0
        self.table = rock.table_of_band(length)
        self.knots = self.table[0] if rock.options[2] else np.zeros(0)
        self.scales = kernels.rock_scales(rock)
        self.packed = kernels.pack(rock)
        self.softening = np.atleast_1d(softening_modulus(rock, length))
        stress = np.array([[-pressure, -pressure, -pressure, 0.0]])
        virgin = State.virgin(rock)
        self.state = [
            stress,
            virgin.plastic_strain,
            virgin.tensile_strength,
            virgin.opening,
            np.array([[1.0, 0.0]]),
            virgin.crack,
        ]
        self.strain = np.zeros(4)
        self.work = self._elastic_energy(stress[0])
        self.rows: list[dict] = []
        self._record(0)

    def advance(self, axial: float) -> None:
        """Strain to `axial` (tension positive), by way of the knots that lie between."""
        while True:
            state, active, strain = self._solve(axial)
            crossed = self.knots[(self.knots > self._plastic()) & (self.knots < state[1][0])]
            if len(crossed) == 0:
                self._accept(state, active, strain)
                return
            self._land(crossed[0], axial)

    def _plastic(self) -> float:
        return self.state[1][0]

    def _land(self, knot: float, axial: float) -> None:
        """Take the part of the step at whose end the plastic strain is `knot`."""
        start = self.strain[1]

        def miss(fraction: float) -> float:
            return self._solve(start + fraction * (axial - start))[0][1][0] - knot

        fraction = brentq(miss, 0.0, 1.0, xtol=1e-15, rtol=1e-14)
        state, active, strain = self._solve(start + fraction * (axial - start))
        # Rounding may leave the strain a hair short of the knot: put it there, or it is met again.
        state[1] = np.maximum(state[1], knot)
        self._accept(state, active, strain)

    def _solve(self, axial: float) -> tuple[list[np.ndarray], int, np.ndarray]:
        """Step to `axial` with the lateral strain that meets the prescribed pressure."""
        total = self.strain.copy()
        total[1] = axial
        lame, shear = self.scales.lame, self.scales.shear
        stiff = 2.0 * (lame + shear) if self.triaxial else lame + 2.0 * shear
        last: list = []

        def excess(lateral: float) -> float:
            total[0] = lateral
            total[2] = lateral if self.triaxial else 0.0
            increment = (total - self.strain)[None, :]
            last[:] = kernels.point_step(self.packed, self.softening, increment, *self.state)
            if last[9][0]:
                raise CoreError(f"no consistent return at axial strain {axial:.6g}")
            return last[0][0, 0] + self.pressure + self.spring * lateral

        # From the old lateral strain: a softened rock has other roots further away.
        tolerance = 1e-13 * self.scales.strength_scale
        _root(excess, self.strain[0], stiff + self.spring, tolerance)
        return last[:6], int(last[8][0]), total

    def _accept(self, state: list[np.ndarray], active: int, strain: np.ndarray) -> None:
        change = strain - self.strain
        self.work += 0.5 * float((state[0][0] + self.state[0][0]) @ change)
        self.state, self.strain = state, strain
        self._record(active)

    def _elastic_energy(self, stress: np.ndarray) -> float:
        """Energy per volume [J/m3]."""
        volume = stress[:3].sum()
        squares = stress[:3] @ stress[:3] + 2.0 * stress[3] ** 2
        rock = self.rock
        return ((1.0 + rock.poisson) * squares - rock.poisson * volume**2) / (2.0 * rock.young)

    def _record(self, active: int) -> None:
        stress, strength = self.state[0][0] / MPA, self.state[2][0] / MPA
        lateral, axial, across = self.strain[:3]
        first_is_x = self.state[4][0, 0] >= 0.0
        plastic = self._plastic()
        table = self.table
        self.rows.append(
            {
                "axial_strain": -axial,
                "axial_stress_MPa": -stress[1],
                "lateral_strain": lateral,
                "lateral_stress_MPa": -stress[0],
                "out_of_plane_stress_MPa": -stress[2],
                "volumetric_strain": axial + lateral + across,
                "plastic_strain": plastic,
                "cohesion_MPa": np.interp(plastic, table[0], table[1]) / MPA,
                "friction_angle_deg": np.degrees(np.interp(plastic, table[0], table[2])),
                "dilation_angle_deg": np.degrees(np.interp(plastic, table[0], table[3])),
                "tensile_strength_lateral_MPa": strength[0 if first_is_x else 1],
                "tensile_strength_axial_MPa": strength[1 if first_is_x else 0],
                "tensile_strength_out_of_plane_MPa": strength[2],
                "dissipated_J_m3": self.work - self._elastic_energy(self.state[0][0]),
                "active": active,
            }
        )

    def frame(self) -> pd.DataFrame:
        """All rows so far."""
        return pd.DataFrame(self.rows)


def _root(function: Callable[[float], float], guess: float, stiffness: float, tolerance: float):
    """Solve function(x) = 0 for a function that rises nowhere faster than `stiffness`.

    The last call of `function` is at the root: regula falsi (Illinois), halved now and then.
    """
    value = function(guess)
    if abs(value) <= tolerance:
        return
    near, at_near, reach = guess, value, abs(value) / stiffness
    for _ in range(60):
        far = near - np.copysign(reach, value)
        at_far = function(far)
        if abs(at_far) <= tolerance:
            return
        if at_far * at_near < 0.0:
            break
        slope = (at_far - at_near) / (far - near)
        reach = min(8.0 * reach, 1.1 * abs(at_far) / slope) if slope > 0.0 else 2.0 * reach
        near, at_near = far, at_far
    else:
        raise CoreError("no lateral strain meets the prescribed pressure")
    for trip in range(200):
        middle = far - at_far * (far - near) / (at_far - at_near)
        if trip % 8 == 7 or not min(near, far) < middle < max(near, far):
            middle = 0.5 * (near + far)
        at_middle = function(middle)
        if abs(at_middle) <= tolerance or abs(far - near) <= 4e-16 * abs(far):
            return
        if at_middle * at_far < 0.0:
            near, at_near = far, at_far
        else:
            at_near *= 0.5
        far, at_far = middle, at_middle


def _along(tensor: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Normal components (n, 3) of strain tensors (n, 4) along axes (n, 2)."""
    halved = tensor * np.array([1.0, 1.0, 1.0, 0.5])
    return kernels.rotate_axes(halved, axis)
