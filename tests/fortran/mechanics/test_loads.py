"""Ramps, prescribed velocities and follower pressure (fortran/mechanics/loads.f90)."""

import numpy as np
import pytest
from models import Elastic, hold, problem, rectangle

from lithofrac.core import Run
from lithofrac.problem import Damping, PressureLoad, Ramp


def smooth(s):
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10 + s * (6 * s - 15))


def test_prescribed_velocity_follows_its_ramp():
    mesh = rectangle(2, 2)
    ramp = Ramp(start=3e-5, duration=2e-4)
    run = Run(
        problem(mesh, velocity_loads=(hold("top", mesh.nodes_of("top"), 1, -0.3, ramp=ramp),))
    )
    exact = 0.0
    for _ in range(40):
        run.advance(1)
        exact += -0.3 * smooth(((run.step - 0.5) * run.dt - 3e-5) / 2e-4) * run.dt
        assert run.loads()[0, 1] == pytest.approx(exact, rel=1e-12, abs=1e-20)


def test_a_jump_is_there_from_the_first_half_step():
    mesh = rectangle(2, 2)
    run = Run(problem(mesh, velocity_loads=(hold("top", mesh.nodes_of("top"), 1, 1e-3),)))
    run.advance(1)
    assert run.loads()[0, 1] == pytest.approx(1e-3 * run.dt, rel=1e-12)


@pytest.mark.parametrize("axisymmetric", [False, True])
def test_pressure_all_around_gives_uniform_stress(axisymmetric):
    """The consistent load of a uniform pressure is in equilibrium with uniform stress."""
    mesh = rectangle(6, 6, 0.01, 0.01, jitter=0.25)
    sides = ("right", "top") if axisymmetric else ("left", "right", "bottom", "top")
    held = (("left", 0), ("bottom", 1)) if axisymmetric else ()
    run = Run(
        problem(
            mesh,
            axisymmetric=axisymmetric,
            velocity_loads=tuple(hold(s, mesh.nodes_of(s), c) for s, c in held),
            pressure_loads=tuple(
                PressureLoad(s, mesh.edge_sets[s], 1e3, 0.0, Ramp(0.0, 1e-4)) for s in sides
            ),
            damping=Damping(alpha=2e5, relative_to="ground"),
        )
    )
    run.advance(8000)
    stress = run.elements(np.arange(len(mesh.triangles))).stress
    np.testing.assert_allclose(stress[:, :2], -1e3, rtol=1e-6)
    np.testing.assert_allclose(stress[:, 3], 0.0, atol=1e-3)
    out_of_plane = -1e3 if axisymmetric else -2e3 * Elastic().poisson
    np.testing.assert_allclose(stress[:, 2], out_of_plane, rtol=1e-6)


def test_spring_adds_pressure_with_the_outward_displacement():
    mesh = rectangle(4, 4, 0.01, 0.01)
    spring = PressureLoad("right", mesh.edge_sets["right"], 2e5, 3e11, Ramp(0.0, 1e-5))
    run = Run(problem(mesh, pressure_loads=(spring,)))
    moved = np.full_like(mesh.nodes, 0.0)
    moved[:, 0] = 1e-6
    run.set_motion(moved, np.zeros_like(moved))
    run.advance(0)
    force, outward = run.loads()[0]
    assert outward == pytest.approx(1e-6, rel=1e-12)
    assert force == pytest.approx(3e11 * 1e-6 * 0.01, rel=1e-12)


def test_pressure_turns_with_its_face():
    """On a body turned by 90 degrees the pressure of the left face pushes upwards."""
    mesh = rectangle(4, 4, 0.01, 0.01)
    push = PressureLoad("left", mesh.edge_sets["left"], 1e6)
    run = Run(problem(mesh, pressure_loads=(push,)))
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    run.set_motion(mesh.nodes @ (quarter - np.eye(2)).T, np.zeros_like(mesh.nodes))
    run.advance(0)
    _, velocity, mass = run.nodes()
    momentum = (mass[:, None] * velocity).sum(axis=0)
    np.testing.assert_allclose(momentum, [0.0, 1e6 * 0.01 * 0.5 * run.dt], atol=1e-12)


def test_reactions_balance_the_pressure_at_rest():
    mesh = rectangle(4, 8, 0.01, 0.02)
    load = PressureLoad("top", mesh.edge_sets["top"], 1e6, 0.0, Ramp(0.0, 5e-5))
    run = Run(
        problem(
            mesh,
            velocity_loads=(hold("bottom", mesh.nodes_of("bottom"), 1),),
            pressure_loads=(load,),
            damping=Damping(alpha=2e5, relative_to="ground"),
        )
    )
    run.advance(6000)
    (reaction, _), (force, _) = run.loads()
    assert force == pytest.approx(1e6 * 0.01, rel=1e-6)
    assert reaction == pytest.approx(force, rel=1e-5)
