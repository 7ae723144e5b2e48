"""What several contact tests share: meshes joined, split or cut into single triangles, problems,
sums over a run."""

from dataclasses import replace

import numpy as np
from models import Elastic, hold, problem, rectangle

from lithofrac.core import Run
from lithofrac.kernels import boundary_of
from lithofrac.problem import Contact, Mesh, Ramp

UNIT = Elastic(young=1.0, poisson=0.2, density=1.0)
ROCK = Elastic(young=70e9, poisson=0.2, density=2700.0)


def moved(mesh, offset=(0.0, 0.0), turn=0.0, scale=1.0):
    """A mesh turned by an angle [rad] about the origin, scaled, then shifted."""
    c, s = np.cos(turn), np.sin(turn)
    nodes = scale * mesh.nodes @ np.array([[c, s], [-s, c]]) + np.asarray(offset)
    return replace(mesh, nodes=nodes)


def join(**meshes):
    """One mesh of several bodies; their edge sets become `body.set`."""
    nodes, triangles, body, sets, shift = [], [], [], {}, 0
    for number, (name, mesh) in enumerate(meshes.items()):
        nodes.append(mesh.nodes)
        triangles.append(mesh.triangles + shift)
        body.append(np.full(len(mesh.triangles), number, np.int32))
        sets |= {f"{name}.{key}": edges + shift for key, edges in mesh.edge_sets.items()}
        shift += len(mesh.nodes)
    return Mesh(
        np.concatenate(nodes),
        np.concatenate(triangles).astype(np.int32),
        np.concatenate(body),
        tuple(meshes),
        sets,
    )


def split(mesh, side):
    """Give the elements with `side` 1 their own copies of the nodes they share with side 0."""
    shared = np.intersect1d(mesh.triangles[side == 0], mesh.triangles[side == 1])
    return _renumber(mesh, side, shared)


def split_between(mesh, side, keep):
    """As `split`, but the nodes `keep` (crack tips) stay shared."""
    shared = np.intersect1d(mesh.triangles[side == 0], mesh.triangles[side == 1])
    return _renumber(mesh, side, np.setdiff1d(shared, keep))


def _renumber(mesh, side, shared):
    copy = np.arange(len(mesh.nodes))
    copy[shared] = len(mesh.nodes) + np.arange(len(shared))
    triangles = mesh.triangles.copy()
    triangles[side == 1] = copy[triangles[side == 1]]
    nodes = np.concatenate([mesh.nodes, mesh.nodes[shared]])
    return replace(mesh, nodes=nodes, triangles=triangles.astype(np.int32), edge_sets={})


def cut_all_edges(mesh):
    """Every triangle gets its own three nodes."""
    nodes = mesh.nodes[mesh.triangles].reshape(-1, 2)
    triangles = np.arange(len(nodes), dtype=np.int32).reshape(-1, 3)
    return replace(mesh, nodes=nodes, triangles=triangles, edge_sets={})


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
