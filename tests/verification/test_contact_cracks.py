"""Faces of cracks: they stick, slip and hold without any help."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import (
    ROCK,
    contact_problem,
    deepest_overlap,
    join,
    moved,
    split,
    split_between,
    uniform_strain,
)
from models import hold, rectangle

from lithofrac.core import Run
from lithofrac.problem import Damping, Ramp

pytestmark = pytest.mark.verification


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


@pytest.mark.parametrize(("length", "speed"), [(2, 12.0), (4, 6.0), (6, 6.0)])
def test_faces_of_a_short_crack_slide_and_do_not_overlap(length, speed, n=16, size=0.02):
    """A crack between two tips, `length` edges long, under pressure and shear: its faces slide by
    more than the reach of the corners, so nodes stand over the faces next to the tips."""
    mesh = rectangle(n, n, size, size)
    whole = np.flatnonzero(abs(mesh.nodes[:, 0] - size / 2) > (length - 1) / 2 * size / n)
    mesh = split_between(mesh, (mesh.centroids()[:, 1] > size / 2).astype(int), whole)
    assert len(mesh.nodes) == (n + 1) ** 2 + length - 1
    y = mesh.nodes[:, 1]
    low, high = np.flatnonzero(y < 1e-9), np.flatnonzero(y > size - 1e-9)
    loads = (hold("low y", low, 1), hold("high y", high, 1))
    loads += (hold("low x", low, 0, -speed, ramp=Ramp(0, 2e-5)),)
    loads += (hold("high x", high, 0, speed, ramp=Ramp(0, 2e-5)),)
    problem = contact_problem(mesh, ROCK, friction=0.1, velocity_loads=loads)
    run = Run(replace(problem, damping=Damping(0.3)))
    run.set_motion(uniform_strain(mesh, 0.0, -0.02), 0.0 * mesh.nodes)
    copy = len(mesh.nodes) - 1
    twin = (mesh.nodes[:copy] == mesh.nodes[copy]).all(axis=1).argmax()
    slip = overlap = 0.0
    for _ in range(30):
        run.advance(20)
        moved = run.nodes()[0]
        slip = max(slip, abs(moved[copy, 0] - moved[twin, 0]))
        overlap = max(overlap, deepest_overlap(run))
    print(f"slip {slip / (size / n):.3f}, overlap {overlap:.1e} of an edge")
    assert slip > 0.03 * size / n
    assert overlap < 5e-4


def force_at_the_mouth(crossing):
    """Force of the first step on the tip of a wedge that presses on both sides of a short crack.

    The left side has slipped down the crack. The tip stands on its corner and, 5e-4 h deep, on
    the face of the right side below that one's corner. The faces cross by `crossing` h.
    """
    h = 0.5
    block = moved(rectangle(4, 4, 4 * h, 4 * h), (-2 * h, -4 * h))
    shared = (abs(block.nodes[:, 0]) < 1e-9) & (block.nodes[:, 1] < -0.9 * h)
    side = (block.centroids()[:, 0] > 0).astype(int)
    block = split_between(block, side, np.flatnonzero(shared))
    tip = h * np.array([5e-4, -0.04])
    sides = [[np.cos(lean), np.sin(lean)] for lean in np.radians([110.0, 170.0])]
    wedge = replace(rectangle(1, 1), nodes=tip + np.array([[0.0, 0.0], *sides]), edge_sets={})
    wedge = replace(wedge, triangles=np.array([[0, 1, 2]], np.int32), body=np.zeros(1, np.int32))
    mesh = join(block=block, wedge=moved(wedge, (0.0, h)))  # where it overlaps with nothing
    left, right = np.flatnonzero((abs(mesh.nodes) < 1e-9).all(axis=1))
    displacement = np.zeros_like(mesh.nodes)
    displacement[left, 1] = -0.05 * h
    displacement[right, 0] = -crossing * h
    displacement[-3:, 1] = -h
    run = Run(contact_problem(mesh))
    run.set_motion(displacement, 0 * displacement)
    run.advance(1)
    return run.contact_forces()[-3]


@pytest.mark.parametrize("crossing", [1e-9, 1e-7, 1e-6])
def test_both_faces_hold_a_tip_beside_a_crack_though_they_cross_by_rounding(crossing):
    """A node that the right face lets pass is inside the rock for good."""
    open_crack = force_at_the_mouth(-crossing)
    assert abs(open_crack[0]) > 0.0
    np.testing.assert_allclose(force_at_the_mouth(crossing), open_crack, rtol=2e-3)
