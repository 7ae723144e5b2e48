"""Pressure between matching, non-matching and curved faces."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import contact_problem, join, moved, uniform_strain
from models import Elastic, hold, rectangle

from lithofrac.core import Run
from lithofrac.problem import Damping, PressureLoad, Ramp

pytestmark = pytest.mark.verification
STIFFNESS = 1 / (2 * (1 - 0.25**2))  # E* of two bodies with E = 1, nu = 0.25


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


def pressed_parabola(n, friction=0.0, drag=0.0, half_width=0.05, radius=1.0):
    """Run of a body with the profile x^2/(2R) on a flat one of the same material, not begun.

    2n elements across six half-widths each way. With `drag` both far sides are held along x, the
    upper one moves at that speed once the bodies are pressed, and springs keep it from tilting.
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
    force = np.pi * half_width**2 * STIFFNESS / (4 * radius)
    top, bottom = mesh.nodes_of("up.top"), mesh.nodes_of("low.top")
    held = (hold("low x", bottom[[n]], 0), hold("up x", top[[n]], 0))
    pressure, spring = force / (2 * extent), 0.0
    if drag:
        spring = 50.0
        pressure += spring * 0.0032  # by how much it gives way
        held = (hold("low x", bottom, 0), hold("up x", top, 0, drag, ramp=Ramp(8.0, 4.0)))
    return Run(
        contact_problem(
            mesh,
            material,
            friction=friction,
            velocity_loads=(hold("bottom", bottom, 1), *held),
            pressure_loads=(
                PressureLoad("press", mesh.edge_sets["up.top"], pressure, spring, Ramp(0.0, 4.0)),
            ),
            damping=Damping(alpha=1.0, relative_to="ground"),
        )
    )


def touching(run):
    """Positions and contact forces of the lower side of the upper body, from left to right."""
    mesh = run.problem.mesh
    nodes = mesh.nodes_of("up.bottom")
    nodes = nodes[np.argsort(mesh.nodes[nodes, 0])]
    return (mesh.nodes + run.nodes()[0])[nodes, 0], run.contact_forces()[nodes]


def hertz(n, radius=1.0):
    """Half-width and peak pressure over Hertz's: a = sqrt(4 F R/(pi E*)), p = sqrt(F E*/(pi R))
    with F the contact force."""
    run = pressed_parabola(n, radius=radius)
    run.advance(int(14.0 / run.dt))
    at, on_node = touching(run)
    force, pressure = on_node[:, 1].sum(), on_node[:, 1] / np.gradient(at)
    peak = np.sqrt(force * STIFFNESS / (np.pi * radius))
    width = np.sqrt(4 * force * radius / (np.pi * STIFFNESS))
    loaded = np.flatnonzero(pressure > 1e-3 * peak)
    spacing = np.diff(at[loaded[0] - 1 : loaded[-1] + 2]).max()
    half = 0.5 * (at[loaded[-1]] - at[loaded[0]])
    return half / width, spacing / width, pressure.max() / peak


@pytest.mark.slow
def test_hertz_pressure_between_curved_bodies():
    results = np.array([hertz(n) for n in (12, 24, 48)])
    orders = -np.diff(np.log(abs(results[:, 2] - 1))) / np.log(2.0)
    print(f"a/a0 {results[:, 0]}, spacing {results[:, 1]}, p/p0 {results[:, 2]}, orders {orders}")
    assert (abs(results[:, 0] - 1) <= results[:, 1]).all()
    assert abs(results[-1, 2] - 1) < 0.03


@pytest.mark.slow
def test_a_curved_body_that_is_dragged_sticks_in_the_middle_and_slips_outside(friction=0.5):
    """Cattaneo and Mindlin: the stuck part is sqrt(1 - T/(mu N)) of the contact, to an element."""
    run = pressed_parabola(24, friction, drag=2e-4)
    share = 0.0
    while share < 0.6:
        assert run.step * run.dt < 60.0, "the drag does not build up"
        run.advance(50)
        at, on_node = touching(run)
        along, up = abs(on_node).sum(axis=0)
        share = along / (friction * up) if run.step * run.dt > 8.0 else 0.0
    tangential, normal = abs(on_node[:, 0]), on_node[:, 1]
    loaded = np.flatnonzero(normal > 1e-3 * normal.max())
    stuck = loaded[tangential[loaded] < (1 - 1e-3) * friction * normal[loaded]]
    half = 0.5 * (at[loaded[-1]] - at[loaded[0]])
    spacing = np.diff(at[loaded[0] - 1 : loaded[-1] + 2]).max()
    found = 0.5 * (at[stuck[-1]] - at[stuck[0]])
    exact = np.sqrt(1 - share) * half
    print(
        f"T/(mu N) {share:.3f}, stuck {found / half:.3f} of the contact, exact {exact / half:.3f},"
    )
    print(f"an element is {spacing / half:.3f}")
    assert (np.diff(stuck) == 1).all(), "one stuck part"
    assert abs(found - exact) <= spacing
