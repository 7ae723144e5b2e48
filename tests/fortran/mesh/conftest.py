"""Meshes to cut: many small patches at once, and one hexagon."""

import numpy as np
import pytest


@pytest.fixture(scope="session")
def patches():
    """patches(n, side, jitter=0.2, seed=1) -> nodes, triangles, patch of each node and element.

    One mesh of `n` separate squares of side x side cells, each cell halved by a random diagonal,
    inner nodes moved by up to `jitter`: one call of the core serves all.
    """

    def made(n, side, jitter=0.2, seed=1):
        rng = np.random.default_rng(seed)
        x, y = np.meshgrid(np.arange(side + 1), np.arange(side + 1))
        base = np.column_stack([x.ravel(), y.ravel()]).astype(float)
        i, j = (index.ravel() for index in np.meshgrid(np.arange(side), np.arange(side)))
        a = j * (side + 1) + i
        b, c, d = a + 1, a + side + 2, a + side + 1
        rising = rng.random((n, side * side, 1)) < 0.5
        first = np.where(rising, np.stack([a, b, c], -1), np.stack([a, b, d], -1))
        second = np.where(rising, np.stack([a, c, d], -1), np.stack([b, c, d], -1))
        local = np.stack([first, second], axis=2).reshape(n, -1, 3)
        triangles = local + (np.arange(n) * len(base))[:, None, None]
        inside = ((base > 0) & (base < side)).all(axis=1)
        nodes = np.tile(base, (n, 1, 1))
        nodes[:, inside] += jitter * rng.uniform(-1, 1, (n, inside.sum(), 2))
        return (
            nodes.reshape(-1, 2),
            triangles.reshape(-1, 3),
            np.repeat(np.arange(n), len(base)),
            np.repeat(np.arange(n), local.shape[1]),
        )

    return made


@pytest.fixture
def hexagon():
    """Node 0 in the middle of nodes 1 to 6; element i between spokes to nodes i + 1 and i + 2."""
    angles = np.arange(6) * np.pi / 3
    nodes = np.vstack([[0.0, 0.0], np.column_stack([np.cos(angles), np.sin(angles)])])
    triangles = np.array([[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)])
    return nodes, triangles
