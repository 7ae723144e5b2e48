"""From raw triangles to a `Mesh`: turned counter-clockwise, numbered for locality, sets oriented.

Nodes are numbered by reverse Cuthill-McKee and elements by their lowest node within their body,
so that neighbours in the mesh are neighbours in memory.
"""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from lithofrac.problem import Mesh


def finished(
    nodes: np.ndarray,
    triangles: np.ndarray,
    lines: dict[str, np.ndarray],
    body: np.ndarray | None = None,
    body_names: tuple[str, ...] = ("rock",),
) -> Mesh:
    """Number and orient a mesh.

    Parameters
    ----------
    nodes : (n, 2) positions [m]; nodes without triangles are dropped
    triangles : (m, 3) in any orientation and order
    lines : name -> (k, 2) boundary edges in any orientation
    body : (m,) index into `body_names`, default all 0
    """
    body = np.zeros(len(triangles), dtype=np.int32) if body is None else body
    triangles = _counter_clockwise(nodes, triangles)
    used, triangles = np.unique(triangles, return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    new = np.empty(len(used), dtype=np.int64)
    order = _bandwidth_order(triangles, len(used))
    new[order] = np.arange(len(used))
    triangles = new[triangles]
    first = np.lexsort((triangles.sum(axis=1), triangles.min(axis=1), body))
    triangles = triangles[first].astype(np.int32)
    to_new = np.full(len(nodes), -1, dtype=np.int64)
    to_new[used] = new
    return Mesh(
        nodes=np.ascontiguousarray(nodes[used][order], dtype=float),
        triangles=triangles,
        body=np.asarray(body)[first].astype(np.int32),
        body_names=body_names,
        edge_sets={name: _material_left(to_new[part], triangles) for name, part in lines.items()},
    )


def _counter_clockwise(nodes: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (nodes[triangles[:, i]] for i in range(3))
    ab, ac = b - a, c - a
    turned = ab[:, 0] * ac[:, 1] < ab[:, 1] * ac[:, 0]
    return np.where(turned[:, None], triangles[:, ::-1], triangles)


def _bandwidth_order(triangles: np.ndarray, n_nodes: int) -> np.ndarray:
    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    ones = np.ones(len(pairs), dtype=np.int8)
    graph = coo_array((ones, (pairs[:, 0], pairs[:, 1])), shape=(n_nodes, n_nodes)).tocsr()
    return reverse_cuthill_mckee(graph + graph.T, symmetric_mode=True)


def _material_left(edges: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Turn edges so that they run as in their counter-clockwise triangle; sorted."""
    sides = {
        (int(t[i]), int(t[(i + 1) % 3])) for t in triangles for i in range(3)
    }  # directed edges
    turned = [(a, b) if (a, b) in sides else (b, a) for a, b in edges.tolist()]
    return np.array(sorted(turned), dtype=np.int32).reshape(-1, 2)
