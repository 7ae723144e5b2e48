"""Single triangles and tips: nobody enters another, however they stand."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import (
    ROCK,
    contact_problem,
    crushed_rubble,
    cut_all_edges,
    deepest_overlap,
    uniform_strain,
)
from models import hold, rectangle

from lithofrac.core import CoreError, Run
from lithofrac.kernels import contact_candidates
from lithofrac.problem import Damping, Ramp

pytestmark = pytest.mark.verification


@pytest.mark.parametrize("factor", [0.90, 0.99, 1.00])
def test_contact_leaves_the_step_of_the_free_elements(factor):
    """With every edge cut the mesh has exactly the limit of its elements."""
    run = crushed_rubble(factor, speed=5.0)
    while run.step * run.dt < 1e-4:
        run.advance(50)
        energy = run.energy()
        assert energy.kinetic + energy.elastic <= 1.001 * energy.external
        assert abs(energy.residual) < 5e-5
    statistics = run.contact_statistics()
    print(statistics)
    assert statistics.pairs_max > 500
    assert statistics.max_penetration_over_h < 5e-4


def test_above_the_element_step_the_rubble_blows_up():
    run = crushed_rubble(1.05, speed=5.0)
    with pytest.raises(CoreError, match=r"contact:|not finite"):
        run.advance(int(1e-4 / run.dt))
    assert run.energy().elastic > 2 * run.energy().external


@pytest.mark.parametrize("friction", [0.0, 0.5, 1.2])
def test_no_part_of_the_rubble_enters_another(friction):
    """All nodes against all elements at the end; contact takes energy and never gives any."""
    run = crushed_rubble(0.9, friction, speed=5.0, jitter=0.25, n=8)
    while run.step * run.dt < 1e-4:
        run.advance(100)
    energy, statistics = run.energy(), run.contact_statistics()
    work = energy.contact / energy.external
    print(f"overlap {deepest_overlap(run):.1e} h, contact work {work:.1e}, {statistics}")
    assert deepest_overlap(run) < 5e-4
    assert -0.2 < work < 1e-3
    assert energy.friction <= 1e-12 * energy.external
    assert abs(energy.residual) < 1e-5


def test_rubble_that_is_left_alone_does_not_jam():
    """Impulses that only hold each other stay within reach of those that the nodes feel.

    Without fading first guesses the largest pair comes to 45 times the largest force of a node
    here.
    """
    size, n, strain = 0.02, 5, 1e-3
    mesh = cut_all_edges(rectangle(n, n, size, size, jitter=0.25, seed=1))
    x, y = mesh.nodes.T
    is_edge = (np.minimum(x, y) < 1e-9) | (np.maximum(x, y) > size - 1e-9)
    loads = (hold("x", np.flatnonzero(is_edge), 0), hold("y", np.flatnonzero(is_edge), 1))
    run = Run(contact_problem(mesh, ROCK, 1.2, velocity_loads=loads, time_step_factor=0.9))
    velocity = np.zeros_like(mesh.nodes)
    velocity[~is_edge] = 3.0 * np.random.default_rng(0).standard_normal((sum(~is_edge), 2))
    start = uniform_strain(mesh, -0.3 * strain, -strain)
    run.set_motion(start, velocity)
    run.advance(4000)
    assert run.contact_statistics().lists == 1
    candidates = sum(map(len, contact_candidates(mesh, start)))
    impulses = run.save()[-2 * candidates :].reshape(-1, 2)  # a checkpoint ends with them
    worst = np.hypot(*impulses.T).max() / run.dt / abs(run.contact_forces()).max()
    energy = run.energy()
    print(f"largest pair over largest node {worst:.1f}, {energy}")
    assert 0.5 < worst < 20.0
    assert energy.friction < 0.0
    assert abs(energy.contact) < 0.5 * abs(energy.friction)
    assert energy.friction > -0.2 * energy.initial


def test_wedges_between_a_wall_and_their_neighbours_do_not_jam():
    """A corner that a wall leads presses on an edge close to a node of the wall: what the wall
    cannot yield is asked of nobody else.

    With a compliance floored at 1e-9 pairs came to 1e5 times the forces of the rest, and the run
    failed at once.
    """
    size, n, strain = 6e-3, 6, 2e-3
    mesh = cut_all_edges(rectangle(n, n, size, size, jitter=0.1, seed=2))
    x, y = mesh.nodes.T
    sides = np.flatnonzero((x < 1e-9) | (x > size - 1e-9))
    low, top = np.flatnonzero(y < 1e-9), np.flatnonzero(y > size - 1e-9)
    loads = (hold("sides", sides, 0), hold("low", low, 1))
    loads += (hold("lid", top, 1, -0.1, ramp=Ramp(0.0, 3e-5)),)
    run = Run(contact_problem(mesh, ROCK, 1.2, velocity_loads=loads))
    start = uniform_strain(mesh, -strain, -strain)
    run.set_motion(start, 0.0 * start)
    run.advance(1)
    first = abs(run.contact_forces()).max()
    largest = 0.0
    for _ in range(60):
        run.advance(20)
        largest = max(largest, abs(run.contact_forces()).max())
    energy = run.energy()
    print(f"largest force {largest / first:.1f} of the first, {energy}")
    assert largest < 30.0 * first
    assert energy.friction < 0.0
    assert abs(energy.contact) < 1e-2 * energy.initial


def test_six_copies_of_a_node_part_without_an_impulse():
    """Wedges round one point that fly apart feel nothing, though they touch at the start."""
    angles = np.arange(6) * np.pi / 3
    corners = np.column_stack([np.cos(angles), np.sin(angles)])
    hexagon = np.concatenate([[[0.0, 0.0]], corners])
    triangles = np.array([[0, i + 1, (i + 1) % 6 + 1] for i in range(6)], np.int32)
    base = rectangle(1, 1)
    mesh = cut_all_edges(replace(base, nodes=hexagon, triangles=triangles, body=np.zeros(6, int)))
    run = Run(contact_problem(mesh, friction=0.5))
    outward = np.repeat(mesh.centroids(), 3, axis=0)
    run.set_motion(0 * outward, 1e-3 * outward)
    run.advance(50)
    assert not run.contact_forces().any()
    run = Run(contact_problem(mesh, friction=0.5))
    run.set_motion(0 * outward, -1e-3 * outward)  # and inward they cannot go
    run.advance(200)
    assert run.contact_forces().any() or run.contact_statistics().sweeps > 0
    energy = run.energy()
    assert energy.kinetic + energy.elastic <= energy.initial
    assert run.contact_statistics().max_penetration_over_h < 1e-5


@pytest.mark.parametrize(
    ("width", "dip"),
    # the notch of depth 0.3 opens by 2.56 rad: the widest tip does not fit into it
    [(0.5, 0.0), (1.5, 0.0), (2.5, 0.0), (2.9, 0.0), (0.5, 0.3), (1.5, 0.3), (2.5, 0.3)],
)
@pytest.mark.parametrize("shift", [0.0, 1e-9, 1e-3, 0.03])
def test_a_tip_that_falls_on_a_node_is_caught(width, shift, dip):
    """A tip of any width on the middle node of a flat face or of a notch, exactly or nearly."""
    half = np.tan(width / 2)
    base = [[-1.0, dip], [0, 0], [1, dip], [0, -1]]
    gap = 0.05 + 0.2 * dip
    tip = [[shift, gap], [shift + half, 1 + gap], [shift - half, 1 + gap]]
    mesh = replace(
        rectangle(1, 1),
        nodes=np.array(base + tip),
        triangles=np.array([[0, 3, 1], [3, 2, 1], [4, 5, 6]], np.int32),
        body=np.array([0, 0, 1], np.int32),
        body_names=("base", "tip"),
    )
    loads = (hold("x", range(4), 0), hold("y", range(4), 1))
    run = Run(contact_problem(mesh, friction=0.3, velocity_loads=loads))
    velocity = np.zeros_like(mesh.nodes)
    velocity[4:, 1] = -5e-3
    run.set_motion(0 * velocity, velocity)
    run.advance(0)
    x, lowest = mesh.nodes, 1.0
    while run.step * run.dt < 30.0:
        run.advance(1)
        at = (x + run.nodes()[0])[4]
        lowest = min(lowest, at[1] - dip * abs(at[0]))
        assert deepest_overlap(run) < 1e-5
    assert lowest > -1e-5
    assert lowest < 0.01
    assert run.energy().contact < 0.0


def test_a_flat_face_that_bends_becomes_a_corner_between_two_lists():
    """The middle of a face sinks under a tip, which then must climb the slope beside it."""
    nodes = np.array([[-1.0, 0], [0, 0], [1, 0], [0, -1], [0, 0], [1, 0.1], [0, 1], [-1, 0.1]])
    triangles = np.array([[0, 3, 1], [3, 2, 1], [4, 5, 6], [4, 6, 7]], np.int32)
    mesh = replace(
        rectangle(1, 1),
        nodes=nodes,
        triangles=triangles,
        body=np.array([0, 0, 1, 1], np.int32),
        body_names=("base", "tip"),
    )
    sinking, duration = 1e-3, 55.0
    drag = Ramp(0.6 * duration, 0.1 * duration)
    loads = (hold("base x", range(4), 0), hold("base y", [0, 2, 3], 1))
    loads += (hold("sink", [1, 6], 1, -sinking), hold("drag", [5, 6, 7], 0, 8e-4, ramp=drag))
    damping = Damping(alpha=0.3, relative_to="ground")
    run = Run(contact_problem(mesh, velocity_loads=loads, damping=damping))
    run.advance(int(duration / run.dt))
    assert run.contact_statistics().lists == 1
    u = run.nodes()[0]
    along, rise, slope = u[4, 0], u[4, 1] - u[1, 1], -u[1, 1]
    assert 0.01 < along < 0.02
    assert rise > 0.95 * slope * along
