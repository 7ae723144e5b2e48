"""Mesh of a rectangle with the edge sets bottom, right, top and left."""

import numpy as np

from lithofrac.problem import Mesh
from lithofrac.scenes._finish import finished
from lithofrac.scenes._gmsh import mesh_from
from lithofrac.scenes._relax import relaxed
from lithofrac.scenes._size import jittered

SHIFT = 0.1  # of an element, by which seeds above 1 move inner nodes of a structured mesh


def rectangle(width: float, height: float, size: float, structured: bool, seed: int) -> Mesh:
    """Triangles on (0, width) x (0, height).

    Parameters
    ----------
    width, height : extents [m]
    size : nominal edge length [m]
    structured : equal right-angled triangles instead of an unstructured mesh
    seed : realisation
    """
    if structured:
        return _structured(width, height, size, seed)
    raw = mesh_from(
        f"""\
Point(1) = {{0, 0, 0}};
Point(2) = {{{width!r}, 0, 0}};
Point(3) = {{{width!r}, {height!r}, 0}};
Point(4) = {{0, {height!r}, 0}};
Line(1) = {{1, 2}};
Line(2) = {{2, 3}};
Line(3) = {{3, 4}};
Line(4) = {{4, 1}};
Curve Loop(1) = {{1, 2, 3, 4}};
Plane Surface(1) = {{1}};
Physical Curve("bottom") = {{1}};
Physical Curve("right") = {{2}};
Physical Curve("top") = {{3}};
Physical Curve("left") = {{4}};
Physical Surface("rock") = {{1}};
{jittered(repr(size), size, seed)}"""
    )
    boundary = np.unique(np.concatenate(list(raw.lines.values())))
    nodes = relaxed(raw.nodes, raw.triangles, boundary)
    return finished(nodes, raw.triangles, raw.lines, raw.body, raw.body_names)


def _structured(width: float, height: float, size: float, seed: int) -> Mesh:
    columns, rows = max(1, round(width / size)), max(1, round(height / size))
    x, y = np.meshgrid(np.linspace(0, width, columns + 1), np.linspace(0, height, rows + 1))
    nodes = np.column_stack([x.ravel(), y.ravel()])
    number = np.arange(len(nodes)).reshape(rows + 1, columns + 1)
    if seed > 1:
        inner = number[1:-1, 1:-1].ravel()
        random = np.random.default_rng(seed).uniform(-1, 1, (len(inner), 2))
        nodes[inner] += SHIFT * np.array([width / columns, height / rows]) * random
    a, b = number[:-1, :-1], number[:-1, 1:]
    d, c = number[1:, :-1], number[1:, 1:]
    even = np.indices(a.shape).sum(axis=0) % 2 == 0  # diagonals alternate: no favoured direction
    first = np.where(even[..., None], np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    second = np.where(even[..., None], np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    triangles = np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])
    lines = {
        "bottom": _chain(number[0]),
        "right": _chain(number[:, -1]),
        "top": _chain(number[-1]),
        "left": _chain(number[:, 0]),
    }
    return finished(nodes, triangles, lines)


def _chain(nodes: np.ndarray) -> np.ndarray:
    return np.column_stack([nodes[:-1], nodes[1:]])
