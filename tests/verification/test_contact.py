"""Contact and friction: exact answers, conservation, the energy ledger, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import cut_all_edges, join, moved, split
from models import Elastic, hold, problem, rectangle

from lithofrac.core import CoreError, Run
from lithofrac.kernels import boundary_of
from lithofrac.problem import Contact, Damping, PressureLoad, Ramp

pytestmark = pytest.mark.verification
UNIT = Elastic(young=1.0, poisson=0.2, density=1.0)
ROCK = Elastic(young=70e9, poisson=0.2, density=2700.0)


def contact_problem(mesh, material=UNIT, friction=0.0, **changes):
    """Bodies of one material with one friction coefficient."""
    given = {
        "materials": (material,) * len(mesh.body_names),
        "contact": Contact(default_friction=friction),
    }
    return problem(mesh, **(given | changes))


def uniform_strain(mesh, xx, yy):
    """Displacement of a uniform strain."""
    return mesh.nodes * np.array([xx, yy])


def momentum(run):
    """Linear momentum, angular momentum, and the sums of their sizes."""
    displacement, velocity, mass = run.nodes()
    x = run.problem.mesh.nodes + displacement
    spin = mass * (x[:, 0] * velocity[:, 1] - x[:, 1] * velocity[:, 0])
    size = mass * np.hypot(*velocity.T)
    linear = (mass[:, None] * velocity).sum(axis=0)
    return linear, spin.sum(), size.sum(), (size * np.hypot(*x.T)).sum()


# --- impact -------------------------------------------------------------------------------------


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
        assert run.energy().residual < 1e-6
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


# --- patch --------------------------------------------------------------------------------------


def pressed_blocks(below, above, strain=1e-3):
    """Stress error of two blocks under uniaxial stress, over that stress, (n, 3) xx, yy, xy."""
    material = Elastic(young=1.0, poisson=0.25, density=1.0)
    low = rectangle(below, 4, 1.0, 0.5, jitter=0.2, seed=1)
    high = moved(rectangle(above, 4, 1.0, 0.5, jitter=0.2, seed=2), (0.0, 0.5))
    mesh = join(low=low, high=high)
    held = (("low.bottom", 1), ("high.top", 1), ("low.left", 0), ("high.left", 0))
    loads = tuple(hold(name, mesh.nodes_of(name), axis) for name, axis in held)
    damping = Damping(alpha=0.5, relative_to="ground")
    run = Run(contact_problem(mesh, material, velocity_loads=loads, damping=damping))
    c = (1 + material.poisson) * strain
    u = uniform_strain(mesh, c * material.poisson, -c * (1 - material.poisson))
    run.set_motion(u, 0 * u)
    run.advance(0)
    run.advance(int(100.0 / run.dt))
    assert abs(run.energy().residual) < 1e-6
    stress = run.elements(np.arange(len(mesh.triangles))).stress
    return (stress[:, [0, 1, 3]] - [0.0, -strain, 0.0]) / strain


def test_patch_of_matching_meshes_is_exact():
    assert abs(pressed_blocks(8, 8)).max() < 1e-10


@pytest.mark.parametrize(("below", "above"), [(8, 12), (8, 5), (16, 5)])
def test_patch_of_non_matching_meshes_is_within_one_percent(below, above):
    error = pressed_blocks(below, above)
    print(f"{below}/{above}: max {abs(error).max():.2e}, rms {np.sqrt((error**2).mean()):.2e}")
    assert abs(error).max() < 0.01
    assert np.sqrt((error**2).mean()) < 0.003


def test_patch_of_stacked_cylinders_is_exact():
    """Axisymmetry: matching discs under uniaxial stress, masses and impulses per radian."""
    material = Elastic(young=1.0, poisson=0.0, density=1.0)
    disc = rectangle(6, 3, 1.0, 0.5, jitter=0.2)
    mesh = join(low=disc, high=moved(disc, (0.0, 0.5)))
    held = (("low.bottom", 1), ("high.top", 1), ("low.left", 0), ("high.left", 0))
    loads = tuple(hold(name, mesh.nodes_of(name), axis) for name, axis in held)
    run = Run(contact_problem(mesh, material, axisymmetric=True, velocity_loads=loads))
    u = uniform_strain(mesh, 0.0, -1e-3)
    run.set_motion(u, 0 * u)
    run.advance(2000)
    stress = run.elements(np.arange(len(mesh.triangles))).stress
    assert abs(stress - [0.0, -1e-3, 0.0, 0.0]).max() < 1e-10 * 1e-3


# --- friction -----------------------------------------------------------------------------------


def sliding_block(friction, speed=2e-3, columns=(6, 9), end=100.0):
    """A flat block pressed on a base and pulled along it; yields the run at each record."""
    block = moved(rectangle(columns[0], 1, 2.0, 0.25), (0.5, 0.3))
    base = rectangle(columns[1], 2, 3.5, 0.3)
    mesh = join(block=block, base=base)
    bottom = mesh.nodes_of("base.bottom")
    run = Run(
        contact_problem(
            mesh,
            contact=Contact({("base", "block"): friction}),
            velocity_loads=(
                hold("base x", bottom, 0),
                hold("base y", bottom, 1),
                hold("pull", mesh.nodes_of("block.top"), 0, speed, ramp=Ramp(20.0, 20.0)),
            ),
            pressure_loads=(
                PressureLoad("press", mesh.edge_sets["block.top"], 1e-4, ramp=Ramp(0.0, 20.0)),
            ),
            # steady sliding of elastic bodies flutters by itself at high friction
            damping=Damping(alpha=3.0, relative_to="ground"),
        )
    )
    while run.step * run.dt < end:
        run.advance(20)
        yield run


def shear_over_pressure(run, body=0):
    """Shear and normal force on the first body, and their ratio."""
    nodes = np.unique(run.problem.mesh.triangles[run.problem.mesh.body == body])
    force = run.contact_forces()[nodes].sum(axis=0)
    return -force[0] / force[1]


@pytest.mark.parametrize("friction", [0.0, 0.3, 0.577, 1.2])
def test_sliding_friction_is_the_coefficient(friction):
    ratios = [shear_over_pressure(run) for run in sliding_block(friction) if run.step * run.dt > 60]
    ratios = np.array(ratios)
    print(f"mu {friction}: T/N {ratios.min():.5f} to {ratios.max():.5f}")
    if friction > 0.0:
        assert abs(ratios / friction - 1).max() < 2e-3
    else:
        assert abs(ratios).max() < 1e-3


def test_the_ledger_closes_while_a_contact_slides():
    for run in sliding_block(0.3):
        energy = run.energy()
        assert abs(energy.residual) < 1e-6
    assert energy.friction < -0.05 * energy.external
    assert abs(energy.contact) < 1e-4 * energy.external


def test_high_friction_does_not_slip():
    """Matching nodes stay together to 1e-6 of the shear displacement."""
    block = moved(rectangle(8, 2, 2.0, 0.25), (0.5, 0.25))
    base = moved(rectangle(8, 2, 2.0, 0.25), (0.5, 0.0))
    mesh = join(block=block, base=base)
    bottom, top = mesh.nodes_of("base.bottom"), mesh.nodes_of("block.top")
    loads = (hold("x", bottom, 0), hold("y", bottom, 1))
    loads += (hold("pull", top, 0, 1e-5, ramp=Ramp(20.0, 20.0)), hold("press", top, 1, -1e-5))
    run = Run(contact_problem(mesh, friction=10.0, velocity_loads=loads))
    run.advance(int(60.0 / run.dt))
    assert 0.05 < abs(shear_over_pressure(run)) < 5.0
    u = run.nodes()[0]
    upper = mesh.nodes_of("block.bottom")
    lower = mesh.nodes_of("base.top")
    np.testing.assert_allclose(mesh.nodes[upper], mesh.nodes[lower])
    assert abs(u[upper, 0] - u[lower, 0]).max() < 1e-6 * u[top, 0].mean()


def test_nafems_wedge_needs_the_exact_force():
    """CGS-4: F/G = (tan a + mu)/(1 - mu tan a) = 0.412371 at tan a = 0.1, mu = 0.3."""
    slope, friction = 0.1, 0.3
    low, up = rectangle(16, 3, 8.0, 1.0), rectangle(8, 3, 4.0, 1.0)
    x, y = low.nodes.T
    low = replace(low, nodes=np.column_stack([x, y * (1 + slope * x)]))
    x, y = up.nodes.T + np.array([[1.0], [0.0]])
    up = replace(up, nodes=np.column_stack([x, 3.0 * y + (1 + slope * x) * (1 - y)]))
    mesh = join(up=up, low=low)
    bottom = mesh.nodes_of("low.bottom")
    run = Run(
        contact_problem(
            mesh,
            friction=friction,
            velocity_loads=(
                hold("x", bottom, 0),
                hold("y", bottom, 1),
                hold("push", mesh.nodes_of("up.left"), 0, 1e-3, ramp=Ramp(30.0, 30.0)),
            ),
            pressure_loads=(
                PressureLoad("G", mesh.edge_sets["up.top"], 1e-4, ramp=Ramp(0.0, 20.0)),
            ),
            damping=Damping(alpha=0.1, relative_to="ground"),
        )
    )
    exact = (slope + friction) / (1 - friction * slope)
    assert exact == pytest.approx(0.412371, abs=1e-6)
    ratios = []
    while run.step * run.dt < 180.0:
        run.advance(20)
        if run.step * run.dt > 130.0:
            ratios.append(shear_over_pressure(run))
    print(f"F/G {min(ratios):.6f} to {max(ratios):.6f}")
    assert abs(np.array(ratios) / exact - 1).max() < 1e-3


def test_friction_is_looked_up_by_surface():
    """A named edge set has its own friction; everything else the default."""
    block = moved(rectangle(6, 1, 2.0, 0.25), (0.5, 0.3))
    mesh = join(block=block, base=rectangle(9, 2, 3.5, 0.3))
    contact = Contact({("block.bottom", "base"): 0.4}, default_friction=0.1)
    assert contact.surfaces(mesh) == ["block", "base", "block.bottom"]
    np.testing.assert_allclose(
        contact.table(mesh), [[0.1, 0.1, 0.1], [0.1, 0.1, 0.4], [0.1, 0.4, 0.1]]
    )
    bottom, top = mesh.nodes_of("base.bottom"), mesh.nodes_of("block.top")
    loads = (hold("x", bottom, 0), hold("y", bottom, 1))
    loads += (hold("press", top, 1, -1e-4, ramp=Ramp(0.0, 5.0)),)
    loads += (hold("pull", top, 0, 5e-3, ramp=Ramp(5.0, 20.0)),)
    run = Run(contact_problem(mesh, contact=contact, velocity_loads=loads))
    run.advance(int(60.0 / run.dt))
    assert abs(shear_over_pressure(run)) == pytest.approx(0.4, rel=5e-3)


# --- cracks -------------------------------------------------------------------------------------


def cracked_block(friction, factor, n=16, size=0.02):
    """A jagged crack through a block that is held in biaxial compression, just split."""
    mesh = rectangle(n, n, size, size, jitter=0.25, seed=3)
    x, y = mesh.centroids().T / size - 0.5
    mesh = split(mesh, (y > 0.35 * x + 0.12 * np.sin(9 * x)).astype(int))
    x, y = mesh.nodes.T
    edge = np.flatnonzero((np.minimum(x, y) < 1e-9) | (np.maximum(x, y) > size - 1e-9))
    loads = (hold("x", edge, 0), hold("y", edge, 1))
    run = Run(
        contact_problem(
            mesh, ROCK, friction=friction, velocity_loads=loads, time_step_factor=factor
        )
    )
    c = (1 + ROCK.poisson) / ROCK.young
    xx, yy = -30e6, -100e6
    nu = ROCK.poisson
    u = uniform_strain(mesh, c * ((1 - nu) * xx - nu * yy), c * ((1 - nu) * yy - nu * xx))
    run.set_motion(u, 0 * u)
    run.advance(0)
    return run


@pytest.mark.parametrize("factor", [0.3, 0.95, 1.0])
def test_a_crack_that_sticks_does_not_move(factor):
    run = cracked_block(1.2, factor)
    elements = np.arange(len(run.problem.mesh.triangles))
    stress, energy = run.elements(elements).stress, run.energy()
    kinetic = 0.0
    for _ in range(20):
        run.advance(100)
        kinetic = max(kinetic, run.energy().kinetic)
    change = abs(run.elements(elements).stress - stress).max() / abs(stress).max()
    print(f"kinetic {kinetic / energy.elastic:.1e}, stress change {change:.1e}")
    assert kinetic < 1e-18 * energy.elastic
    assert change < 1e-9
    assert run.contact_statistics().sweeps_mean < 1.1
    assert run.contact_statistics().unconverged_steps == 0


@pytest.mark.slow
def test_a_held_crack_does_not_creep_in_a_million_steps():
    """Residual below 1e-8, and slip that does not go on."""
    run = cracked_block(0.58, 0.95, n=6)
    run.advance(1000)
    held = run.nodes()[0]
    run.advance(999_000)
    scale = abs(held).max()
    drift = abs(run.nodes()[0] - held).max() / scale
    print(f"residual {run.energy().residual:.1e}, drift {drift:.1e} of the displacement")
    assert abs(run.energy().residual) < 1e-8
    assert drift < 1e-9


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_slip_of_a_crack_does_not_depend_on_the_step(friction):
    """Largest kinetic energy and work of friction within 5 % from 0.1 to 0.95 of the step."""
    results = []
    for factor in (0.1, 0.95):
        run = cracked_block(friction, factor)
        initial, kinetic = run.energy().elastic, 0.0
        while run.step * run.dt < 8e-6:
            run.advance(1)
            energy = run.energy()
            kinetic = max(kinetic, energy.kinetic)
            assert abs(energy.residual) < 1e-8
        assert run.contact_statistics().sweeps_mean < 2.5
        copies = len(run.problem.mesh.nodes) - 17 * 17
        assert run.contact_statistics().pairs_max <= copies, "one pair a node is enough"
        results.append([kinetic, -energy.friction, energy.elastic])
        assert run.contact_statistics().max_penetration_over_h < 1e-6
        assert energy.contact <= 1e-12 * initial
    results = np.array(results) / initial
    print(f"kinetic, friction, elastic over initial: {results.tolist()}")
    assert results[1, 0] == pytest.approx(results[0, 0], rel=0.05)
    assert results[1, 1] == pytest.approx(results[0, 1], rel=0.05)
    assert results[1, 2] == pytest.approx(results[0, 2], rel=0.05)
    if friction > 0.0:
        assert results[1, 1] > 1e-4


def crushed_rubble(factor, friction=0.5, speed=1.0, jitter=0.0, n=6, size=0.02):
    """A block of single triangles, each with its own nodes, between two rigid plates."""
    plate = rectangle(3, 1, 1.4 * size, 0.2 * size)
    mesh = join(
        rock=cut_all_edges(rectangle(n, n, size, size, jitter=jitter)),
        bottom=moved(plate, (-0.2 * size, -0.2 * size)),
        top=moved(plate, (-0.2 * size, size)),
    )
    low, high = (np.unique(mesh.triangles[mesh.body == body]) for body in (1, 2))
    loads = (hold("low x", low, 0), hold("low y", low, 1), hold("high x", high, 0))
    loads += (hold("push", high, 1, -speed, ramp=Ramp(0.0, 5e-6)),)
    run = Run(
        contact_problem(
            mesh, ROCK, friction=friction, velocity_loads=loads, time_step_factor=factor
        )
    )
    assert run.critical_step[1] < 2 * n * n, "the rock must set the step"
    return run


@pytest.mark.parametrize("factor", [0.90, 0.99])
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


def deepest_overlap(run):
    """Deepest node inside an element of another part, over the shortest edge, by brute force."""
    mesh = run.problem.mesh
    x = mesh.nodes + run.nodes()[0]
    deepest = 0.0
    for triangle in mesh.triangles:
        corner = x[triangle]
        inside = ((x > corner.min(axis=0)) & (x < corner.max(axis=0))).all(axis=1)
        inside[triangle] = False
        along = np.roll(corner, -1, axis=0) - corner
        along /= np.hypot(*along.T)[:, None]
        arm = x[inside][:, None] - corner
        left_of = along[:, 0] * arm[..., 1] - along[:, 1] * arm[..., 0]
        deepest = max(deepest, left_of.min(axis=1).max(initial=0.0))
    return deepest / boundary_of(mesh)[1]


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


def test_a_crack_tip_inside_a_body_holds():
    """Both faces of an inner crack under compression: nothing moves, the tips stay one node."""
    size = 0.02
    mesh = rectangle(12, 12, size, size)
    x, y = mesh.nodes.T
    inner = np.flatnonzero((abs(y - size / 2) < 1e-9) & (abs(x - size / 2) < 0.3 * size))
    above = (mesh.centroids()[:, 1] > size / 2).astype(int)
    copy = np.arange(len(mesh.nodes))
    copy[inner] = len(mesh.nodes) + np.arange(len(inner))
    triangles = mesh.triangles.copy()
    triangles[above == 1] = copy[triangles[above == 1]]
    nodes = np.concatenate([mesh.nodes, mesh.nodes[inner]])
    mesh = replace(mesh, nodes=nodes, triangles=triangles, edge_sets={})
    x, y = mesh.nodes.T
    edge = np.flatnonzero((np.minimum(x, y) < 1e-9) | (np.maximum(x, y) > size - 1e-9))
    loads = (hold("x", edge, 0), hold("y", edge, 1))
    run = Run(contact_problem(mesh, ROCK, velocity_loads=loads, time_step_factor=0.95))
    u = uniform_strain(mesh, 0.0, -1e-3)
    run.set_motion(u, 0 * u)
    run.advance(0)
    elastic = run.energy().elastic
    run.advance(2000)
    assert run.energy().kinetic < 1e-18 * elastic
    assert run.contact_statistics().pairs_max == len(inner)


# --- curved bodies ------------------------------------------------------------------------------


def hertz(n, half_width=0.05, radius=1.0):
    """Half-width and peak pressure over Hertz's for 2n elements across six half-widths each way.

    A body with the profile x^2/(2R) is pressed on a flat one of the same material: a = sqrt(4 F
    R/(pi E*)), p = sqrt(F E*/(pi R)) with E* = E/(2 (1 - nu^2)) and F the contact force.
    """
    material = Elastic(young=1.0, poisson=0.25, density=1.0)
    extent = 6 * half_width

    def graded(columns):
        mesh = rectangle(columns, n, 2.0, 1.0)
        s = mesh.nodes - [1.0, 0.0]
        return replace(mesh, nodes=extent * (0.25 * s + 0.75 * s**3))

    up, low = graded(2 * n), graded(2 * n + 2)
    x, y = up.nodes.T
    up = replace(up, nodes=np.column_stack([x, y + x**2 / (2 * radius) * (1 - y / extent)]))
    mesh = join(up=up, low=replace(low, nodes=-low.nodes))
    stiffness = 1 / (2 * (1 - material.poisson**2))
    force = np.pi * half_width**2 * stiffness / (4 * radius)
    top, bottom = mesh.nodes_of("up.top"), mesh.nodes_of("low.top")
    run = Run(
        contact_problem(
            mesh,
            material,
            velocity_loads=(
                hold("bottom", bottom, 1),
                hold("low x", bottom[[n]], 0),
                hold("up x", top[[n]], 0),
            ),
            pressure_loads=(
                PressureLoad(
                    "press", mesh.edge_sets["up.top"], force / (2 * extent), ramp=Ramp(0.0, 4.0)
                ),
            ),
            damping=Damping(alpha=1.0, relative_to="ground"),
        )
    )
    run.advance(int(14.0 / run.dt))
    nodes = mesh.nodes_of("up.bottom")
    nodes = nodes[np.argsort(mesh.nodes[nodes, 0])]
    at = (mesh.nodes + run.nodes()[0])[nodes, 0]
    on_node = run.contact_forces()[nodes, 1]
    force, pressure = on_node.sum(), on_node / np.gradient(at)
    peak = np.sqrt(force * stiffness / (np.pi * radius))
    width = np.sqrt(4 * force * radius / (np.pi * stiffness))
    loaded = np.flatnonzero(pressure > 1e-3 * peak)
    spacing = np.diff(at[loaded[0] - 1 : loaded[-1] + 2]).max()
    half = 0.5 * (at[loaded[-1]] - at[loaded[0]])
    return half / width, spacing / width, pressure.max() / peak


@pytest.mark.slow
def test_hertz_pressure_between_curved_bodies():
    results = np.array([hertz(n) for n in (12, 24, 48)])
    print(f"a/a0 {results[:, 0]}, spacing {results[:, 1]}, p/p0 {results[:, 2]}")
    assert (abs(results[:, 0] - 1) <= results[:, 1]).all()
    assert abs(results[-1, 2] - 1) < 0.03


# --- invariance, determinism, restart -----------------------------------------------------------


def moving_scene(shift=0.0, **changes):
    """Non-matching blocks that hit, slide and stick on a driven plate."""
    block = moved(rectangle(5, 5, jitter=0.2), (0.3 + shift, 0.31 + shift))
    plate = moved(rectangle(11, 2, 2.0, 0.3), (shift, shift))
    mesh = join(block=block, plate=plate)
    bottom = mesh.nodes_of("plate.bottom")
    loads = (hold("x", bottom, 0, 0.01, ramp=Ramp(0.0, 5.0)), hold("y", bottom, 1))
    return Run(
        contact_problem(
            mesh,
            friction=0.4,
            velocity_loads=loads,
            pressure_loads=(PressureLoad("p", mesh.edge_sets["block.top"], 2e-3),),
            **({"damping": Damping(fraction=0.1)} | changes),
        )
    )


def state_bits(run):
    return run.save().tobytes()


def test_the_bits_do_not_depend_on_the_number_of_threads():
    runs = [moving_scene() for _ in range(3)]
    for threads, run in enumerate(runs, start=1):
        run.advance(400, threads)
    assert runs[0].contact_statistics().pairs_max > 5
    assert state_bits(runs[0]) == state_bits(runs[1]) == state_bits(runs[2])


def test_the_bits_do_not_depend_on_how_steps_are_bundled():
    one, other = moving_scene(), moving_scene()
    one.advance(300)
    for _ in range(100):
        other.advance(3)
    assert state_bits(one) == state_bits(other)


@pytest.mark.restart
@pytest.mark.parametrize("stop", [0, 30, 217])
def test_a_restart_in_contact_is_bitwise(stop):
    unbroken, first, second = moving_scene(), moving_scene(), moving_scene()
    unbroken.advance(400)
    first.advance(stop)
    second.restore(first.save())
    second.advance(400 - stop)
    assert state_bits(second) == state_bits(unbroken)
    assert second.contact_statistics() == unbroken.contact_statistics()
    assert second.energy() == unbroken.energy()


@pytest.mark.restart
def test_a_checkpoint_of_another_model_is_refused():
    with pytest.raises(CoreError, match="another model"):
        moving_scene().restore(crushed_rubble(0.9).save())


def test_far_from_the_origin_contact_is_as_exact():
    """Coordinates of 1e6 sizes: reference positions keep 1e-10, gaps lose nothing more."""
    near, far = (moving_scene(shift, damping=Damping()) for shift in (0.0, 1e6))
    for run in (near, far):
        run.advance(300)
    u, u_far = near.nodes()[0], far.nodes()[0]
    assert abs(u - u_far).max() < 1e-5 * abs(u).max()


@pytest.mark.parametrize(
    ("young", "density"), [(1e6, 1.0), (1e-6, 1.0), (1.0, 1e2), (1.0, 1e-6), (1.0, 1e6)]
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


# --- refusals -----------------------------------------------------------------------------------


def test_prescribed_motions_that_collide_are_refused():
    mesh = join(low=rectangle(2, 2), high=moved(rectangle(2, 2), (0.1, 1.005)))
    low, high = (np.unique(mesh.triangles[mesh.body == body]) for body in (0, 1))
    loads = [
        hold(f"{name} {axis}", nodes, axis)
        for name, nodes in (("l", low), ("h", high))
        for axis in (0, 1)
    ]
    loads[-1] = hold("push", high, 1, -1e-3)
    run = Run(contact_problem(mesh, velocity_loads=tuple(loads)))
    with pytest.raises(
        CoreError, match=r"nodes .* and .*: contact: their prescribed motions collide"
    ):
        run.advance(1000)
    gap = 0.005 + run.nodes()[0][high, 1].mean()
    assert abs(gap) < 1e-3


def test_an_overlap_at_the_start_is_refused_with_its_place_and_depth():
    low, high = rectangle(4, 4), moved(rectangle(3, 3), (0.2, 0.99))
    with pytest.raises(CoreError, match=r"node \d+ at .* m stands 1.00E-02 m inside another part"):
        Run(contact_problem(join(low=low, high=high)))
    run = Run(contact_problem(join(low=low, high=moved(high, (0.0, 0.02)))))
    displacement = np.zeros((len(run.problem.mesh.nodes), 2))
    displacement[len(low.nodes) :, 1] = -0.05
    run.set_motion(displacement, 0 * displacement)
    with pytest.raises(CoreError, match="inside another part"):
        run.advance(1)


def test_faces_that_touch_are_no_overlap():
    Run(contact_problem(join(low=rectangle(4, 4), high=moved(rectangle(4, 4), (0.0, 1.0)))))


@pytest.mark.parametrize(
    ("contact", "words"),
    [
        (Contact({("rock", "platen"): 0.1}), "'platen' is neither a body nor an edge set"),
        (Contact({("rock", "rock"): -0.1}), "friction is a finite number >= 0"),
        (Contact(default_friction=np.nan), "friction is a finite number >= 0"),
        (Contact({("rock", "top"): 0.1, ("top", "rock"): 0.2}), "given twice"),
    ],
)
def test_a_bad_friction_table_is_refused(contact, words):
    with pytest.raises(CoreError, match=words):
        Run(problem(rectangle(2, 2), UNIT, contact=contact))


def test_bodies_too_fast_for_the_step_are_refused():
    bar = rectangle(4, 4)
    mesh = join(a=bar, b=moved(bar, (1.5, 0.3)))
    run = Run(contact_problem(mesh))
    velocity = np.zeros_like(mesh.nodes)
    velocity[: len(bar.nodes), 0] = 0.5
    run.set_motion(0 * velocity, velocity)
    with pytest.raises(CoreError, match="too fast for the step"):
        run.advance(200)


def test_without_contact_nothing_is_paid_and_parts_pass_through_each_other():
    bar = rectangle(4, 4)
    mesh = join(a=bar, b=moved(bar, (1.1, 0.0)))
    run = Run(problem(mesh, materials=(UNIT, UNIT)))
    velocity = np.zeros_like(mesh.nodes)
    velocity[: len(bar.nodes), 0] = 0.01
    run.set_motion(0 * velocity, velocity)
    run.advance(1000)
    assert run.contact_statistics().steps == 0
    assert run.energy().contact == run.energy().friction == 0.0
    assert run.nodes()[0][: len(bar.nodes), 0].min() > 0.2
