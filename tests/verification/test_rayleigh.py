"""The frequency that the damping finds by itself: alpha = 2 fraction omega (eqs 1-3)."""

import numpy as np
import pytest
from models import Elastic, hold, problem, rectangle

from lithofrac.core import Run
from lithofrac.problem import Damping

pytestmark = pytest.mark.verification
UNIT = Elastic(young=1.0, poisson=0.25, density=1.0)
OMEGA = np.pi * np.sqrt(2.0 * UNIT.modulus)  # of the mode below [1/s]
FRACTION = 0.02
HALF_PERIODS = 30


def vibrating(mesh, damping):
    """The P-wave mode u = grad(cos pi x cos pi y) of the unit square on rollers, let go."""
    sides = {"left": 0, "right": 0, "bottom": 1, "top": 1}
    rollers = tuple(hold(name, mesh.nodes_of(name), i) for name, i in sides.items())
    # Short steps: the quotient pairs displacements with the forces of one step before.
    model = problem(mesh, UNIT, velocity_loads=rollers, damping=damping, time_step_factor=0.1)
    run = Run(model)
    x, y = np.pi * mesh.nodes.T
    shape = -1e-7 * np.column_stack([np.sin(x) * np.cos(y), np.cos(x) * np.sin(y)])
    run.set_motion(shape, np.zeros_like(shape))
    return run


def decay(damping):
    """Decay rate of the mechanical energy [1/s] over whole half periods."""
    run = vibrating(rectangle(16, 16, jitter=0.15, seed=3), damping)
    run.advance(110)  # that of the lowest frequency of the body is over
    start = run.step
    first = run.energy()
    run.advance(round(HALF_PERIODS * np.pi / OMEGA / run.dt))
    last = run.energy()
    ratio = (last.kinetic + last.elastic) / (first.kinetic + first.elastic)
    return -np.log(ratio) / ((run.step - start) * run.dt)


def test_a_vibration_decays_with_twice_the_fraction_of_its_own_frequency():
    rate = decay(Damping(fraction=FRACTION, relative_to="ground"))
    print(f"\ndecay {rate:.5f}, 2 fraction omega {2 * FRACTION * OMEGA:.5f}")
    assert rate == pytest.approx(2 * FRACTION * OMEGA, rel=0.03)


def test_the_found_frequency_damps_as_the_same_alpha_given():
    given = decay(Damping(alpha=2 * FRACTION * OMEGA, relative_to="ground"))
    found = decay(Damping(fraction=FRACTION, relative_to="ground"))
    assert found == pytest.approx(given, rel=0.03)
