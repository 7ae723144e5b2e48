"""The ledger of fast motion: what the step itself gains as elements turn has its own entry."""

import numpy as np
import pytest
from contact_models import ROCK, UNIT, contact_problem, crushed_rubble, join, moved
from models import hold, problem, rectangle

from lithofrac.config.material import Material
from lithofrac.core import Run
from lithofrac.problem import Ramp

pytestmark = pytest.mark.verification


def jolted(factor, speed=0.05, material=UNIT, **changes):
    """A block whose upper half runs into its lower half; speed over that of waves, about."""
    mesh = rectangle(6, 8, 1.0, 1.4, jitter=0.25)
    run = Run(problem(mesh, material, time_step_factor=factor, **changes))
    velocity = np.zeros_like(mesh.nodes)
    velocity[mesh.nodes[:, 1] > 0.7, 1] = -speed
    velocity[:, 0] = 0.3 * speed * mesh.nodes[:, 1]
    run.set_motion(0.0 * velocity, velocity)
    run.advance(0)
    return run


def worst(run, time, every=5):
    """Largest residual and largest energy of turns over the energy of the start."""
    residual = turning = 0.0
    while run.step * run.dt < time:
        run.advance(every)
        energy = run.energy()
        residual = max(residual, abs(energy.residual))
        turning = max(turning, abs(energy.turning) / energy.initial)
    return residual, turning


def test_the_ledger_of_an_impact_closes_to_rounding():
    """Without the entry the residual would be that of the turns: 1e-5 here."""
    residual, turning = worst(jolted(0.9), 8.0)
    print(f"residual {residual:.1e}, turning {turning:.1e}")
    assert residual < 1e-13
    assert turning > 1e-6


def test_what_turns_gain_falls_with_the_square_of_the_step():
    gains = [worst(jolted(factor, 0.02), 3.0, 1)[1] for factor in (0.4, 0.2, 0.1)]
    orders = -np.diff(np.log(gains)) / np.log(2.0)
    print(f"gains {gains}, orders {orders}")
    assert orders.min() > 1.8


def test_rock_that_yields_in_an_impact_closes_as_well():
    """Stress and strain have other axes then, and the terms of the skew part do not vanish."""
    rock = Material.load("sandstone")
    mesh = rectangle(8, 12, 8e-3, 12e-3, jitter=0.2)
    bottom, top = mesh.nodes_of("bottom"), mesh.nodes_of("top")
    loads = (hold("low", bottom, 1), hold("push", top, 1, -60.0, ramp=Ramp(0.0, 1e-6)))
    run = Run(problem(mesh, rock, velocity_loads=loads))
    run.advance(0)
    while run.step * run.dt < 1e-5:
        run.advance(5)
        # what came before the motion was fast is left
        assert abs(run.energy().residual) < 1e-7
    energy = run.energy()
    assert energy.compressive > 0.1 * energy.external
    assert abs(energy.turning) > 1e-7 * energy.external


def test_axisymmetric_impact_closes():
    residual, turning = worst(jolted(0.9, axisymmetric=True), 4.0)
    assert residual < 1e-12
    assert turning > 1e-7


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_the_ledger_of_rubble_closes(friction):
    run = crushed_rubble(0.9, friction, speed=5.0, jitter=0.2)
    while run.step * run.dt < 1e-4:
        run.advance(50)
        assert abs(run.energy().residual) < 1e-9
    assert abs(run.energy().turning) > 1e-8 * run.energy().external


def test_slow_motion_pays_nothing_for_it():
    run = jolted(0.9, speed=1e-5)
    run.advance(101)  # the first steps are booked in any case
    booked = run.energy().turning
    run.advance(400)
    assert run.energy().turning == booked
    assert abs(run.energy().residual) < 1e-8


@pytest.mark.restart
def test_the_entry_is_resumed_to_the_bit():
    bar = rectangle(4, 4)
    mesh = join(a=bar, b=moved(bar, (1.15, 0.3), turn=0.1))
    velocity = np.zeros_like(mesh.nodes)
    velocity[: len(bar.nodes), 0] = 0.02

    def begun():
        run = Run(contact_problem(mesh, ROCK, 0.3))
        run.set_motion(0.0 * velocity, velocity * 3e3)
        run.advance(150)
        return run

    first, second = begun(), Run(contact_problem(mesh, ROCK, 0.3))
    second.restore(first.save())
    first.advance(150)
    second.advance(150)
    assert first.energy() == second.energy()
    assert first.energy().turning != 0.0
