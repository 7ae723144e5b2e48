"""Coulomb friction: sliding, sticking, the wedge, friction by surface."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import contact_problem, join, moved
from models import hold, rectangle

from lithofrac.core import Run
from lithofrac.problem import Contact, Damping, PressureLoad, Ramp

pytestmark = pytest.mark.verification


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


def test_where_faces_of_different_friction_meet_the_largest_holds():
    """A tip with a rough and a smooth face is dragged over a fixed base."""
    nodes = [[-1, 0], [0, 0], [1, 0], [0, -1], [0.4, 0], [0.9, 1], [-0.1, 1]]
    mesh = replace(
        rectangle(1, 1),
        nodes=np.array(nodes, dtype=float),
        triangles=np.array([[0, 3, 1], [3, 2, 1], [4, 5, 6]], np.int32),
        body=np.array([0, 0, 1], np.int32),
        body_names=("base", "tip"),
        edge_sets={"rough": np.array([[6, 4]], np.int32)},
    )
    loads = (hold("x", range(4), 0), hold("y", range(4), 1))
    loads += (hold("drag", [5, 6], 0, 1e-3), hold("press", [5, 6], 1, -1e-4))
    run = Run(
        contact_problem(
            mesh,
            contact=Contact({("rough", "base"): 0.6}, default_friction=0.1),
            velocity_loads=loads,
            damping=Damping(alpha=1.0, relative_to="ground"),
        )
    )
    run.advance(int(60.0 / run.dt))
    along, up = run.contact_forces()[4]
    assert up > 0.0
    assert along == pytest.approx(-0.6 * up, rel=1e-9)
