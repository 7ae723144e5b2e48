"""Invariants in words (fortran/mesh/check.f90): each is broken once, by hand."""

import numpy as np
import pytest

from lithofrac.errors import CoreError
from lithofrac.topology import Topology


@pytest.fixture
def state(hexagon):
    """Arrays of a good topology, free to be spoilt."""
    return Topology(*hexagon).state()


def check(state, **changes):
    Topology.load(state._replace(**changes)).check()


def test_good_arrays_pass(state):
    check(state)


def test_element_turned_over_is_found(state):
    state.triangles[2] = state.triangles[2][[0, 2, 1]]
    with pytest.raises(CoreError, match="element 3 has no positive area"):
        check(state)


def test_position_that_is_no_number_is_found(state):
    state.nodes[3] = np.nan
    with pytest.raises(CoreError, match="element 2 has no positive area"):
        check(state)


def test_node_out_of_range_is_found(state):
    state.triangles[4, 1] = 7
    with pytest.raises(CoreError, match="element 5 names a node that does not exist"):
        check(state)


def test_neighbour_out_of_range_is_found(state):
    state.neighbours[1, 1] = 6
    with pytest.raises(CoreError, match="element 2 has a neighbour 7 that does not exist"):
        check(state)


def test_one_sided_link_is_found(state):
    state.neighbours[1, 0] = -1
    with pytest.raises(CoreError, match="element 2 is a neighbour of 1 but not the other way"):
        check(state)


@pytest.mark.parametrize("edge", [0, 1])
def test_link_without_a_common_edge_is_found(state, edge):
    state.neighbours[0, edge] = 3
    with pytest.raises(CoreError, match="neighbours 1 and 4 share no edge"):
        check(state)


def test_link_to_a_retired_element_is_found(state):
    state.alive[1] = False
    with pytest.raises(CoreError, match="element 1 has a retired neighbour 2"):
        check(state)


def test_node_without_elements_is_found(state):
    check_nodes = np.vstack([state.nodes, [5.0, 5.0]])
    with pytest.raises(CoreError, match="node 8 belongs to no element"):
        check(state, nodes=check_nodes, element_at=np.append(state.element_at, 0))


def test_node_that_does_not_know_its_lowest_element_is_found(state):
    state.element_at[0] = 2
    with pytest.raises(CoreError, match="node 1 does not sit in its lowest element 1"):
        check(state)


def test_node_that_two_boundaries_share_is_found(state):
    """Links cut across two spokes, the node in the middle left in one piece."""
    state.neighbours[[0, 5, 3, 2], [0, 2, 0, 2]] = -1
    with pytest.raises(CoreError, match="the boundary at node 1 is no simple loop"):
        check(state)


def test_node_that_two_closed_fans_share_is_found(state):
    """Two hexagons on top of each other have boundaries in order, but one node too few."""
    twin = np.where(state.triangles > 0, state.triangles + 6, 0)
    links = np.where(state.neighbours >= 0, state.neighbours + 6, -1)
    with pytest.raises(CoreError, match="node 1 joins parts that share no edge"):
        check(
            state,
            nodes=np.vstack([state.nodes, state.nodes[1:]]),
            triangles=np.vstack([state.triangles, twin]),
            neighbours=np.vstack([state.neighbours, links]),
            origin=np.arange(12),
            alive=np.ones(12, dtype=bool),
            element_at=np.concatenate([state.element_at, state.element_at[1:] + 6]),
        )
