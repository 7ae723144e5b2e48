"""Bodies without load: what they must keep, however long they fly, spin and ring."""

import numpy as np
import pytest
from contact_models import momentum
from models import Elastic, problem, rectangle

from lithofrac.core import Run
from lithofrac.problem import Damping

pytestmark = pytest.mark.verification
UNIT = Elastic(young=1.0, poisson=0.25, density=1.0)


def launched(mesh, velocity, damping):
    """A free elastic body of this velocity, after its first half step."""
    run = Run(problem(mesh, UNIT, damping=damping))
    run.set_motion(np.zeros_like(mesh.nodes), velocity)
    run.advance(0)
    return run


def drift(run, steps, parts=20):
    """Largest change of the mechanical energy in `steps` steps, over the energy."""
    energy = run.energy()
    start, worst = energy.kinetic + energy.elastic, 0.0
    for _ in range(parts):
        run.advance(steps // parts)
        energy = run.energy()
        worst = max(worst, abs(energy.kinetic + energy.elastic - start) / start)
    return worst


def test_a_body_that_flies_and_spins_ten_turns_keeps_its_energy(n_random):
    """Once the ringing is over that spin without stress sets off; damping leaves the spin alone."""
    mesh, spin = rectangle(3, 3, jitter=0.2), 2e-3  # rad/s, a thousandth of c at its corners
    arm = mesh.nodes - [0.5, 0.5]
    velocity = np.array([2e-3, -1e-3]) + spin * np.column_stack([-arm[:, 1], arm[:, 0]])
    run = launched(mesh, velocity, Damping(alpha=0.01))
    turn = round(2 * np.pi / spin / run.dt)
    run.advance(turn)
    worst = drift(run, n_random(10, least=1) * turn)
    mass = run.nodes()[2]
    x = mesh.nodes + run.nodes()[0]
    x -= mass @ x / mass.sum()
    before = mesh.nodes - mass @ mesh.nodes / mass.sum()
    angle = np.angle((x @ [1, 1j]) / (before @ [1, 1j]))
    print(
        f"{run.step} steps, energy drift {worst:.1e}, angle after eleven turns {angle.mean():.1e}"
    )
    assert worst < 1e-10
    assert abs(angle).max() < 0.1


def test_a_ringing_body_keeps_energy_and_momentum_for_a_million_steps(n_random):
    """So small a motion that the ledger of a linear body holds: its error is that of the strain."""
    mesh = rectangle(4, 4, jitter=0.2)
    velocity = 1e-10 * (np.random.default_rng(3).normal(size=mesh.nodes.shape) + [0.5, -0.3])
    run = launched(mesh, velocity, Damping())
    linear, _, size, _ = momentum(run)
    worst = drift(run, n_random(1_000_000, least=20_000))
    moved = abs(momentum(run)[0] - linear).max() / size
    print(f"{run.step} steps, energy drift {worst:.1e}, momentum {moved:.1e}")
    assert worst < 1e-9
    assert moved < 1e-12
