"""Contact with an exact answer: Hertz's pressure between curved bodies, bars that collide."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lithofrac.accuracy.subject import Outcome, Subject, outcome, timed_run
from lithofrac.config.material import Material
from lithofrac.core import Run
from lithofrac.problem import Contact, Damping, Mesh, PressureLoad, Problem, Ramp, VelocityLoad
from lithofrac.scenes._rectangle import rectangle

RADIUS, HALF_WIDTH = 0.2, 0.01  # of the curved body and of its contact [m]
EXTENT = 6.0 * HALF_WIDTH  # of either body across and along, from the contact [m]
FINEST = 0.25  # width of the elements at the contact over that of equal ones
SETTLED = 35.0  # transits after the ramp
LENGTH = 0.1  # of a bar [m]
SPEED = 1.0  # at which either bar comes [m/s]
GAP = 1e-3 * LENGTH


def elastic(poisson: float) -> Material:
    """An elastic rock."""
    return Material(
        elastic=True, young_modulus_GPa=70.0, poisson_ratio=poisson, density_kg_m3=2700.0
    )


def joined(first: Mesh, second: Mesh) -> Mesh:
    """Bodies `first` and `second`; their edge sets become `first.left` and so on."""
    shift, n = len(first.nodes), len(first.triangles)
    sets = {f"first.{name}": edges for name, edges in first.edge_sets.items()}
    sets |= {f"second.{name}": edges + shift for name, edges in second.edge_sets.items()}
    return Mesh(
        np.concatenate([first.nodes, second.nodes]),
        np.concatenate([first.triangles, second.triangles + shift]),
        np.repeat(np.array([0, 1], np.int32), [n, len(second.triangles)]),
        ("first", "second"),
        sets,
    )


def graded(columns: int, rows: int) -> Mesh:
    """A block of width 2 and height 1 above the origin, elements finest there, times `EXTENT`."""
    mesh = _grid(columns, rows, 2.0, 1.0)
    s = mesh.nodes - [1.0, 0.0]
    return replace(mesh, nodes=EXTENT * (FINEST * s + (1.0 - FINEST) * s**3))


def _grid(columns: int, rows: int, width: float, height: float) -> Mesh:
    """A rectangle of so many columns and rows of squares, each of two triangles."""
    mesh = rectangle(float(columns), float(rows), 1.0, structured=True, seed=1)
    return replace(mesh, nodes=mesh.nodes * [width / columns, height / rows])


def hertz(
    element_size_mm: float,
    ramp_transits: float,
    time_step_factor: float,
    damping_fraction: float,
    contact_tolerance: float,
) -> Outcome:
    """A parabola pressed on a flat: peak pressure and half-width over those of Hertz.

    a = sqrt(4 F R / (pi E*)), p = sqrt(F E* / (pi R)) with F the contact force per depth (Johnson,
    Contact Mechanics, 1985, section 4.2).
    """
    n = round(FINEST * EXTENT / (1e-3 * element_size_mm))
    material = elastic(0.25)
    upper, lower = graded(2 * n, n), graded(2 * n + 2, n)
    x, y = upper.nodes.T
    rise = x**2 / (2 * RADIUS) * (1 - y / EXTENT)
    upper = replace(upper, nodes=np.column_stack([x, y + rise]))
    mesh = joined(upper, replace(lower, nodes=-lower.nodes))
    force = np.pi * HALF_WIDTH**2 * stiffness(material) / (4 * RADIUS)
    top, bottom = mesh.nodes_of("first.top"), mesh.nodes_of("second.top")
    middle = [nodes[[np.argmin(abs(mesh.nodes[nodes, 0]))]] for nodes in (top, bottom)]
    transit = EXTENT / material.wave_speed
    ramp = Ramp(0.0, ramp_transits * transit)
    problem = Problem(
        mesh,
        axisymmetric=False,
        materials=(material, material),
        velocity_loads=(
            VelocityLoad("bottom", bottom, 1),
            VelocityLoad("upper x", middle[0], 0),
            VelocityLoad("lower x", middle[1], 0),
        ),
        pressure_loads=(
            PressureLoad("press", mesh.edge_sets["first.top"], force / (2 * EXTENT), ramp=ramp),
        ),
        end_time=(ramp_transits + SETTLED) * transit,
        damping=Damping(damping_fraction, relative_to="ground"),
        contact=Contact(tolerance=contact_tolerance),
        time_step_factor=time_step_factor,
    )
    run, seconds = timed_run(problem)
    peak, half = hertz_ratios(run)
    return outcome({"peak pressure": peak - 1.0, "half-width": half - 1.0}, run, seconds)


def stiffness(material: Material) -> float:
    """E* of two bodies of one material [Pa]."""
    return material.young / (2 * (1 - material.poisson**2))


def hertz_ratios(run: Run) -> tuple[float, float]:
    """Peak pressure and half-width of a contact over those of Hertz under its force."""
    mesh = run.problem.mesh
    nodes = mesh.nodes_of("first.bottom")
    nodes = nodes[np.argsort(mesh.nodes[nodes, 0])]
    at = (mesh.nodes + run.nodes()[0])[nodes, 0]
    on_node = run.contact_forces()[nodes, 1]
    return ratios(at, on_node, stiffness(run.problem.materials[0]))


def ratios(at: np.ndarray, on_node: np.ndarray, modulus: float) -> tuple[float, float]:
    """Peak pressure and half-width over those of Hertz.

    Half-width by the second moment, which is a^2/4 under Hertz's ellipse: the outermost node that
    is loaded would tell it to an element only.

    Parameters
    ----------
    at, on_node : (n,) positions [m] from left to right, and forces per depth [N/m]
    modulus : E* [Pa]
    """
    force, pressure = on_node.sum(), on_node / np.gradient(at)
    peak = np.sqrt(force * modulus / (np.pi * RADIUS))
    width = np.sqrt(4 * force * RADIUS / (np.pi * modulus))
    return float(pressure.max() / peak), float(2.0 * np.sqrt(on_node @ at**2 / force) / width)


def bar_impact(
    element_size_mm: float,
    time_step_factor: float,
    damping_fraction: float,
    contact_tolerance: float,
) -> Outcome:
    """Two equal bars collide and exchange their velocities after 2 L/c: restitution 1."""
    n = round(LENGTH / (1e-3 * element_size_mm))
    bar, material = _grid(n, 2, LENGTH, 2 * LENGTH / n), elastic(0.0)
    mesh = joined(bar, replace(bar, nodes=bar.nodes + [LENGTH + GAP, 0.0]))
    left = np.arange(len(mesh.nodes)) < len(bar.nodes)
    velocity = np.zeros_like(mesh.nodes)
    velocity[:, 0] = np.where(left, SPEED, -SPEED)
    problem = Problem(
        mesh,
        axisymmetric=False,
        materials=(material, material),
        velocity_loads=(),
        pressure_loads=(),
        end_time=GAP / (2 * SPEED) + 3.5 * LENGTH / material.wave_speed,
        damping=Damping(damping_fraction),
        contact=Contact(tolerance=contact_tolerance),
        time_step_factor=time_step_factor,
    )
    run, seconds = timed_run(problem, 0.0 * velocity, velocity)
    _, after, mass = run.nodes()
    restitution = -(mass[left] @ after[left, 0]) / mass[left].sum() / SPEED
    return outcome({"restitution": float(restitution - 1.0)}, run, seconds)


HERTZ = Subject(
    "hertz",
    "a parabola of 200 mm radius pressed on a flat, contact 20 mm wide",
    hertz,
    {
        "element_size_mm": EXTENT * FINEST / 24 * 1e3,
        "ramp_transits": 15.0,
        "time_step_factor": 0.9,
        "damping_fraction": 0.3,
        "contact_tolerance": 1.0,
    },
    {
        "element_size_mm": tuple(EXTENT * FINEST / n * 1e3 for n in (6, 12, 36)),
        "ramp_transits": (5.0, 40.0),
        "time_step_factor": (0.45,),
        "damping_fraction": (0.1, 0.9),
        "contact_tolerance": (1e-3, 0.1, 10.0, 100.0),
    },
    ("peak pressure", "half-width"),
    reasons={
        "half-width": "It is a moment of the whole pressure, which elements of 1.25 mm tell as "
        "well; the peak pressure, read from the same run, is off by 2.5 % on them."
    },
)

BAR_IMPACT = Subject(
    "bar_impact",
    "two elastic bars of 100 mm collide head on at 1 m/s each",
    bar_impact,
    {
        "element_size_mm": 2.5,
        "time_step_factor": 0.9,
        "damping_fraction": 0.0,
        "contact_tolerance": 1.0,
    },
    {
        "element_size_mm": (10.0, 5.0, 1.25, 0.625, 0.3125),
        "time_step_factor": (0.3, 0.6),
        "damping_fraction": (0.01, 0.1, 0.3),
        "contact_tolerance": (1e-3, 0.1, 10.0, 100.0),
    },
    ("restitution",),
)
