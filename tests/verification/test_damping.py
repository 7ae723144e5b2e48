"""Mass damping: what it takes, and what it must leave alone (eqs 1-3; affine: beyond the paper)."""

import numpy as np
import pytest
from models import one_triangle, problem, rectangle

from lithofrac.core import Run
from lithofrac.problem import Damping

pytestmark = pytest.mark.verification
STEPS = 1000
SPIN = np.array([[0.0, -1.0], [1.0, 0.0]])


def body():
    """A distorted 60 by 40 mm mesh of 140 elements."""
    return rectangle(10, 7, 0.06, 0.04, jitter=0.25, seed=4)


def about_centre(mesh):
    """Positions relative to the centre of mass [m], (n, 2)."""
    mass = Run(problem(mesh)).nodes()[2]
    return mesh.nodes - mass @ mesh.nodes / mass.sum()


def launched(mesh, velocity, alpha_dt, relative_to="affine"):
    """A free elastic body of this velocity, after its first half step; alpha dt = 0: undamped."""
    alpha = alpha_dt / Run(problem(mesh)).dt
    run = Run(problem(mesh, damping=Damping(alpha=alpha, relative_to=relative_to)))
    run.set_motion(np.zeros_like(mesh.nodes), velocity)
    run.advance(0)
    run.energy()  # notes the initial energy
    return run


def momenta(run, mesh):
    """Linear momentum (2,) and angular momentum about the origin at the half step."""
    displacement, velocity, mass = run.nodes()
    x = mesh.nodes + displacement
    return mass @ velocity, mass @ (x[:, 0] * velocity[:, 1] - x[:, 1] * velocity[:, 0])


def random_velocity(mesh, seed=8):
    """Random with a net translation and turn [m/s]."""
    rng = np.random.default_rng(seed)
    return rng.normal(size=mesh.nodes.shape) + [2.0, -1.0] + 30.0 * mesh.nodes @ SPIN.T


def test_affine_damping_keeps_linear_and_angular_momentum():
    mesh = body()
    run = launched(mesh, random_velocity(mesh), alpha_dt=0.05)
    linear, angular = momenta(run, mesh)
    start = run.energy().kinetic
    run.advance(STEPS)
    now = momenta(run, mesh)
    taken = -run.energy().damping / start
    errors = np.linalg.norm(now[0] - linear) / np.linalg.norm(linear), now[1] / angular - 1
    print(f"\nlinear {errors[0]:.1e}, angular {errors[1]:.1e}, damping took {taken:.3f} of KE")
    assert taken > 0.05
    assert errors[0] < 1e-12
    assert abs(errors[1]) < 1e-12


def test_rigid_translation_is_not_damped():
    mesh = body()
    velocity = np.tile([3.0, -2.0], (len(mesh.nodes), 1))
    run = launched(mesh, velocity, alpha_dt=0.05)
    run.advance(STEPS)
    _, now, mass = run.nodes()
    np.testing.assert_allclose(mass @ now / mass.sum(), velocity[0], rtol=1e-13)
    # each node alone sees the rounding of its growing displacement as a strain
    np.testing.assert_allclose(now, velocity, rtol=1e-12)


def test_rigid_rotation_is_not_damped():
    """Centrifugal stretching vibrates a little; its share of the energy is (spin size / c)^2."""
    mesh = body()
    velocity = about_centre(mesh) @ SPIN.T
    run = launched(mesh, velocity, alpha_dt=0.05)
    start = run.energy().kinetic
    angular = momenta(run, mesh)[1]
    run.advance(STEPS)
    ground = launched(mesh, velocity, alpha_dt=0.05, relative_to="ground")
    ground.advance(STEPS)
    print(
        f"\ndamping took {-run.energy().damping / start:.1e} of KE, ground took all but "
        f"{ground.energy().kinetic / start:.1e}"
    )
    assert run.energy().kinetic == pytest.approx(start, rel=1e-9)
    assert abs(run.energy().damping) < 1e-9 * start
    assert momenta(run, mesh)[1] == pytest.approx(angular, rel=1e-12)
    assert ground.energy().kinetic < 1e-12 * start


def test_uniform_straining_is_not_damped():
    """The first half step from a uniform rate of strain is that without damping."""
    mesh = body()
    velocity = about_centre(mesh) @ [[5.0, 2.0], [-1.0, -4.0]]
    free, affine, ground = (
        launched(mesh, velocity, alpha_dt, kind).nodes()[1]
        for alpha_dt, kind in ((0.0, "affine"), (0.1, "affine"), (0.1, "ground"))
    )
    scale = abs(free).max()
    assert abs(affine - free).max() < 1e-13 * scale
    assert abs(ground - free).max() > 0.05 * scale


def test_one_triangle_has_only_affine_motion_and_is_never_damped():
    mesh = one_triangle()
    velocity = np.random.default_rng(6).normal(size=(3, 2))
    runs = [launched(mesh, velocity, alpha_dt) for alpha_dt in (0.0, 0.05)]
    start = runs[1].energy().kinetic
    for run in runs:
        run.advance(STEPS)
    free, affine = (run.nodes()[1] for run in runs)
    assert abs(affine - free).max() < 1e-9 * abs(velocity).max()
    assert abs(runs[1].energy().damping) < 1e-12 * start


def test_internal_motion_decays():
    mesh = body()
    run = launched(mesh, random_velocity(mesh), alpha_dt=0.05)
    run.advance(4 * STEPS)
    displacement, velocity, mass = run.nodes()
    x = mesh.nodes + displacement
    basis = np.column_stack([np.ones(len(x)), x - mass @ x / mass.sum()])
    root = np.sqrt(mass)[:, None]
    fit = np.linalg.lstsq(root * basis, root * velocity, rcond=None)[0]
    inner = abs(velocity - basis @ fit).max() / abs(velocity).max()
    print(f"\nlargest velocity off the affine fit {inner:.1e} of the largest velocity")
    assert inner < 0.05


@pytest.mark.parametrize("relative_to", ["affine", "ground"])
@pytest.mark.parametrize("alpha_dt", [0.005, 0.05])
def test_ledger_closes_with_damping(relative_to, alpha_dt):
    """In slow motion: the trapezoid of the nonlinear force errs in proportion to the strain."""
    mesh = body()
    run = launched(mesh, 1e-3 * random_velocity(mesh), alpha_dt, relative_to)
    worst = 0.0
    for _ in range(50):
        run.advance(STEPS // 50)
        worst = max(worst, abs(run.energy().residual))
    energy = run.energy()
    print(f"\nresidual {worst:.1e}, damping work {energy.damping / energy.initial:.3f} of initial")
    assert energy.damping < 0.0
    assert worst < 1e-9


@pytest.mark.parametrize(("alpha_dt", "steps"), [(0.001, 100), (0.05, 100), (0.5, 10)])
def test_ground_damping_slows_a_rigid_translation_by_the_factor_of_eq_3(alpha_dt, steps):
    """v(n + 1/2) = ((2 - alpha dt) / (2 + alpha dt))^n v(1/2), while rounding allows to see it."""
    mesh = body()
    run = launched(mesh, np.tile([3.0, -2.0], (len(mesh.nodes), 1)), alpha_dt, "ground")
    first = run.nodes()[1]
    run.advance(steps)
    factor = ((2 - alpha_dt) / (2 + alpha_dt)) ** steps
    assert abs(run.nodes()[1] - factor * first).max() < 1e-12 * factor * abs(first).max()
