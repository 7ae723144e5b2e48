"""Every owner of nodes and elements follows the cracks (fortran/run/grow.f90)."""

from dataclasses import replace

import numpy as np
import pytest

from lithofrac.problem import Damping
from lithofrac.results.cracks import fragments

MODES = ["inter_element", "intra_element"]
BOTH = pytest.mark.parametrize("mode", MODES)
DAMPING = {"none": Damping(), "affine": Damping(fraction=0.3)}


def events(run, n_steps):
    """Take single steps; yields after every one in which cracks came."""
    cracks = run.sizes().cracks
    while run.step < n_steps:
        run.advance(1)
        if run.sizes().cracks > cracks:
            cracks = run.sizes().cracks
            yield run


def momentum(run):
    _, velocity, mass = run.nodes()
    return mass @ velocity


@pytest.mark.parametrize("load", ["burst", "pull", "squeeze"])
@BOTH
def test_no_event_breaks_mass_step_or_topology(cracking, load, mode):
    run = cracking(load, mode).start()
    run.advance(0)
    mass, dt, n = run.nodes()[2].sum(), run.dt, 0
    for _ in events(run, 600):
        n += 1
        run.check()
        assert run.nodes()[2].sum() == pytest.approx(mass, rel=1e-14)
        assert run.nodes()[2].min() > 0.0
        assert run.dt == dt
    assert n >= 2
    alive = run.mesh()[3]
    assert (mode == "intra_element") == bool(np.any(~alive))


@pytest.mark.parametrize("damping", DAMPING)
@pytest.mark.parametrize("release", [None, 0, 5])
@BOTH
def test_a_free_body_keeps_its_momentum(cracking, mode, release, damping):
    model = cracking("burst", mode, damping=DAMPING[damping])
    run = model.with_fracture(release_steps=release).start()
    run.advance(0)
    before, scale = momentum(run), abs(run.nodes()[1].T * run.nodes()[2]).sum()
    run.advance(500)
    assert run.sizes().cracks >= 20
    assert abs(momentum(run) - before).max() < 1e-13 * scale


@pytest.mark.parametrize("damping", DAMPING)
@pytest.mark.parametrize("release", [None, 0])
@pytest.mark.parametrize("load", ["burst", "pull", "squeeze"])
@BOTH
def test_no_event_leaves_a_gap_in_the_ledger(cracking, load, mode, release, damping):
    """The residual moves no more in steps with cracks than ten times what it moves in others.

    With `pull`, cuts fall on edges between a driven and a free node. With damping, driven nodes
    lie on fragments that have a drag of their own.
    """
    model = cracking(load, mode, damping=DAMPING[damping])
    run = model.with_fracture(release_steps=release).start()
    run.advance(0)
    moved, cracked, residual, cracks = [], [], 0.0, 0
    while run.step < 500:
        run.advance(1)
        now = run.energy().residual
        moved.append(abs(now - residual))
        cracked.append(run.sizes().cracks > cracks)
        residual, cracks = now, run.sizes().cracks
    moved, cracked = np.array(moved), np.array(cracked)
    around = cracked | np.roll(cracked, 1)
    assert cracked.sum() >= 2
    assert moved[around].max() < 10 * moved[~around].max() < 1e-5
    assert run.energy().relump <= 0.0
    assert mode == "intra_element" or run.energy().relump == 0.0


def test_the_parts_of_a_body_have_its_area(cracking):
    run = cracking("burst", "intra_element").start()
    run.advance(600)
    part, rows = run.parts(), fragments(run)
    nodes, triangles, _, alive = run.mesh()
    corners = nodes[triangles[alive]]
    ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = np.bincount(part[alive], weights=0.5 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]))
    assert len(rows) == np.count_nonzero(areas) - 1 > 5
    assert areas.sum() == pytest.approx(0.01, rel=1e-13)
    assert 1e-6 * rows[:, 4].sum() + areas.max() == pytest.approx(0.01, rel=1e-13)


def test_whoever_asks_for_a_cut_element_finds_a_piece(cracking):
    run = cracking("burst", "intra_element").start()
    run.advance(600)
    nodes, triangles, _, alive = run.mesh()
    stress = run.elements(np.arange(len(alive))).stress
    for element in np.flatnonzero(~alive):
        same = np.flatnonzero(alive & (stress == stress[element]).all(axis=1))
        a, b, c = nodes[triangles[element]]
        for piece in same:
            centre = nodes[triangles[piece]].mean(axis=0)
            share = np.linalg.solve(np.column_stack([b - a, c - a]), centre - a)
            if share.min() > 0.0 and share.sum() < 1.0:
                break
        else:
            pytest.fail(f"element {element} has no piece of its own")


@BOTH
def test_pressure_stays_on_the_edges_of_its_side(cracking, mode):
    """Momentum grows by the thrust on all edges of the lower side, however they were cut."""
    run = cracking("blow", mode).start()
    run.advance(0)
    before = momentum(run)
    while run.step < 400:
        run.advance(1)
        nodes, triangles, _, alive = run.mesh()
        positions, thrust, edges = nodes + run.nodes()[0], np.zeros(2), 0
        for k in range(3):
            first, second = triangles[alive, k], triangles[alive, (k + 1) % 3]
            side = (nodes[first, 1] == 0.0) & (nodes[second, 1] == 0.0)
            edges += side.sum()
            along = (positions[second[side]] - positions[first[side]]).sum(axis=0)
            thrust += np.array([-along[1], along[0]])
        now = momentum(run)
        np.testing.assert_allclose(now - before, run.dt * thrust, rtol=1e-6, atol=1e-12)
        before = now
    assert edges >= 6


def test_momentum_of_the_parts_is_that_of_the_nodes(cracking):
    """Every element has a third of its mass at each corner."""
    run = cracking("burst", "intra_element").start()
    run.advance(600)
    _, triangles, _, alive = run.mesh()
    _, velocity, mass = run.nodes()
    rows, part = fragments(run), run.parts()
    loose = np.isin(part, rows[:, 1])
    ours = np.unique(triangles[loose])
    assert not np.isin(triangles[alive & ~loose], ours).any(), "no node is shared by two parts"
    assert rows[:, 5].sum() == pytest.approx(mass[ours].sum(), rel=1e-12)
    assert rows[:, 3].sum() == loose.sum()
    np.testing.assert_allclose(rows[:, 5] @ rows[:, 8:10], mass[ours] @ velocity[ours], rtol=1e-12)


def test_loose_fragments_keep_their_spin(cracking):
    """Their drag adds no moment: angular momentum changes by what friction does to it, not more."""
    model = cracking("burst", "inter_element", damping=DAMPING["affine"])
    arm = model.problem.mesh.nodes - 0.05
    spinning = model.velocity + 40.0 * np.column_stack([-arm[:, 1], arm[:, 0]])
    run = replace(model, velocity=spinning).with_fracture(release_steps=0).start()
    run.advance(0)

    def angular():
        displacement, velocity, mass = run.nodes()
        x = run.mesh()[0] + displacement - 0.05
        spin = mass * (x[:, 0] * velocity[:, 1] - x[:, 1] * velocity[:, 0])
        return spin.sum(), (mass * np.hypot(*x.T) * np.hypot(*velocity.T)).sum()

    before, scale = angular()
    run.advance(500)
    assert len(fragments(run)) >= 5
    change = abs(angular()[0] - before) / scale
    print(f"angular momentum {before / scale:.1e}, changes by {change:.1e} of its parts")
    assert change < 1e-6
