"""Waves, orders of convergence and the energy ledger of the elastic continuum."""

import numpy as np
import pytest
from models import Elastic, hold, problem, rectangle

from lithofrac.core import Run
from lithofrac.problem import Damping, PressureLoad, Ramp

pytestmark = pytest.mark.verification
UNIT = Elastic(young=1.0, poisson=0.25, density=1.0)


def rollers(mesh, names=("left", "right", "bottom", "top")):
    """Normal displacement held on the named sides."""
    component = {"left": 0, "right": 0, "bottom": 1, "top": 1}
    return tuple(hold(name, mesh.nodes_of(name), component[name]) for name in names)


def standing_wave(nodes, time, amplitude=1e-7):
    """Exact P-wave mode of the unit square on rollers: u = grad(cos pi x cos pi y) cos(omega t)."""
    x, y = np.pi * nodes.T
    shape = -amplitude * np.column_stack([np.sin(x) * np.cos(y), np.cos(x) * np.sin(y)])
    return shape * np.cos(np.pi * np.sqrt(2.0 * UNIT.modulus) * time)


def standing_stress(points, time, amplitude=1e-7):
    """sigma_xx of `standing_wave`."""
    x, y = np.pi * points.T
    strain = -amplitude * np.pi * np.cos(x) * np.cos(y)
    omega = np.pi * np.sqrt(2.0 * UNIT.modulus)
    shear = UNIT.young / (2 * (1 + UNIT.poisson))
    return (2 * UNIT.modulus - 2 * shear) * strain * np.cos(omega * time)


def wave_errors(n):
    """Relative L2 errors of displacement and of sigma_xx on an n by n distorted mesh at t = 0.4."""
    mesh = rectangle(n, n, jitter=0.15, seed=n)
    run = Run(problem(mesh, UNIT, velocity_loads=rollers(mesh)))
    run.set_motion(standing_wave(mesh.nodes, 0.0), np.zeros_like(mesh.nodes))
    run.advance(round(0.4 / run.dt))
    time = run.step * run.dt
    u, _, mass = run.nodes()
    exact = standing_wave(mesh.nodes, time)
    weight = mass[:, None]
    displacement = np.sqrt((weight * (u - exact) ** 2).sum() / (weight * exact**2).sum())
    stress = run.elements(np.arange(len(mesh.triangles))).stress[:, 0]
    # CST stress is first order where it is compared point by point inside the element
    corner = standing_stress(mesh.nodes[mesh.triangles[:, 0]], time)
    areas = mesh.areas()
    error = np.sqrt((areas * (stress - corner) ** 2).sum() / (areas * corner**2).sum())
    return displacement, error


def test_displacement_converges_with_order_two_and_stress_with_order_one():
    sizes = np.array([16, 32, 64])
    errors = np.array([wave_errors(n) for n in sizes])
    orders = -np.diff(np.log(errors), axis=0) / np.log(2.0)
    print(f"orders of displacement {orders[:, 0]}, of stress {orders[:, 1]}")
    assert orders[-1, 0] == pytest.approx(2.0, abs=0.1)
    assert orders[-1, 1] == pytest.approx(1.0, abs=0.1)


def test_time_integration_converges_with_order_two():
    mesh = rectangle(6, 6, jitter=0.15)

    def final(factor, steps):
        run = Run(problem(mesh, UNIT, velocity_loads=rollers(mesh), time_step_factor=factor))
        run.set_motion(standing_wave(mesh.nodes, 0.0), np.zeros_like(mesh.nodes))
        run.advance(steps)
        return run.nodes()[0]

    reference = final(0.8 / 64, 6400)
    errors = [np.linalg.norm(final(0.8 / k, 100 * k) - reference) for k in (1, 2, 4, 8)]
    orders = -np.diff(np.log(errors)) / np.log(2.0)
    print(f"orders of time {orders}")
    assert orders[-1] == pytest.approx(2.0, abs=0.05)


def test_a_pressure_wave_travels_at_its_speed():
    """A ramped pressure on a long bar between rollers: velocity p/(rho c) behind the front."""
    material = Elastic()
    speed = np.sqrt(material.modulus / material.density)
    mesh = rectangle(200, 4, 1.0, 0.02)
    ramp = Ramp(0.0, 0.1 / speed)
    push = PressureLoad("left", mesh.edge_sets["left"], 1e5, 0.0, ramp)
    run = Run(
        problem(
            mesh,
            material,
            velocity_loads=rollers(mesh, ("bottom", "top")),
            pressure_loads=(push,),
        )
    )
    run.advance(round(0.7 / speed / run.dt))
    _, velocity, _ = run.nodes()
    behind = abs(mesh.nodes[:, 0] - 0.3) < 0.05
    exact = 1e5 / (material.density * speed)
    assert velocity[behind, 0].mean() == pytest.approx(exact, rel=2e-3)
    # the front: half of the velocity is reached when half of the ramp has passed
    row = np.flatnonzero(abs(mesh.nodes[:, 1]) < 1e-9)
    row = row[np.argsort(-mesh.nodes[row, 0])]
    front = np.interp(0.5 * exact, velocity[row, 0], mesh.nodes[row, 0])
    time = (run.step + 0.5) * run.dt - 0.05 / speed
    assert front == pytest.approx(speed * time, rel=2e-3)


def test_elastic_ledger_closes():
    """Two sides of the ledger, pressure, prescribed velocity, damping and a free wave."""
    mesh = rectangle(20, 40, 0.01, 0.02, jitter=0.2)
    for damping in ("affine", "ground"):
        run = Run(
            problem(
                mesh,
                velocity_loads=(
                    hold("bottom", mesh.nodes_of("bottom"), 1),
                    hold("top", mesh.nodes_of("top"), 1, -0.1, ramp=Ramp(0.0, 2e-5)),
                ),
                pressure_loads=(
                    PressureLoad("right", mesh.edge_sets["right"], 5e6, 1e11, Ramp(0.0, 2e-5)),
                ),
                damping=Damping(fraction=0.3, relative_to=damping),
            )
        )
        worst = 0.0
        for _ in range(400):
            run.advance(10)
            energy = run.energy()
            worst = max(worst, abs(energy.residual))
        assert energy.external > energy.kinetic > 0.0
        assert energy.damping < 0.0
        assert worst < 1e-8


def test_energy_smuggled_into_the_state_shows_as_residual():
    """The residual is a measurement: displace one node behind the back of the ledger."""
    mesh = rectangle(4, 4, jitter=0.2)
    run = Run(problem(mesh))
    rng = np.random.default_rng(1)
    run.set_motion(np.zeros_like(mesh.nodes), 1e-3 * rng.normal(size=mesh.nodes.shape))
    run.advance(100)
    run.energy()
    state, honest = run.save(), abs(run.energy().residual)
    assert honest < 1e-7
    u = run.nodes()[0].ravel()
    first = next(i for i in range(len(state)) if np.array_equal(state[i : i + len(u)], u))
    state[first + 20] += 0.1 * abs(u).max()
    run.restore(state)
    assert abs(run.energy().residual) > 1e-3


def test_ledger_of_a_yielding_specimen_closes():
    from test_determinism import yielding

    run = Run(yielding())
    for _ in range(20):
        run.advance(100)
        energy = run.energy()
    assert energy.compressive > 0.1 * energy.elastic
    assert abs(energy.residual) < 1e-6
