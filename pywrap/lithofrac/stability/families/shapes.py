"""Extremes of the mesh: slivers, every edge cut, one element, 200,000 elements."""

from dataclasses import replace

import numpy as np

from lithofrac.core import Run
from lithofrac.problem import Contact, Damping, Fracture, Mesh, Problem, Ramp, VelocityLoad
from lithofrac.scenes._rectangle import rectangle
from lithofrac.stability.cell import (
    CONTACT,
    CONTINUUM,
    CRACKED,
    CRACKS,
    RUBBLE,
    Cell,
    Left,
    Stable,
    Trial,
)
from lithofrac.stability.models import (
    ELASTIC,
    FACTOR,
    FRICTION,
    MESH,
    MM,
    ROCK,
    STEPS,
    block,
    cracked,
    cracking,
    in_pieces,
    joined,
    least_fracture_energy,
    pressed,
    rock,
    shifted,
    stacked,
    timed,
)

ASPECTS = (10.0, 100.0)
FRICTIONS = (0.0, 0.5, 1.2)
SQUARES = 316  # along a side: 199,712 triangles


def thinned(mesh: Mesh, aspect: float) -> Mesh:
    """The row of elements above the middle of each body thinned to 1 mm over `aspect`."""
    nodes = mesh.nodes.copy()
    for body in range(len(mesh.body_names)):
        own = np.unique(mesh.triangles[mesh.body == body])
        y = nodes[own, 1]
        middle = y.min() + MM * round(0.5 * np.ptp(y) / MM)
        above = y > middle + 0.5 * MM
        nodes[own[above], 1] -= MM * (1.0 - 1.0 / aspect)
    return replace(mesh, nodes=nodes)


def _regular(width: float = 8.0 * MM, height: float = 12.0 * MM) -> Mesh:
    """Unshifted: a shifted node would leave a thin row."""
    return rectangle(width, height, MM, True, 1)


def slivers() -> list[Cell]:
    """A row of slivers in the block, along a contact face, at a crack; and cuts that make them.

    The step follows the slivers, so that the top moves less in as many steps.
    """
    found = []
    for aspect in ASPECTS:
        words = f"aspect {aspect:g}"
        made = thinned(_regular(), aspect)
        pair = joined(
            block=shifted(thinned(_regular(5.0 * MM, 3.0 * MM), aspect), 2.0 * MM, 2.0 * MM),
            plate=_regular(10.0 * MM, 2.0 * MM),
        )
        found += [
            Cell("slivers", words, CONTINUUM, Stable(lambda m=made: Trial(pressed(m, ROCK)))),
            Cell("slivers", words, CONTACT, Stable(
                lambda m=pair: Trial(stacked(ROCK, ROCK, mesh=m)))),
            Cell("slivers", words, CRACKED, Stable(
                lambda m=made: Trial(cracking(cracked(m), ROCK)), CRACKS)),
        ]  # fmt: skip
    found.append(Cell("slivers", "cuts through elements", CONTINUUM, Left("nothing is cut")))
    found.append(Cell("slivers", "cuts through elements", CONTACT, Left("nothing is cut")))
    for seed in (1, 2, 3):
        words = f"cuts through elements, mesh {seed}"
        found.append(Cell("slivers", words, CRACKED, Stable(lambda s=seed: _cut(s), CRACKS)))
    return found


def _cut(seed: int) -> Trial:
    """Cracks through elements: guards keep the children from being slivers."""
    mesh = cracked(rectangle(8.0 * MM, 12.0 * MM, MM, True, seed))
    brittle = rock(fracture_energy_J_m2=1.1 * least_fracture_energy())
    fracture = Fracture("intra_element")
    problem = cracking(mesh, brittle, fracture=fracture, strain=0.016, steps=2 * STEPS)
    return Trial(problem, watch=_least_step)


def _least_step(run: Run) -> str:
    """What the cuts have left of the step of the whole elements."""
    problem = run.problem
    whole = Run(replace(problem, fracture=None)).critical_step[0]
    nodes, triangles, body, alive = run.mesh()
    n_cut = int(np.count_nonzero(~alive))
    now = replace(
        problem,
        mesh=Mesh(nodes, triangles[alive], body[alive], problem.mesh.body_names),
        velocity_loads=(),
        contact=None,
        fracture=None,
    )
    least = Run(now).critical_step[0] / whole
    return f"{n_cut} elements cut, least step of an element {least:.3f} of the first mesh's"


def every_edge() -> list[Cell]:
    """Every triangle with its own three nodes: pressed in a box, and crushed between plates."""
    family = "every edge cut"
    found = [Cell(family, "mu 0 to 1.2", CONTINUUM, Left("a continuum has no cut edges"))]
    for mu in FRICTIONS:
        words = f"mu {mu:g}"
        found += [
            Cell(family, words, CONTACT, Stable(lambda m=mu: _held(m), CRACKS)),
            Cell(family, f"{words}, crushed", CRACKED, Stable(lambda m=mu: _crushed(m), RUBBLE)),
        ]
    return found


def _held(mu: float) -> Trial:
    """Loose triangles under biaxial strain in a box whose lid comes down."""
    mesh = block(6.0 * MM, 6.0 * MM)
    mesh = in_pieces(mesh, np.arange(len(mesh.triangles)))
    x, y = mesh.nodes.T
    wide = 6.0 * MM
    near = 1e-6 * wide
    sides = np.flatnonzero((x < near) | (x > wide - near)).astype(np.int32)
    low = np.flatnonzero(y < near).astype(np.int32)
    top = np.flatnonzero(y > wide - near).astype(np.int32)
    problem = timed(
        Problem(
            mesh, False, (ELASTIC,), (), (), 1.0, time_step_factor=FACTOR,
            contact=Contact(default_friction=mu),
        ),
        STEPS,
    )  # fmt: skip
    speed = 2e-3 * wide / problem.end_time
    loads = (
        VelocityLoad("sides", sides, 0),
        VelocityLoad("low", low, 1),
        VelocityLoad("top", top, 1, -speed, Ramp(0.0, 0.25 * problem.end_time)),
    )
    start = mesh.nodes * np.array([-2e-3, -2e-3])
    return Trial(replace(problem, velocity_loads=loads), start, 0.0 * start)


def _crushed(mu: float) -> Trial:
    """Loose triangles that may crack no further, between plates that close at 5 m/s."""
    size, n = 20.0 * MM, 6
    mesh = rectangle(size, size, size / n, True, MESH)
    mesh = in_pieces(mesh, np.arange(len(mesh.triangles)))
    plate = rectangle(1.4 * size, 0.2 * size, 0.4 * size, True, 1)
    mesh = joined(
        rock=replace(mesh, edge_sets={}),
        bottom=shifted(plate, -0.2 * size, -0.2 * size),
        top=shifted(plate, -0.2 * size, size),
    )
    low, high = (np.unique(mesh.triangles[mesh.body == body]).astype(np.int32) for body in (1, 2))
    loads = (
        VelocityLoad("low x", low, 0),
        VelocityLoad("low y", low, 1),
        VelocityLoad("high x", high, 0),
        VelocityLoad("push", high, 1, -5.0, Ramp(0.0, 5e-6)),
    )
    contact = Contact(default_friction=mu)
    problem = Problem(mesh, False, (ELASTIC,) * 3, loads, (), 1.5e-4, time_step_factor=FACTOR,
                      contact=contact, fracture=Fracture())  # fmt: skip
    return Trial(problem)


def one_element() -> list[Cell]:
    """A mesh of one triangle: alone, on top of another one, and cracking."""
    one = Mesh(
        MM * np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.8]]),
        np.array([[0, 1, 2]], np.int32),
        np.zeros(1, np.int32),
        ("rock",),
    )
    # a triangle that rings: its corners start to part
    ring = 0.3 * np.array([[-1.0, -0.6], [1.0, -0.4], [0.0, 1.0]])

    def alone(fracture: bool) -> Trial:
        material = ROCK if fracture else ELASTIC
        more = {"contact": Contact(), "fracture": Fracture()} if fracture else {}
        problem = Problem(one, False, (material,), (), (), 1.0, time_step_factor=FACTOR, **more)
        motion = 5.0 * ring if fracture else ring
        return Trial(timed(problem, STEPS), 0.0 * motion, motion)

    def two() -> Trial:
        mesh = joined(low=one, high=shifted(one, 0.1 * MM, 0.805 * MM))
        velocity = np.concatenate([0.0 * ring, np.tile([0.0, -1.0], (3, 1))])
        problem = Problem(
            mesh, False, (ELASTIC,) * 2, (), (), 1.0, time_step_factor=FACTOR,
            contact=Contact(default_friction=FRICTION),
        )  # fmt: skip
        return Trial(timed(problem, STEPS), 0.0 * velocity, velocity)

    return [
        Cell("one element", "free, ringing", CONTINUUM, Stable(lambda: alone(False))),
        # an impact takes what the nodes that meet have: here they are all nodes
        Cell("one element", "two that collide", CONTACT,
             Stable(two, replace(CRACKS, contact_work=(-0.5, 1e-3)))),
        Cell("one element", "free, failing", CRACKED, Stable(lambda: alone(True), CRACKS)),
    ]  # fmt: skip


def many_elements() -> list[Cell]:
    """200,000 elements, with the steps that a search for the margin can pay."""
    family, words = "many elements", "199,712, pressed"
    return [
        Cell(family, words, CONTINUUM, Stable(lambda: _large(None, False)), slow=True),
        Cell(family, words, CONTACT, Stable(lambda: _large(11, False)), slow=True),
        Cell(family, words, CRACKED, Stable(lambda: _large(11, True), CRACKS), slow=True),
    ]


def _large(squares: int | None, cracks: bool) -> Trial:
    """A square pressed from above; `squares` along a side of the pieces that it is cut into."""
    side = SQUARES * MM
    mesh = rectangle(side, side, MM, True, MESH)
    if squares is not None:
        column, row = np.floor(mesh.centroids() / (squares * MM)).astype(int).T
        mesh = in_pieces(mesh, column + row * (column.max() + 1))
    more = {"strain": 2e-4, "steps": 200, "damping": Damping(0.3)}
    if cracks:
        return Trial(cracking(mesh, ROCK, **more))
    contact = Contact(default_friction=FRICTION) if squares else None
    return Trial(pressed(mesh, ELASTIC, contact=contact, **more))
