"""One crack band, one crack (fortran/fracture/one_band.f90)."""

import numpy as np
import pytest

from lithofrac.topology import Topology

ALONG, ACROSS = np.array([-1.0, 0.0]), np.array([1.0, 0.0])  # doubled angle of the softening


def number(i, j):
    return 7 * j + i


@pytest.fixture
def cracked(lattice):
    """The lattice with a crack along x from (2, 3) to (4, 3)."""
    topology = Topology(*lattice)
    topology.crack([number(3, 3)], [[1.0, 0.0]])
    assert topology.n_nodes == 50
    return topology


def planned(topology, node, normal, lattice):
    """Is a crack planned at a node whose elements alone have failed?"""
    factor = np.where(np.isin(lattice[1], node).any(axis=1), 1.1, 0.0)
    plan = topology.plan(factor, np.broadcast_to(normal, (topology.n_elements, 2)))
    assert len(plan.cracks) + plan.closed == 1
    return [crack.node for crack in plan.cracks] == [node]


@pytest.mark.parametrize("beside", [(3, 4), (2, 4), (3, 2), (4, 2)])
def test_no_crack_begins_beside_a_parallel_one(lattice, cracked, beside):
    assert planned(Topology(*lattice), number(*beside), ALONG, lattice)
    assert not planned(cracked, number(*beside), ALONG, lattice)


def test_a_crack_across_another_may_begin_beside_it(lattice, cracked):
    assert planned(cracked, number(3, 4), ACROSS, lattice)


def test_two_elements_away_a_parallel_crack_may_begin(lattice, cracked):
    assert planned(cracked, number(2, 5), ALONG, lattice)


def test_the_outer_boundary_is_no_crack(lattice):
    assert planned(Topology(*lattice), number(3, 1), ALONG, lattice)


def test_the_crack_itself_runs_on(lattice, cracked):
    assert planned(cracked, number(4, 3), ALONG, lattice)
