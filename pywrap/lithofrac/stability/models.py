"""The three meshes of the matrix: a block, a block on a plate, a block with a jagged crack.

All are a few hundred triangles in the size of a laboratory test. The continuum is pressed from its
top; contact is pressed and slid; the cracked block is cut through before it starts, and cracks on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lithofrac.config.material import Material
from lithofrac.core import Run
from lithofrac.problem import Contact, Damping, Fracture, Mesh, Problem, Ramp, VelocityLoad
from lithofrac.scenes._rectangle import rectangle

MM = 1e-3
SIZE = 1.0 * MM  # of an element
WIDTH, HEIGHT = 8.0 * MM, 12.0 * MM
STEPS = 1200  # of a usual trial
FACTOR = 0.9  # the default of a case
FRICTION = 0.6
STRAIN = 0.012  # beyond the peak of the sandstone
MESH = 2  # realisation: inner nodes are shifted
ROCK = Material.load("sandstone")
ELASTIC = ROCK.model_copy(update={"elastic": True, "title": "elastic"})


def rock(**changes) -> Material:
    """The sandstone of Table 1 with other numbers; they are checked as those of a file."""
    return Material.model_validate(ROCK.model_dump() | changes)


def elastic(**changes) -> Material:
    """The same without yield."""
    return rock(elastic=True, **changes)


def block(width: float = WIDTH, height: float = HEIGHT, size: float = SIZE) -> Mesh:
    """Shifted squares, two triangles each, with the edge sets bottom, right, top and left."""
    return rectangle(width, height, size, structured=True, seed=MESH)


def least_fracture_energy() -> float:
    """Gf of the largest element of the block at the limit of a unique return [J/m2]."""
    width = float(ROCK.band_width_of(block().areas().max()))
    return ROCK.fracture_energy * width / ROCK.band_width_limit


def shifted(mesh: Mesh, x: float, y: float) -> Mesh:
    """The mesh somewhere else."""
    return replace(mesh, nodes=mesh.nodes + [x, y])


def joined(**meshes: Mesh) -> Mesh:
    """Bodies that share no node; their edge sets become `body.set`."""
    nodes, triangles, body, sets, shift = [], [], [], {}, 0
    for number, (name, mesh) in enumerate(meshes.items()):
        nodes.append(mesh.nodes)
        triangles.append(mesh.triangles + shift)
        body.append(np.full(len(mesh.triangles), number))
        sets |= {f"{name}.{key}": edges + shift for key, edges in mesh.edge_sets.items()}
        shift += len(mesh.nodes)
    return Mesh(
        np.concatenate(nodes),
        np.concatenate(triangles).astype(np.int32),
        np.concatenate(body).astype(np.int32),
        tuple(meshes),
        sets,
    )


def in_pieces(mesh: Mesh, piece: np.ndarray) -> Mesh:
    """The mesh with nodes of its own for every piece (m,) of elements."""
    of_corner = np.repeat(piece, 3)
    key, copy = np.unique([mesh.triangles.ravel(), of_corner], axis=1, return_inverse=True)
    triangles = copy.reshape(-1, 3).astype(np.int32)
    owner = {
        (int(old[i]), int(old[(i + 1) % 3])): (int(new[i]), int(new[(i + 1) % 3]))
        for old, new in zip(mesh.triangles, triangles, strict=True)
        for i in range(3)
    }
    sets = {
        name: np.array([owner[int(a), int(b)] for a, b in edges], np.int32)
        for name, edges in mesh.edge_sets.items()
    }
    return replace(mesh, nodes=mesh.nodes[key[0]], triangles=triangles, edge_sets=sets)


def cracked(mesh: Mesh) -> Mesh:
    """The mesh cut through along a jagged, inclined line."""
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    x, y = ((mesh.centroids() - low) / (high - low) - 0.5).T
    return in_pieces(mesh, (y > 0.3 * x + 0.06 * np.sin(9.0 * x)).astype(int))


def two_bodies(mesh: Mesh, second: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Mesh:
    """Bonded bodies `rock` and `other`; `second(x, y)` tells the latter from the centroids."""
    body = second(*mesh.centroids().T).astype(np.int32)
    return replace(mesh, body=body, body_names=("rock", "other"))


def right_half(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """For `two_bodies`."""
    return x > 0.5 * (x.min() + x.max())


def timed(problem: Problem, steps: int = STEPS) -> Problem:
    """The problem with an end after so many steps at its time step factor."""
    run = Run(replace(problem, velocity_loads=(), pressure_loads=()))
    return replace(problem, end_time=steps * run.dt)


def pressed(
    mesh: Mesh,
    *materials: Material,
    strain: float = STRAIN,
    steps: int = STEPS,
    speed: float | None = None,
    **changes,
) -> Problem:
    """A block on a roller, shortened from its top by `strain`, or at `speed` [m/s] for the time.

    The speed rises over the first quarter of the time. Rock that yields is damped as in the cases
    of the suite: what it gives back beyond its peak rings on otherwise.
    """
    bottom, top = mesh.nodes_of("bottom"), mesh.nodes_of("top")
    corner = bottom[np.argmin(mesh.nodes[bottom, 0])][None]
    given = {"mesh": mesh, "axisymmetric": False, "materials": materials, "end_time": 1.0}
    given |= {"velocity_loads": (), "pressure_loads": (), "time_step_factor": FACTOR}
    if not all(material.elastic for material in materials):
        given["damping"] = Damping(0.3)
    problem = timed(Problem(**(given | changes)), steps)
    time, height = problem.end_time, np.ptp(mesh.nodes[:, 1])
    if speed is None:
        speed = strain * height / (0.875 * time)
    loads = (
        VelocityLoad("bottom", bottom, 1),
        VelocityLoad("corner", corner, 0),
        VelocityLoad("top", top, 1, -speed, Ramp(0.0, 0.25 * time)),
    )
    return replace(problem, velocity_loads=loads + problem.velocity_loads)


def cracking(mesh: Mesh, *materials: Material, friction: float = FRICTION, **changes) -> Problem:
    """`pressed`, with contact, and cracks wherever they will go."""
    given = {"contact": Contact(default_friction=friction), "fracture": Fracture()}
    return pressed(mesh, *materials, **(given | changes))


def stacked_mesh(size: float = 1.0) -> Mesh:
    """A block on a wider plate; their meshes do not match.

    Parameters
    ----------
    size : width of the block over 5 mm
    """
    low = shifted(rectangle(10.0 * MM * size, 2.0 * MM * size, 1.1 * MM * size, True, 1), 0.0, 0.0)
    high = rectangle(5.0 * MM * size, 3.0 * MM * size, 1.0 * MM * size, True, MESH)
    return joined(block=shifted(high, 2.0 * MM * size, 2.0 * MM * size), plate=low)


def stacked(
    upper: Material,
    lower: Material,
    friction: float = 0.3,
    strain: float = 2e-3,
    steps: int = 2 * STEPS,
    mesh: Mesh | None = None,
    speed: float | None = None,
    **changes,
) -> Problem:
    """A block pressed on a plate, then slid along it as far as it was pressed.

    `speed` [m/s] presses for half of the time instead of `strain`.
    """
    mesh = stacked_mesh() if mesh is None else mesh
    given = {"mesh": mesh, "axisymmetric": False, "materials": (upper, lower), "end_time": 1.0}
    given |= {"velocity_loads": (), "pressure_loads": (), "time_step_factor": FACTOR}
    given |= {"contact": Contact(default_friction=friction)}
    problem = timed(Problem(**(given | changes)), steps)
    time = problem.end_time
    top, bottom = mesh.nodes_of("block.top"), mesh.nodes_of("plate.bottom")
    height = np.ptp(mesh.nodes[mesh.triangles[mesh.body == 0], 1])
    if speed is None:
        speed = strain * height / (0.875 * time)
    loads = (
        VelocityLoad("held x", bottom, 0),
        VelocityLoad("held y", bottom, 1),
        VelocityLoad("press", top, 1, -speed, Ramp(0.0, 0.25 * time)),
        VelocityLoad("slide", top, 0, speed, Ramp(0.4 * time, 0.2 * time)),
    )
    return replace(problem, velocity_loads=loads)
