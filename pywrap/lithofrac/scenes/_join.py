"""One mesh of several bodies that share no node."""

from dataclasses import replace

import numpy as np

from lithofrac.problem import Mesh


def joined(bodies: dict[str, Mesh]) -> Mesh:
    """Put bodies side by side in one mesh.

    Parameters
    ----------
    bodies : name -> mesh of one body; the edge sets of the first keep their names, those of the
        others become `body.set`
    """
    nodes, triangles, body, sets, before = [], [], [], {}, 0
    for number, (name, mesh) in enumerate(bodies.items()):
        nodes.append(mesh.nodes)
        triangles.append(mesh.triangles + before)
        body.append(np.full(len(mesh.triangles), number, np.int32))
        prefix = f"{name}." if number else ""
        sets |= {f"{prefix}{key}": edges + before for key, edges in mesh.edge_sets.items()}
        before += len(mesh.nodes)
    return Mesh(
        nodes=np.concatenate(nodes),
        triangles=np.concatenate(triangles).astype(np.int32),
        body=np.concatenate(body),
        body_names=tuple(bodies),
        edge_sets={name: edges.astype(np.int32) for name, edges in sets.items()},
    )


def flattened(mesh: Mesh, faces: dict[str, tuple[int, float]]) -> Mesh:
    """Put the nodes of straight faces exactly where they belong, so that bodies fit to the bit.

    Parameters
    ----------
    faces : edge set -> component and its value [m] on all nodes of the set
    """
    nodes = mesh.nodes.copy()
    for name, (component, value) in faces.items():
        nodes[mesh.nodes_of(name), component] = value
    return replace(mesh, nodes=nodes)
