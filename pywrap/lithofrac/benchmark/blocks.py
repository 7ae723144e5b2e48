"""What is stepped: square blocks that are pressed, that yield in a layer, or that are in pieces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lithofrac.config import Material
from lithofrac.config.case import DampingSection
from lithofrac.core import Run
from lithofrac.kernels import bare_elastic
from lithofrac.problem import Contact, Damping, Fracture, Mesh, Problem, Ramp, VelocityLoad
from lithofrac.results.recorder import Recorder
from lithofrac.scenes._rectangle import rectangle

SIDE = 0.08  # [m]
FRICTION = 0.5
STRAIN = 2e-4  # that closes the cuts
WARM_UP = 120  # steps; in the first hundred the core looks twice at every element
SETTLING = 200  # steps in which contact finds its impulses
EVERY = 100  # steps between records; a test of 1e5 steps has 1000
ROCK = "quartzite"
STRONGER = 10.0  # of the rock that does not yield
# Pairs an element -> squares along a side of the block -> squares along a side of a piece.
PIECES = {
    "0.02": {23: 12, 50: 25, 158: 50, 316: 50},
    "0.1": {23: 8, 50: 9, 158: 11, 316: 11},
    "0.5": {23: 3, 50: 3, 158: 3, 316: 3},
}
# Choice: from just beyond the strength, and so slowly that the core takes it for slow motion; the
# strength of the rock still rises over more than twice the strain that the windows add.
START = 1.0 + 1e-6  # of the strain at which the layer yields
SPEED = 1e-2  # of the upper side [m/s]

DAMPED = Damping(DampingSection().fraction)  # relative to affine motion, as a case has it


def square(cells: int, seed: int = 2) -> Mesh:
    """Two triangles in each of `cells` x `cells` squares."""
    return rectangle(SIDE, SIDE, SIDE / cells, structured=True, seed=seed)


def pressed(mesh: Mesh, material: Material, **changes) -> Problem:
    """The square, held below and pressed from above so slowly that nothing yields."""
    loads = (
        VelocityLoad("bottom", mesh.nodes_of("bottom"), 1),
        VelocityLoad("top", mesh.nodes_of("top"), 1, -1e-4, Ramp(0.0, 1e-5)),
    )
    probes = {"middle": len(mesh.triangles) // 2}
    problem = Problem(mesh, False, (material,), loads, (), 1.0, probes=probes)
    return replace(problem, **changes)


def yielding(mesh: Mesh, material: Material, share: float) -> Run:
    """The square in plane strain, of which a layer at the bottom yields in every step.

    The first elements, a share of all, are of `material`; the others are as stiff and
    `STRONGER` times as strong. The four sides follow an affine motion that starts just beyond the
    strength of the layer. All that yields lies together, as in a band: it fills chunks of its own.

    Parameters
    ----------
    share : of the elements, 0 to 1
    """
    weak = round(share * len(mesh.triangles))
    strong = stronger(material)
    body = (np.arange(len(mesh.triangles)) >= weak).astype(np.int32)
    both = replace(mesh, body=body, body_names=("weak", "strong"))
    rocks = (material, strong)
    if weak == len(body):
        both, rocks = mesh, (material,)
    # uniaxial stress: the sides give way as much as those of an elastic block
    side = material.poisson / (1.0 - material.poisson)
    strain = START * _strength(material) * (1.0 - material.poisson**2) / material.young
    rate = SPEED / SIDE * np.array([side, -1.0])
    loads = tuple(
        VelocityLoad(name, both.nodes_of(name), component, rate[component] * at)
        for name, component, at in (
            ("bottom", 1, 0.0), ("left", 0, 0.0), ("top", 1, SIDE), ("right", 0, SIDE),
        )
    )  # fmt: skip
    probes = {"middle": len(body) // 2}
    run = Run(Problem(both, False, rocks, loads, (), 1.0, probes=probes))
    run.set_motion(strain * both.nodes * [side, -1.0], both.nodes * rate)
    return run


def stronger(material: Material) -> Material:
    """The material `STRONGER` times as strong, as stiff and as brittle."""
    more = {
        "tensile_strength_MPa": STRONGER * material.tensile_strength_MPa,
        "fracture_energy_J_m2": STRONGER**2 * material.fracture_energy_J_m2,
        "cohesion_MPa": tuple(STRONGER * c for c in material.cohesion_MPa),
    }
    return material.model_copy(update=more)


def _strength(material: Material) -> float:
    """Uniaxial strength before any plastic strain [Pa]."""
    _, cohesion, friction, _ = material.table[:, 0]
    return 2.0 * cohesion * np.cos(friction) / (1.0 - np.sin(friction))


def elements_that_yield(run: Run, steps: int) -> list[np.ndarray]:
    """Elements whose plastic strain grows, in each of some steps."""
    everything = np.arange(len(run.problem.mesh.triangles))
    before, grew = run.elements(everything).plastic_strain, []
    for _ in range(steps):
        run.advance(1)
        now = run.elements(everything).plastic_strain
        grew.append(np.flatnonzero(now > before))
        before = now
    return grew


def in_pieces(mesh: Mesh, side: float) -> Mesh:
    """The mesh cut into squares, without its edge sets; each has its own nodes on the cuts.

    Parameters
    ----------
    mesh : structured mesh
    side : of a square, a multiple of its element size [m]
    """
    column, row = np.floor(mesh.centroids() / side).astype(int).T
    piece = column + row * (column.max() + 1)
    n_pieces = piece.max() + 1
    both, copy = np.unique(
        mesh.triangles.ravel() * n_pieces + np.repeat(piece, 3), return_inverse=True
    )
    triangles = copy.reshape(-1, 3).astype(np.int32)
    nodes = mesh.nodes[both // n_pieces]
    return replace(mesh, nodes=nodes, triangles=triangles, edge_sets={})


def cut_square(cells: int, pairs: str) -> Mesh:
    """The square in pieces that have so many contact pairs an element, a key of `PIECES`."""
    return in_pieces(square(cells, seed=1), PIECES[pairs][cells] * SIDE / cells)


def pieces(mesh: Mesh, material: Material, **changes) -> Run:
    """The pieces under uniaxial stress, pressed on from above, with friction between them."""
    low, high = (np.flatnonzero(abs(mesh.nodes[:, 1] - y) < 1e-9) for y in (0.0, SIDE))
    loads = (
        VelocityLoad("bottom", low.astype(np.int32), 1),
        VelocityLoad("top", high.astype(np.int32), 1, -0.1, Ramp(0.0, 1e-5)),
    )
    touching = Contact(default_friction=FRICTION)
    problem = Problem(mesh, False, (material,), loads, (), 1.0, contact=touching)
    run = Run(replace(problem, **changes))
    displacement = STRAIN * mesh.nodes * [material.poisson, -1.0]
    run.set_motion(displacement, 0.0 * displacement)
    run.advance(SETTLING)
    return run


def full_pieces(mesh: Mesh, material: Material, **changes) -> Run:
    """The pieces with failure map and probe, as rock that may crack has them.

    They are of rock so strong that nothing cracks: the map is asked for, and finds nothing.
    """
    probes = {"middle": len(mesh.triangles) // 2}
    return pieces(mesh, stronger(material), fracture=Fracture(), probes=probes, **changes)


def damped_pieces(mesh: Mesh, material: Material) -> Run:
    """The same with the damping that a case has unless it says otherwise."""
    return full_pieces(mesh, material, damping=DAMPED)


def stepper(run: Run, threads: int = 1) -> Callable[[int], None]:
    """Take steps with records at the normal interval: history, energy ledger, probes."""
    run.advance(WARM_UP)
    recorder = Recorder(run)

    def steps(count: int) -> None:
        for _ in range(0, count, EVERY):
            run.advance(min(EVERY, count), threads)
            recorder.record()

    return steps


def bare(mesh: Mesh, material: Material) -> Callable[[int], None]:
    """The bare elastic kernel on the same mesh; it lays out its elements anew in each call."""
    velocity = 1e-3 * mesh.nodes.T

    def steps(count: int) -> None:
        bare_elastic(
            mesh.nodes.T,
            mesh.triangles.T + 1,
            material.young,
            material.poisson,
            material.density,
            velocity,
            count,
            0.9,
        )

    return steps
