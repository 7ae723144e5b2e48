"""Meshes of several parts for the contact tests: joined, split, or cut into single triangles."""

from dataclasses import replace

import numpy as np

from lithofrac.problem import Mesh


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
