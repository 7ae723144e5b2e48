"""Neighbours (fortran/mesh/topology.f90)."""

import numpy as np
import pytest

from lithofrac.errors import CoreError
from lithofrac.topology import Topology


def test_two_triangles_are_neighbours_over_their_common_edge():
    state = Topology([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]]).state()
    np.testing.assert_array_equal(state.neighbours, [[-1, -1, 1], [0, -1, -1]])
    np.testing.assert_array_equal(state.element_at, [0, 0, 0, 1])
    np.testing.assert_array_equal(state.origin, [0, 1])
    assert state.alive.all()


def test_neighbours_share_exactly_the_edge_they_are_listed_at(patches):
    nodes, triangles, _, _ = patches(50, 6)
    neighbours = Topology(nodes, triangles).state().neighbours
    corners = {}
    for element, triangle in enumerate(triangles):
        for k in range(3):
            corners[triangle[k], triangle[(k + 1) % 3]] = element
    expected = [[corners.get((t[(k + 1) % 3], t[k]), -1) for k in range(3)] for t in triangles]
    np.testing.assert_array_equal(neighbours, expected)


def test_a_whole_mesh_holds_all_invariants(patches):
    nodes, triangles, _, _ = patches(50, 6)
    Topology(nodes, triangles).check()


def test_bodies_that_touch_without_common_nodes_are_not_linked():
    nodes = [[0, 0], [1, 0], [0, 1], [1, 0], [1, 1], [0, 1]]
    topology = Topology(nodes, [[0, 1, 2], [3, 4, 5]], body=[0, 1])
    assert (topology.state().neighbours == -1).all()
    topology.check()


def test_elements_on_one_side_of_an_edge_are_refused():
    nodes = [[0, 0], [1, 0], [0, 1], [0.5, 2]]
    with pytest.raises(CoreError, match="elements 1 and 2 lie on the same side of edge 1 - 2"):
        Topology(nodes, [[0, 1, 2], [0, 1, 3]])


def test_parts_that_hang_together_by_a_node_are_refused():
    nodes = [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]]
    with pytest.raises(CoreError, match="node 1 joins parts that share no edge"):
        Topology(nodes, [[0, 1, 2], [0, 3, 4]])


def test_a_mesh_that_is_none_is_refused():
    with pytest.raises(CoreError, match="no positive area"):
        Topology([[0, 0], [1, 0], [0, 1]], [[0, 2, 1]])


def test_a_hundred_meshes_can_come_and_go():
    for _ in range(100):
        Topology([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])


def test_more_meshes_at_a_time_than_there_is_room_for_are_refused():
    with pytest.raises(CoreError, match="too many meshes"):
        [Topology([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]) for _ in range(100)]
