"""The boundary of a mesh (fortran/contact/surfaces.f90)."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import cut_all_edges, split
from models import rectangle

from lithofrac.errors import CoreError
from lithofrac.kernels import boundary_of


def loop_from(following, start):
    """Nodes of the boundary loop that `start` is on."""
    loop, node = [start], following[start]
    while node != start:
        loop.append(node)
        node = following[node]
    return loop


def test_a_rectangle_is_one_loop_with_material_on_its_left():
    mesh = rectangle(5, 3, jitter=0.2)
    following, shortest = boundary_of(mesh)
    assert len(loop_from(following, 0)) == np.count_nonzero(following >= 0) == 2 * (5 + 3)
    assert shortest == pytest.approx(1 / 5)
    for edges in mesh.edge_sets.values():
        np.testing.assert_array_equal(following[edges[:, 0]], edges[:, 1])


def test_a_split_gives_each_part_its_own_loop():
    mesh = rectangle(4, 4)
    parts = split(mesh, (mesh.centroids()[:, 0] > 0.5).astype(int))
    following, _ = boundary_of(parts)
    assert np.count_nonzero(following >= 0) == 2 * 2 * (2 + 4)


def test_single_triangles_are_loops_of_three():
    mesh = cut_all_edges(rectangle(3, 3))
    following, _ = boundary_of(mesh)
    assert all(len(loop_from(following, node)) == 3 for node in range(len(mesh.nodes)))


def test_parts_that_share_only_a_node_are_refused():
    nodes = np.array([[0.0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]])
    mesh = replace(rectangle(1, 1), nodes=nodes, triangles=np.array([[0, 1, 2], [0, 3, 4]]))
    with pytest.raises(CoreError, match="node 1 joins two parts by a point only"):
        boundary_of(mesh)
