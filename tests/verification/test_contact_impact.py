"""Bodies that collide: restitution, both momenta, unlike bodies, speeds too high."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import UNIT, contact_problem, deepest_overlap, join, momentum, moved
from models import Elastic, hold, rectangle

from lithofrac.core import Run
from lithofrac.problem import Ramp

pytestmark = pytest.mark.verification


def bar_impact(n):
    """Two equal bars collide: restitution, contact time, momentum error, energy after / before."""
    bar, speed = rectangle(n, 2, 1.0, 2.0 / n), 1e-3
    mesh = join(left=bar, right=moved(bar, (1.01, 0.0)))
    run = Run(contact_problem(mesh, replace(UNIT, poisson=0.0), friction=0.3))
    velocity = np.zeros_like(mesh.nodes)
    velocity[:, 0] = np.where(np.arange(len(mesh.nodes)) < len(bar.nodes), speed, -speed)
    run.set_motion(0 * velocity, velocity)
    run.advance(0)
    before = run.energy()
    touching = []
    while run.step * run.dt < 9.0:
        run.advance(1)
        assert abs(run.energy().residual) < 1e-6
        if abs(run.contact_forces()).max() > 0:
            touching.append(run.step * run.dt)
    after = run.energy()
    linear, _, size, _ = momentum(run)
    _, v, mass = run.nodes()
    left = slice(0, len(bar.nodes))
    restitution = -(mass[left] @ v[left, 0]) / mass[left].sum() / speed
    gain = (after.kinetic + after.elastic) / (before.kinetic + before.elastic)
    return restitution, touching[-1] - touching[0], abs(linear).max() / size, gain


def test_bars_rebound_and_lose_only_what_their_surface_nodes_lose():
    """Linear momentum to 1e-13, no energy gained, order 1 to a restitution of 1, time 2 L/c."""
    results = np.array([bar_impact(n) for n in (10, 20, 40)])
    restitution, duration, drift, energy = results.T
    print(f"restitution {restitution}, duration {duration}, energy {energy}")
    assert drift.max() < 1e-13
    assert energy.max() <= 1.0
    orders = -np.diff(np.log(1 - restitution)) / np.log(2.0)
    assert orders.min() > 0.7
    assert abs(duration[-1] / 2.0 - 1) < 0.02


def three_tumbling_blocks(friction, factor):
    """Run after several oblique impacts, and momentum before it."""
    a = moved(rectangle(6, 6, jitter=0.25), (-0.5, -0.5))
    b = moved(moved(a, turn=0.4), (1.55, 0.45))
    c = moved(rectangle(5, 5, 0.7, 0.7, jitter=0.2, seed=7), (0.3, -1.5), turn=0.3)
    mesh = join(a=a, b=b, c=c)
    run = Run(contact_problem(mesh, friction=friction, time_step_factor=factor))
    body = np.zeros(len(mesh.nodes), int)
    body[mesh.triangles.ravel()] = np.repeat(mesh.body, 3)
    velocity = np.array([[0.02, 0.0], [-0.02, -0.01], [0.0, 0.03]])[body]
    arm = mesh.nodes - mesh.nodes[body == 1].mean(axis=0)
    velocity[body == 1] += 0.015 * np.column_stack([-arm[:, 1], arm[:, 0]])[body == 1]
    run.set_motion(0 * velocity, velocity)
    run.advance(0)
    start = momentum(run)
    run.advance(int(55.0 / run.dt))
    return run, start


@pytest.mark.parametrize("factor", [0.9, 0.3])
def test_frictionless_impacts_keep_both_momenta(factor):
    run, (linear, angular, size, arm_size) = three_tumbling_blocks(0.0, factor)
    assert run.contact_statistics().pairs_max > 0
    linear_now, angular_now, *_ = momentum(run)
    assert abs(linear_now - linear).max() / size < 1e-13
    assert abs(angular_now - angular) / arm_size < 1e-12


def test_bodies_that_come_from_afar_are_met():
    """They begin beyond the reach of the first list of candidates."""
    block = rectangle(4, 4)
    mesh = join(low=block, high=moved(block, (0.1, 2.0)))
    run = Run(contact_problem(mesh, friction=0.3))
    velocity = np.zeros_like(mesh.nodes)
    velocity[len(block.nodes) :, 1] = -0.02
    run.set_motion(0 * velocity, velocity)
    overlap, pushed = 0.0, 0
    while run.step * run.dt < 60.0:
        run.advance(10)
        overlap = max(overlap, deepest_overlap(run))
        pushed += run.contact_forces().any()
    assert run.contact_statistics().lists > 1
    assert overlap < 5e-4
    assert pushed > 0
    assert momentum(run)[0][1] == pytest.approx(-0.02, rel=1e-12)
    assert run.nodes()[1][: len(block.nodes), 1].mean() < -0.015, "it has been hit"


@pytest.mark.parametrize("shift", [-0.015, -0.004, 0.004, 0.015])
def test_nodes_that_nearly_face_each_other_turn_nothing(shift):
    """The reaction of a corner pair acts where the other node stands, not at its partner."""
    block = rectangle(4, 4)
    mesh = join(low=block, high=moved(block, (0.25 * (1 + shift), 1.01)))
    run = Run(contact_problem(mesh))
    velocity = np.zeros_like(mesh.nodes)
    velocity[len(block.nodes) :, 1] = -5e-3
    run.set_motion(0 * velocity, velocity)
    run.advance(0)
    _, angular, _, arm_size = momentum(run)
    run.advance(int(4.0 / run.dt))
    assert run.contact_statistics().pairs_max >= 3
    assert abs(momentum(run)[1] - angular) / arm_size < 1e-12


def test_friction_changes_angular_momentum_by_less_than_1e_6_and_less_with_the_step():
    """Friction acts at the start of a step, over the gap that the step closes."""
    drift = []
    for factor in (0.9, 0.45, 0.225):
        run, (_, angular, _, arm_size) = three_tumbling_blocks(0.5, factor)
        drift.append(abs(momentum(run)[1] - angular) / arm_size)
        assert run.energy().friction < -0.01 * run.energy().initial
    print(f"drift of angular momentum {drift}")
    assert drift[0] < 1e-6
    assert drift[0] > drift[1] > drift[2]


@pytest.mark.parametrize(
    ("young", "density"),
    [(1e6, 1.0), (1e-6, 1.0), *((1.0, ratio) for ratio in (1e2, 1e3, 1e4, 1e6, 1e-3, 1e-6))],
)
def test_unlike_bodies_are_kept_apart(young, density):
    """Ratios of stiffness and density up to 1e6 at a strain of 2e-3."""
    block, plate = rectangle(5, 3, 1.0, 0.6, jitter=0.2), rectangle(9, 2, 2.0, 0.3)
    mesh = join(block=moved(block, (0.4, 0.3)), plate=plate)
    bottom, top = mesh.nodes_of("plate.bottom"), mesh.nodes_of("block.top")
    materials = (Elastic(young=young, poisson=0.2, density=density), UNIT)
    duration = 4000 * Run(contact_problem(mesh, materials=materials)).dt
    press = hold("press", top, 1, -2e-3 / duration, ramp=Ramp(0.0, duration / 2))
    loads = (hold("x", bottom, 0), hold("y", bottom, 1), hold("top x", top, 0), press)
    run = Run(contact_problem(mesh, materials=materials, friction=0.3, velocity_loads=loads))
    run.advance(4000)
    energy, statistics = run.energy(), run.contact_statistics()
    print(statistics, energy.contact / energy.external)
    assert statistics.pairs_max > 5
    assert statistics.max_penetration_over_h < 1e-5
    assert abs(energy.contact) < 1e-2 * energy.external
    assert abs(energy.residual) < 1e-6
