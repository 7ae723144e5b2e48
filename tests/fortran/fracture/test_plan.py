"""Order and choice of cracks (fortran/fracture/plan.f90)."""

import numpy as np
import pytest

from lithofrac.topology import Topology

UPRIGHT = np.array([-1.0, 0.0])  # softening along y: cracks along x


def number(i, j):
    return 7 * j + i


def around(mesh, *nodes):
    """Elements that have one of the nodes."""
    return np.isin(mesh[1], nodes).any(axis=1)


def plan(mesh, factor, normal=UPRIGHT, **options):
    topology = mesh if isinstance(mesh, Topology) else Topology(*mesh)
    return topology.plan(factor, np.broadcast_to(normal, (topology.n_elements, 2)), **options)


def nodes_of(planned):
    return [crack.node for crack in planned.cracks]


def random_failure(n, rng):
    """Factors of which some pass 1, and directions."""
    angle = rng.uniform(0, 2 * np.pi, n)
    return rng.uniform(0, 2.5, n), np.column_stack([np.cos(angle), np.sin(angle)])


def test_nothing_is_planned_below_failure(lattice):
    factor = np.where(around(lattice, 24), 1 - 1e-12, 0.0)
    assert plan(lattice, factor) == ([], 0, 0)


def test_node_at_failure_is_planned(lattice):
    factor = np.where(around(lattice, 24), 1 + 1e-12, 0.0)
    planned = plan(lattice, factor)
    assert nodes_of(planned) == [24]
    assert planned.cracks[0].factor == pytest.approx(1.0)
    assert [s for _, _, s in planned.cracks[0].arms] == [None, None]


def test_failure_out_of_the_plane_alone_is_no_crack(lattice):
    assert plan(lattice, np.full(72, 2.0), [0.0, 0.0]) == ([], 0, 0)


def test_the_most_failed_node_goes_first(lattice):
    factor = np.where(around(lattice, number(1, 1)), 1.2, 0.0)
    factor = np.where(around(lattice, number(4, 4)), 1.5, factor)
    planned = plan(lattice, factor)
    assert nodes_of(planned)[:2] == [number(4, 4), number(1, 1)]
    factors = [crack.factor for crack in planned.cracks]
    assert factors == sorted(factors, reverse=True)


def test_of_equal_nodes_the_lowest_goes_first(lattice):
    planned = plan(lattice, np.ones(72))
    assert nodes_of(planned) == sorted(nodes_of(planned))
    assert len(nodes_of(planned)) > 3


def test_a_crack_locks_the_nodes_around_it(lattice):
    """(3, 3) locks its six neighbours, but not the nodes behind them."""
    behind = number(5, 3), number(1, 3)
    factor = np.where(around(lattice, 24), 4.0, np.where(around(lattice, *behind), 2.0, 1.1))
    planned = nodes_of(plan(lattice, factor))
    assert planned[0] == 24
    locked = {number(*ij) for ij in [(4, 3), (3, 4), (2, 4), (2, 3), (3, 2), (4, 2)]}
    assert not locked & set(planned)
    assert set(behind) <= set(planned)


def test_no_element_is_touched_twice(rough_lattice):
    rng = np.random.default_rng(4)
    for mode in ("inter", "intra"):
        for _ in range(50):
            topology = Topology(*rough_lattice)
            planned = plan(topology, *random_failure(72, rng), mode=mode)
            neighbours = topology.state().neighbours
            touched = []
            for crack in planned.cracks:
                touched += list(topology.fan(crack.node)[0])
                touched += [neighbours[e, k] for e, k, s in crack.arms if s is not None]
            touched = [element for element in touched if element >= 0]
            assert len(touched) == len(set(touched))


def test_a_crack_through_an_element_locks_the_far_node_as_well(lattice):
    """Upwards from (3, 3) the crack cuts an element that ends at (2, 5)."""
    factor = np.where(around(lattice, 24), 3.0, 0.0)
    factor[around(lattice, number(2, 5))] = 1.5
    free = nodes_of(plan(lattice, factor, [1.0, 0.0], mode="inter"))
    locked = nodes_of(plan(lattice, factor, [1.0, 0.0], mode="intra"))
    assert free[0] == locked[0] == 24
    assert number(2, 5) in free
    assert number(2, 5) not in locked


def test_failed_nodes_are_all_accounted_for(lattice):
    """On the bottom and the top, cracks along the boundary have no way."""
    planned = plan(lattice, np.ones(72))
    assert len(planned.cracks) + planned.waiting + planned.closed == 49
    assert planned.closed >= 10


def test_the_number_of_cracks_is_limited_to_the_first(lattice):
    factor = np.random.default_rng(5).uniform(1, 2, 72)
    everything = plan(lattice, factor)
    three = plan(lattice, factor, most=3)
    assert three.cracks == everything.cracks[:3]
    assert 3 + three.waiting + three.closed == 49


def test_planning_changes_nothing_and_says_the_same_twice(rough_lattice):
    topology = Topology(*rough_lattice)
    failure = random_failure(72, np.random.default_rng(6))
    first = plan(topology, *failure, mode="intra")
    assert plan(topology, *failure, mode="intra") == first
    assert topology.changes == 0


@pytest.mark.parametrize("mode", ["inter", "intra"])
@pytest.mark.parametrize("weights", ["volume", "failure_factor"])
def test_all_that_is_planned_can_be_done(rough_lattice, mode, weights, n_random):
    """Crack after crack until the lattice is rubble; what is cut inherits the state."""
    rng = np.random.default_rng(7)
    done = 0
    for _ in range(n_random(60, 5)):
        topology = Topology(*rough_lattice)
        factor, normal = random_failure(72, rng)
        for _ in range(8):
            planned = topology.plan(factor, normal, mode=mode, weights=weights)
            for crack in planned.cracks:
                assert topology.open(crack.arms) == "sound"
                parents = topology.edits().element_parent
                factor = np.concatenate([factor, factor[parents]])
                normal = np.concatenate([normal, normal[parents]])
                done += 1
            topology.check()
    assert done > 5


def test_numbering_does_not_matter(rough_lattice):
    """Without ties, the same cracks in the same order."""
    nodes, triangles = rough_lattice
    rng = np.random.default_rng(8)
    for mode in ("inter", "intra"):
        factor, normal = random_failure(72, rng)
        planned = plan((nodes, triangles), factor, normal, mode=mode)
        new_node, order = rng.permutation(49), rng.permutation(72)
        start = rng.integers(0, 3, 72)
        moved = np.empty_like(nodes)
        moved[new_node] = nodes
        again = new_node[triangles[order]]
        again = np.take_along_axis(again, (start[:, None] + np.arange(3)) % 3, axis=1)
        other = plan((moved, again), factor[order], normal[order], mode=mode)
        assert [c.node for c in other.cracks] == [new_node[c.node] for c in planned.cracks]
        assert (other.waiting, other.closed) == (planned.waiting, planned.closed)
        for here, there in zip(planned.cracks, other.cracks, strict=True):
            assert {middle(nodes, triangles, arm) for arm in here.arms} == {
                middle(moved, again, arm) for arm in there.arms
            }


@pytest.mark.parametrize("angle", [0.4, np.pi / 2, 3.0])
@pytest.mark.parametrize("mode", ["inter", "intra"])
def test_turning_the_model_does_not_matter(rough_lattice, mode, angle):
    nodes, triangles = rough_lattice
    factor, normal = random_failure(72, np.random.default_rng(9))
    planned = plan((nodes, triangles), factor, normal, mode=mode)
    rotate, rotate_twice = (
        np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]) for a in (angle, 2 * angle)
    )
    turned = plan((nodes @ rotate, triangles), factor, normal @ rotate_twice, mode=mode)
    assert nodes_of(turned) == nodes_of(planned)
    for here, there in zip(planned.cracks, turned.cracks, strict=True):
        rounded = [
            sorted((e, k, -1.0 if s is None else round(s, 9)) for e, k, s in crack.arms)
            for crack in (here, there)
        ]
        assert rounded[0] == rounded[1]


def middle(nodes, triangles, arm):
    """A point by which an arm is known: where it cuts an edge, or the middle of its edge."""
    element, edge, s = arm
    a, b = nodes[triangles[element][[edge, (edge + 1) % 3]]]
    return tuple(np.round(a + (0.5 if s is None else s) * (b - a), 9))
