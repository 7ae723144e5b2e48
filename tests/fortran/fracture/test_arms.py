"""Which way a crack leaves its node (fortran/fracture/arms.f90)."""

import numpy as np
import pytest

from lithofrac.topology import Guard, Topology

CENTRE = 24  # node (3, 3) of the lattice
BOTTOM = 3


def number(i, j):
    return 7 * j + i


def unit(degrees):
    angle = np.radians(degrees)
    return np.array([np.cos(angle), np.sin(angle)])


def cracked(mesh, node, degrees, mode="inter", guard=None):
    """Crack one node; returns the topology."""
    topology = mesh if isinstance(mesh, Topology) else Topology(*mesh)
    topology.crack(node, unit(degrees), mode, guard)
    topology.check()
    return topology


def faces(topology):
    """Cut edges as sets of two positions, rounded."""
    state = topology.state()
    triangles = state.triangles
    found = []
    for element, edge, _, _ in topology.edits().opened:
        ends = state.nodes[triangles[element][[edge, (edge + 1) % 3]]]
        found.append({tuple(np.round(end, 6) + 0.0) for end in ends})
    return found


def spokes(mesh, node, *far):
    """The edges from a node to others, as `faces` gives them."""
    at = [tuple(position) for position in np.round(mesh[0], 6) + 0.0]
    return [{at[node], at[other]} for other in far]


def same(found, expected):
    return len(found) == len(expected) and all(face in expected for face in found)


@pytest.mark.parametrize("sense", [0, 180])
@pytest.mark.parametrize(
    ("degrees", "far"),
    [
        (10, [(4, 3), (2, 3)]),
        (50, [(3, 4), (3, 2)]),
        (130, [(2, 4), (4, 2)]),
        (-20, [(4, 3), (2, 3)]),
    ],
)
def test_inner_node_opens_the_two_nearest_edges(lattice, degrees, far, sense):
    topology = cracked(lattice, CENTRE, degrees + sense)
    assert same(faces(topology), spokes(lattice, CENTRE, *(number(*f) for f in far)))
    assert topology.n_nodes == 50


def test_arms_of_an_inner_node_are_60_degrees_apart():
    """Nearest to 0 and 180 degrees are the spokes at 85 and 100, only 15 degrees apart."""
    nodes = np.array([[0.0, 0.0], *(unit(a) for a in (85, 100, 262, 274))])
    mesh = nodes, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
    assert same(faces(cracked(mesh, 0, 0)), spokes(mesh, 0, 2, 4))


def test_of_equal_pairs_the_straight_one_with_the_lowest_node_is_taken(lattice):
    """30 degrees lies half way between the spokes at 0 and 60."""
    expected = spokes(lattice, CENTRE, number(3, 4), number(3, 2))
    assert same(faces(cracked(lattice, CENTRE, 30)), expected)


def test_of_equal_edges_the_one_to_a_crack_tip_is_taken(lattice):
    topology = Topology(*lattice)
    element = next(
        e for e, t in enumerate(lattice[1]) if t[0] == number(4, 3) and t[1] == number(5, 3)
    )
    topology.split([[element, 0]])  # closed, with a tip at (4, 3)
    cracked(topology, CENTRE, 30)
    expected = spokes(lattice, CENTRE, number(4, 3), number(2, 3))
    assert same(faces(topology), expected)


@pytest.mark.parametrize(("degrees", "far"), [(80, (3, 1)), (100, (2, 1)), (20, (3, 1))])
def test_boundary_node_opens_one_edge(lattice, degrees, far):
    topology = cracked(lattice, BOTTOM, degrees)
    assert same(faces(topology), spokes(lattice, BOTTOM, number(*far)))
    assert topology.n_nodes == 50


@pytest.mark.parametrize("degrees", [0, 10, 170, 180])
def test_a_crack_along_the_boundary_is_none(lattice, degrees):
    assert cracked(lattice, BOTTOM, degrees).changes == 0


@pytest.mark.parametrize(
    ("degrees", "far"), [(175, (4, 3)), (40, (3, 4)), (-140, (3, 4)), (140, (4, 2))]
)
def test_crack_tip_goes_on_ahead_and_not_back(lattice, degrees, far):
    topology = Topology(*lattice)
    row = [
        [e, list(t).index(number(i, 3))]
        for i in range(3)
        for e, t in enumerate(lattice[1])
        if number(i, 3) in t and t[(list(t).index(number(i, 3)) + 1) % 3] == number(i + 1, 3)
    ]
    topology.split(row)  # from the left boundary to the centre
    assert topology.n_nodes == 49 + 3
    cracked(topology, CENTRE, degrees)
    assert same(faces(topology), spokes(lattice, CENTRE, number(*far)))
    assert topology.n_nodes == 49 + 4


def test_corner_of_one_element_has_no_edge_to_open(lattice):
    assert cracked(lattice, 0, 30).changes == 0


def test_corner_of_one_element_may_be_cut_through(lattice):
    topology = cracked(lattice, 0, 30, "intra")
    assert same(faces(topology), [{(0.0, 0.0), (0.75, 0.433013)}])


def test_crack_through_elements_follows_its_direction(lattice):
    """33 degrees from the centre of the lattice: through both elements, exactly."""
    topology = cracked(lattice, CENTRE, 33, "intra", Guard(least_step=0.3))
    assert (~topology.state().alive).sum() == 4
    ends = np.array([end for face in faces(topology) for end in face])
    offset = ends - lattice[0][CENTRE]
    assert abs(offset @ unit(123)).max() < 1e-6
    assert topology.n_nodes == 49 + 3


@pytest.mark.parametrize("degrees", [5, 12])
def test_crack_near_an_edge_snaps_to_it(lattice, degrees):
    """At 12 degrees the far edge is met at s = 0.21."""
    topology = cracked(lattice, CENTRE, degrees, "intra", Guard(least_step=0.0))
    assert topology.state().alive.all()
    assert same(faces(topology), spokes(lattice, CENTRE, number(4, 3), number(2, 3)))


def test_crack_that_would_lower_the_time_step_snaps_to_the_nearer_edge(lattice):
    """At s = 0.3 a child would have about 0.3 of the step."""
    degrees = np.degrees(np.arctan2(0.3 * np.sqrt(3) / 2, 1 - 0.3 / 2))
    free = cracked(lattice, CENTRE, degrees, "intra", Guard(least_step=0.2))
    assert not free.state().alive.all()
    held = cracked(lattice, CENTRE, degrees, "intra", Guard())
    assert same(faces(held), spokes(lattice, CENTRE, number(4, 3), number(2, 3)))


def test_a_crack_may_go_through_on_one_side_and_snap_on_the_other():
    """Spokes at 0, 60, ... on the right, but one at 210 degrees on the left."""
    nodes = np.array([[0.0, 0.0], *(unit(a) for a in (0, 60, 120, 210, 290))])
    mesh = nodes, np.array([[0, i, i % 5 + 1] for i in range(1, 6)])
    topology = cracked(mesh, 0, 30, "intra")
    assert (~topology.state().alive).sum() == 1
    middle = tuple(np.round(0.5 * (nodes[1] + nodes[2]), 6))
    assert same(faces(topology), [{(0.0, 0.0), middle}, *spokes(mesh, 0, 4)])


def test_mirroring_the_mesh_mirrors_the_crack(rough_lattice):
    nodes, triangles = rough_lattice
    mirrored = nodes * [1, -1], triangles[:, ::-1]
    for degrees in range(0, 180, 7):
        for mode in ("inter", "intra"):
            there = faces(cracked((nodes, triangles), CENTRE, degrees, mode))
            here = faces(cracked(mirrored, CENTRE, -degrees, mode))
            assert same([{(x, -y + 0.0) for x, y in face} for face in here], there)


def test_an_edge_stays_open_though_its_element_is_cut():
    """One arm cuts an element of 169 degrees, the other goes along an edge of it."""
    rim = {62: 1.04, 101: 1.19, 141: 0.9, 167: 1.0, 253: 0.92}
    nodes = [[0.0, 0.0], *(radius * unit(angle) for angle, radius in rim.items())]
    nodes += [2.0 * unit(a) for a in (81.5, 121, 154, 210, 337.5)]
    triangles = [[0, i, i % 5 + 1] for i in range(1, 6)]
    triangles += [[i, i + 5, i % 5 + 1] for i in range(1, 6)]
    loose = Guard(least_step=0.01, least_area=0.001, least_angle=0.01)
    topology = cracked((np.array(nodes), np.array(triangles)), 0, 55, "intra", loose)
    assert (~topology.state().alive).sum() == 2
    assert len(faces(topology)) == 2
    assert spokes((np.array(nodes), None), 0, 5)[0] in faces(topology)
