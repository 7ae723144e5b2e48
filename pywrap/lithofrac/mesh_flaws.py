"""What is wrong with a mesh that comes from a file, in one sentence.

Nodes and elements are numbered from 1 in sentences, as in those of the core.
"""

from __future__ import annotations

import numpy as np

FARTHEST = 1e9  # metres; beyond, areas overflow or elements vanish in round-off
FLAT = 1e-12  # twice the area of a triangle over its longest edge squared

Arrays = dict[str, np.ndarray]


def flaw(
    nodes: np.ndarray,
    triangles: np.ndarray,
    body: np.ndarray,
    body_names: tuple[str, ...],
    edge_sets: Arrays,
) -> str:
    """What is wrong first, or nothing; arguments are the attributes of `problem.Mesh`."""
    return (
        wrong_shapes(nodes, triangles, body, edge_sets)
        or _wrong_nodes(nodes)
        or _wrong_numbers(nodes, triangles)
        or _wrong_bodies(body, body_names)
        or _wrong_areas(nodes, triangles)
        or _wrong_neighbours(len(nodes), triangles)
        or _wrong_sets(len(nodes), triangles, edge_sets)
    )


def coincident(nodes: np.ndarray, triangles: np.ndarray, share: float) -> tuple[int, int] | None:
    """Two boundary nodes, from 0, closer than `share` of the shortest edge; None without."""
    from scipy.spatial import cKDTree

    start, end, _ = _sides(triangles)
    shortest = np.hypot(*(nodes[end] - nodes[start]).T).min()
    boundary = np.unique(start[_is_boundary(len(nodes), start, end)])
    pairs = cKDTree(nodes[boundary]).query_pairs(share * shortest, output_type="ndarray")
    if not len(pairs):
        return None
    first, second = boundary[pairs[np.lexsort(pairs.T[::-1])][0]]
    return int(first), int(second)


def wrong_shapes(
    nodes: np.ndarray, triangles: np.ndarray, body: np.ndarray, edge_sets: Arrays
) -> str:
    """Arrays of the wrong kind, shape or size."""
    columns = {"triangles": (triangles, 3)}
    columns |= {f"edges:{name}": (edges, 2) for name, edges in edge_sets.items()}
    if nodes.dtype.kind != "f" or nodes.ndim != 2 or nodes.shape[1] != 2:
        return f"nodes are {_kind(nodes)}, expected numbers of shape (n, 2)"
    for name, (array, width) in columns.items():
        if array.dtype.kind != "i" or array.ndim != 2 or array.shape[1] != width:
            return f"{name} are {_kind(array)}, expected whole numbers of shape (n, {width})"
    if body.dtype.kind != "i" or body.shape != triangles.shape[:1]:
        return f"body is {_kind(body)}, expected one whole number for each triangle"
    if len(nodes) < 3 or len(triangles) < 1:
        return "holds no triangle, expected at least one of three nodes"
    return ""


def _kind(array: np.ndarray) -> str:
    return f"{array.dtype} of shape {array.shape}"


def _wrong_nodes(nodes: np.ndarray) -> str:
    bad = ~np.isfinite(nodes).all(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        return f"node {i + 1} is at ({nodes[i, 0]:g}, {nodes[i, 1]:g}), expected finite numbers"
    far = np.abs(nodes).max(axis=1)
    if far.max() > FARTHEST:
        i = int(np.argmax(far))
        return f"node {i + 1} is {far[i]:g} m from the origin, expected at most {FARTHEST:g} m"
    return ""


def _wrong_numbers(nodes: np.ndarray, triangles: np.ndarray) -> str:
    n = len(nodes)
    bad = (triangles < 0) | (triangles >= n)
    if bad.any():
        i, k = np.argwhere(bad)[0]
        return f"element {i + 1} names node {int(triangles[i, k]) + 1}, expected 1 to {n}"
    used = np.zeros(n, dtype=bool)
    used[triangles] = True
    if not used.all():
        return f"node {int(np.argmin(used)) + 1} belongs to no element"
    return ""


def _wrong_bodies(body: np.ndarray, names: tuple[str, ...]) -> str:
    if len(set(names)) != len(names) or not names:
        return f"bodies are named {', '.join(names) or 'nothing'}, expected a name for each"
    bad = (body < 0) | (body >= len(names))
    if bad.any():
        i = int(np.argmax(bad))
        return f"element {i + 1} is of body {int(body[i]) + 1}, expected 1 to {len(names)}"
    empty = np.setdiff1d(np.arange(len(names)), body)
    return f"body {names[empty[0]]!r} has no element" if len(empty) else ""


def _wrong_areas(nodes: np.ndarray, triangles: np.ndarray) -> str:
    a, b, c = (nodes[triangles[:, i]] for i in range(3))
    ab, ac, bc = b - a, c - a, c - b
    twice = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    longest = np.maximum.reduce([(edge**2).sum(axis=1) for edge in (ab, ac, bc)])
    bad = ~(twice > FLAT * longest)
    if not bad.any():
        return ""
    i = int(np.argmax(bad))
    what = "clockwise" if twice[i] < -FLAT * longest[i] else "flat"
    return (
        f"element {i + 1} is {what}, area {0.5 * twice[i]:g} m2, expected its nodes "
        "counter-clockwise around a positive area"
    )


def _sides(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start and end node and element of every side, counter-clockwise, (3 m,) each."""
    t = triangles.astype(np.int64)
    element = np.tile(np.arange(len(t)), 3)
    return t.T.ravel(), np.roll(t, -1, axis=1).T.ravel(), element


def _is_boundary(n: int, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    return ~np.isin(start * n + end, end * n + start)


def _wrong_neighbours(n: int, triangles: np.ndarray) -> str:
    start, end, element = _sides(triangles)
    key = start * n + end
    order = np.argsort(key, kind="stable")
    twice = np.flatnonzero(key[order][1:] == key[order][:-1])
    if len(twice):
        i, j = order[twice[0]], order[twice[0] + 1]
        first, second = sorted((int(element[i]) + 1, int(element[j]) + 1))
        return (
            f"elements {first} and {second} lie on the same side of edge {start[i] + 1} - "
            f"{end[i] + 1}, expected one on each side"
        )
    leaving = np.bincount(start[_is_boundary(n, start, end)], minlength=n)
    if leaving.max() > 1:
        return (
            f"node {int(np.argmax(leaving)) + 1} joins parts that share no edge, expected a node "
            "of its own in each"
        )
    return ""


def _wrong_sets(n: int, triangles: np.ndarray, edge_sets: Arrays) -> str:
    start, end, _ = _sides(triangles)
    sides = start * n + end
    for name, edges in edge_sets.items():
        bad = ((edges < 0) | (edges >= n)).any(axis=1)
        whole = np.where(bad[:, None], 0, edges.astype(np.int64))
        bad |= ~np.isin(whole[:, 0] * n + whole[:, 1], sides)
        if bad.any():
            a, b = edges[int(np.argmax(bad))]
            return (
                f"edge set {name!r} names {int(a) + 1} - {int(b) + 1}, expected a side of an "
                "element, which lies on its left"
            )
    return ""
