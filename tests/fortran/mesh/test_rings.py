"""Fans and boundaries (fortran/mesh/rings.f90)."""

import numpy as np
import pytest

from lithofrac.errors import CoreError
from lithofrac.topology import Topology


def test_fan_of_an_inner_node_is_closed_and_starts_at_its_lowest_element(hexagon):
    nodes, triangles = hexagon
    order = [3, 5, 0, 2, 4, 1]  # element 2 of the new list is the old 0, and so on
    elements, rim, closed = Topology(nodes, triangles[order]).fan(0)
    assert closed
    start = order[elements[0]]
    assert elements[0] == 0
    np.testing.assert_array_equal(np.array(order)[elements], (start + np.arange(6)) % 6)
    np.testing.assert_array_equal(rim, 1 + (start + np.arange(7)) % 6)


def test_fan_of_a_boundary_node_runs_counter_clockwise_from_boundary_to_boundary(hexagon):
    nodes, triangles = hexagon
    elements, rim, closed = Topology(nodes, triangles).fan(2)
    assert not closed
    np.testing.assert_array_equal(elements, [1, 0])
    np.testing.assert_array_equal(rim, [3, 0, 1])


def test_fan_of_a_crack_tip_is_open_and_has_all_elements(hexagon):
    topology = Topology(*hexagon)
    topology.split([[1, 0]])  # the spoke to node 2
    elements, rim, closed = topology.fan(0)
    assert not closed
    np.testing.assert_array_equal(elements, [1, 2, 3, 4, 5, 0])
    assert rim[0] != rim[-1]
    assert {rim[0], rim[-1]} == {2, 7}


def test_boundary_has_its_material_on_the_left(hexagon):
    before, after = Topology(*hexagon).boundary()
    np.testing.assert_array_equal(after, [-1, 2, 3, 4, 5, 6, 1])
    np.testing.assert_array_equal(before, [-1, 6, 1, 2, 3, 4, 5])


def test_boundary_runs_forth_and_back_along_a_closed_cut(patches):
    """Both ends of a lone inner cut stay single: a loop of two nodes, and no opening."""
    nodes, triangles, _, _ = patches(1, 5, jitter=0.0)
    topology = Topology(nodes, triangles)
    inner = ((nodes > 0) & (nodes < 5)).all(axis=1)
    element, edge = next(
        (e, k)
        for e, t in enumerate(triangles)
        for k in range(3)
        if inner[t[k]] and inner[t[(k + 1) % 3]]
    )
    a, b = triangles[element][[edge, (edge + 1) % 3]]
    topology.split([[element, edge]])
    before, after = topology.boundary()
    assert topology.n_nodes == len(nodes)
    assert after[a] == before[a] == b
    assert after[b] == before[b] == a


def test_long_fan_is_told_by_its_count(hexagon):
    elements, _, _ = Topology(*hexagon).fan(0, capacity=3)
    assert len(elements) == 3


def test_node_that_does_not_exist_is_refused(hexagon):
    with pytest.raises(CoreError, match="no such node"):
        Topology(*hexagon).fan(7)
