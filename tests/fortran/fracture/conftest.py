"""Meshes to crack: a regular lattice and its numbers."""

import numpy as np
import pytest


@pytest.fixture(scope="session")
def lattice():
    """Rhombus of equilateral triangles: node (i, j) is number 7 j + i, at i e_0 + j e_60.

    Inner nodes have spokes at 0, 60, ... 300 degrees; nodes on the bottom have them at 0, 60,
    120 and 180 degrees.
    """
    i, j = (index.ravel() for index in np.meshgrid(np.arange(7), np.arange(7)))
    nodes = np.column_stack([i + 0.5 * j, np.sqrt(3) / 2 * j])
    a = (7 * j + i)[(i < 6) & (j < 6)]
    triangles = np.stack([[a, a + 1, a + 7], [a + 1, a + 8, a + 7]]).transpose(2, 0, 1)
    return nodes, triangles.reshape(-1, 3)


@pytest.fixture(scope="session")
def rough_lattice(lattice):
    """The same with inner nodes moved at random, so that nothing is equal by chance."""
    nodes, triangles = lattice
    i, j = np.arange(49) % 7, np.arange(49) // 7
    inside = (i > 0) & (i < 6) & (j > 0) & (j < 6)
    moved = nodes.copy()
    moved[inside] += np.random.default_rng(1).uniform(-0.2, 0.2, (inside.sum(), 2))
    return moved, triangles


@pytest.fixture
def hexagon():
    """Node 0 in the middle of nodes 1 to 6; element i between spokes to nodes i + 1 and i + 2."""
    angles = np.arange(6) * np.pi / 3
    nodes = np.vstack([[0.0, 0.0], np.column_stack([np.cos(angles), np.sin(angles)])])
    triangles = np.array([[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)])
    return nodes, triangles
