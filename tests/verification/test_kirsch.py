"""Block with a hole: stress concentration against the finite-width series, crown onset and damping.

The quarter model of `configs/cases/kirsch.yaml` under a slowly raised pressure, on three meshes.
"""

import math
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from lithofrac.analysis.kirsch_series import plate
from lithofrac.config.case import Case, load_case
from lithofrac.core import Energy, Run
from lithofrac.problem import Mesh
from lithofrac.scenes.make import make_mesh, make_problem

pytestmark = pytest.mark.verification
CASE = Path(__file__).parents[2] / "configs" / "cases" / "kirsch.yaml"
WALL_ELEMENTS = (6, 12, 24)  # per radius
SPEED = 0.02  # [m/s], of the platens of Klerck, Sellers & Owen 2004, section 3.3


# The reference


def test_series_tends_to_kirsch_in_a_wide_plate():
    wide = plate(1000.0, 1000.0)
    assert wide.misfit < 1e-8
    assert wide.crown == pytest.approx(-1.0, abs=1e-5)
    assert wide.sidewall == pytest.approx(3.0, abs=1e-5)


@pytest.mark.parametrize(
    ("ratio", "printed"), [(0.1, 3.03), (0.2, 3.14), (0.3, 3.36), (0.4, 3.74), (0.5, 4.32)]
)
def test_series_agrees_with_howland_in_a_long_strip(ratio, printed):
    """Gross stress concentration of Howland (1930), computed by hand to within 1 %.

    The converged series lies 0.2 to 0.6 % above his values.
    """
    strip = plate(1 / ratio, 3 / ratio)
    assert strip.misfit < 2e-4
    assert strip.sidewall == pytest.approx(printed, rel=0.01)


@pytest.mark.parametrize(("half_width", "half_height"), [(4.0, 4.0), (2.0, 2.0), (3.0, 8.0)])
def test_series_carries_the_load_across_every_section(half_width, half_height):
    """Resultants over both symmetry lines, which the fit at the outer boundary has not seen."""
    solved = plate(half_width, half_height)
    assert solved.misfit < 2e-4
    for end, component, resultant in ((half_width, 1, half_width), (half_height, 0, 0.0)):
        points, weights = np.polynomial.legendre.leggauss(200)
        along = 1 + (points + 1) / 2 * (end - 1)
        line = (along, 0 * along) if component == 1 else (0 * along, along)
        force = (weights * solved.stress(*line)[component]).sum() * (end - 1) / 2
        assert force == pytest.approx(resultant, abs=1e-4 * half_width)


# The quarter model


@dataclass(frozen=True)
class Settled:
    """An elastic block at the end of its run."""

    case: Case
    mesh: Mesh
    stress: np.ndarray  # (m, 4) over the applied compression
    displacement: np.ndarray  # (n, 2) [m]
    energy: Energy


@cache  # shared by the tests below
def settled(wall_elements: int) -> Settled:
    """Run the Kirsch case with this many wall elements per radius."""
    changes = {
        "scene.wall_elements_per_radius": float(wall_elements),
        "scene.far_elements_per_radius": wall_elements / 4,
    }
    case = load_case(CASE, changes)
    mesh = make_mesh(case)
    problem = make_problem(case, mesh)
    run = Run(problem)
    run.advance(math.ceil(problem.end_time / run.dt))
    stress = run.elements(np.arange(len(mesh.triangles))).stress / case.loading.stress
    return Settled(case, mesh, stress, run.nodes()[0], run.energy())


def from_stress(block: Settled, crown: bool) -> float:
    """Hoop stress at the wall from the element stresses around it, tension positive.

    Least squares over the elements whose centroid lies within 0.6 R of the wall and 0.6 rad of
    the point, weighted by their area, with a polynomial in 1 - (R/r)^2 (degree 2) and in the
    square of the angle (degree 2; odd terms vanish by symmetry); its value at the wall is taken.
    In 1 - (R/r)^2 the hoop stress of Kirsch is of degree 2, so that this degree is enough on a
    large patch. The patch does not shrink with the elements: the result is then a smooth
    functional of the displacements and converges with their order 2. A patch of some rows of
    elements would be left with the one-sided error of the first row, which is of order 1 and
    grows by extrapolation.
    """
    x, y = block.mesh.centroids().T / block.case.scene.radius
    r, c, s = np.hypot(x, y), x / np.hypot(x, y), y / np.hypot(x, y)
    xx, yy, _, xy = block.stress.T
    hoop = xx * s**2 + yy * c**2 - 2 * xy * c * s
    angle = np.arctan2(x, y) if crown else np.arctan2(y, x)
    near = (r < 1.6) & (angle < 0.6)
    depth, square = 1 - 1 / r[near] ** 2, angle[near] ** 2
    terms = np.stack([depth**i * square**j for i in range(3) for j in range(3)], axis=1)
    weight = np.sqrt(block.mesh.areas()[near])
    return float(np.linalg.lstsq(terms * weight[:, None], hoop[near] * weight, rcond=None)[0][0])


def from_displacement(block: Settled, crown: bool) -> float:
    """The same from the displacements of the wall nodes alone.

    The hoop strain is u_r / R + du_t / (R dt), with u_r and u_t fitted by an even and an odd
    polynomial of the angle; the wall is free, so the hoop stress is E / (1 - nu^2) times it.
    """
    wall = block.mesh.nodes_of("hole")
    radius, rock = block.case.scene.radius, block.case.material
    x, y = block.mesh.nodes[wall].T / radius
    u, v = block.displacement[wall].T
    angle = np.arctan2(x, y) if crown else np.arctan2(y, x)
    radial, around = u * x + v * y, (u * y - v * x) * (1 if crown else -1)
    near = angle < 0.8
    even = angle[near, None] ** [0, 2, 4]
    odd = angle[near, None] ** [1, 3, 5]
    strain = np.linalg.lstsq(even, radial[near], rcond=None)[0][0]
    strain += np.linalg.lstsq(odd, around[near], rcond=None)[0][0]
    stress = rock.young / (1 - rock.poisson**2) * strain / radius
    return float(stress / block.case.loading.stress)


@pytest.mark.parametrize("wall_elements", WALL_ELEMENTS)
def test_recovery_from_exact_element_stresses_gives_the_exact_wall_stress(wall_elements):
    """What the least squares add to the error of the elements: far less than the 1 % allowed."""
    block = settled(wall_elements)
    half = block.case.scene.block_over_radius / 2
    exact = plate(half, half)
    xx, yy, xy = -exact.stress(*block.mesh.centroids().T / block.case.scene.radius)
    sampled = replace(block, stress=np.stack([xx, yy, 0 * xx, xy], axis=1))
    assert from_stress(sampled, crown=True) == pytest.approx(-exact.crown, rel=0.0025)
    assert from_stress(sampled, crown=False) == pytest.approx(-exact.sidewall, rel=0.0025)


@pytest.mark.parametrize("recovery", [from_stress, from_displacement])
@pytest.mark.parametrize("point", ["crown", "sidewall"])
def test_stress_concentration_converges_to_the_finite_plate(point, recovery):
    half = settled(WALL_ELEMENTS[0]).case.scene.block_over_radius / 2
    exact = -getattr(plate(half, half), point)  # the block is compressed
    found = np.array([recovery(settled(n), point == "crown") for n in WALL_ELEMENTS])
    errors = abs(found / exact - 1)
    orders = -np.diff(np.log(errors)) / np.diff(np.log(WALL_ELEMENTS))
    order = np.log(errors[0] / errors[-1]) / np.log(WALL_ELEMENTS[-1] / WALL_ELEMENTS[0])
    print(
        f"\n{point} {recovery.__name__}: exact {exact:.4f}, found {found.round(4)}, errors "
        f"{(100 * errors).round(3)} %, orders {orders.round(2)}, overall {order:.2f}"
    )
    assert (np.diff(errors) < 0).all()
    assert errors[-1] < 0.01
    assert order > 1.5


@pytest.mark.parametrize("wall_elements", WALL_ELEMENTS)
def test_block_is_at_rest_and_the_ledger_closes(wall_elements):
    energy = settled(wall_elements).energy
    print(f"\nKE/IE {energy.kinetic / energy.internal:.2e}, residual {energy.residual:.2e}")
    assert energy.kinetic < 1e-6 * energy.internal
    assert abs(energy.residual) < 1e-8


# Crown onset


def crown_onset(speed: float, fraction: float, relative_to: str = "affine") -> float:
    """Mean axial stress [MPa] at which the crown element of limestone first loses strength."""
    changes = {
        "material": "tyndall_limestone",
        "scene.wall_elements_per_radius": 6.0,
        "scene.far_elements_per_radius": 1.5,
        "loading": {
            "kind": "velocity",
            "speed_m_s": speed,
            "end_strain": 3e-4,
            "ramp_transits": 5.0,
        },
        "damping.fraction": fraction,
        "damping.relative_to": relative_to,
    }
    case = load_case(CASE, changes)
    problem = make_problem(case, make_mesh(case))
    run = Run(problem)
    crown = np.array([problem.probes["crown"]])
    top = [load.name for load in problem.velocity_loads].index("top")
    virgin = case.material.tensile_strength * (1 - 1e-9)
    for _ in range(math.ceil(problem.end_time / run.dt)):
        run.advance(1)
        if run.elements(crown).tensile_strength.min() < virgin:
            return abs(run.loads()[top, 0]) / problem.measures.area / 1e6
    raise AssertionError("the crown has not reached its tensile strength")


@pytest.mark.parametrize("speed", [SPEED, 0.1])
def test_affine_damping_leaves_crown_onset_and_plain_damping_drags(speed):
    """Mean axial stress at the first loss of strength, against that of an undamped run."""
    free = crown_onset(speed, 0.0)
    affine = crown_onset(speed, 0.3)
    ground = crown_onset(speed, 0.3, "ground")
    print(
        f"\n{speed} m/s: crown onset {free:.4f} MPa undamped, {affine:.4f} affine "
        f"({100 * (affine / free - 1):+.2f} %), {ground:.4f} ground "
        f"({100 * (ground / free - 1):+.2f} %)"
    )
    assert abs(affine / free - 1) < 0.02
    assert ground / free - 1 > 0.05


def test_damped_onset_at_the_speed_of_the_scene_is_that_of_slow_loading():
    slow = crown_onset(SPEED / 4, 0.03)
    damped = crown_onset(SPEED, 0.3)
    print(f"\ncrown onset {slow:.4f} MPa at {SPEED / 4} m/s, {damped:.4f} at {SPEED} m/s")
    assert damped == pytest.approx(slow, rel=0.02)
