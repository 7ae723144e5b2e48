"""Fan splitting and opening cracks (fortran/mesh/split.f90)."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from lithofrac.errors import CoreError
from lithofrac.topology import Guard, Topology


def areas(nodes, triangles):
    a, b, c = (nodes[triangles[:, i]] for i in range(3))
    ab, ac = b - a, c - a
    return 0.5 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])


def lumped(nodes, triangles):
    """Nodal masses: a third of each element, unit density."""
    shares = np.repeat(areas(nodes, triangles) / 3, 3)
    return np.bincount(triangles.ravel(), shares, minlength=len(nodes))


def inner_edges(triangles):
    """Matching edges of a whole mesh: (k, 4) element, edge; element, edge."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    key = np.minimum(start, end) * (start.max() + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    pair = np.flatnonzero(key[order][1:] == key[order][:-1])
    first, second = order[pair], order[pair + 1]
    return np.column_stack([first // 3, first % 3, second // 3, second % 3])


def groups_of_corners(triangles, links):
    """Corners (3 m) that hang together over whole edges: which group each belongs to."""
    e, k, f, other = links.T
    rows = np.concatenate([3 * e + k, 3 * e + (k + 1) % 3])
    columns = np.concatenate([3 * f + (other + 1) % 3, 3 * f + other])
    size = 3 * len(triangles)
    return connected_components(coo_array((np.ones(len(rows)), (rows, columns)), (size, size)))[1]


def roots(n_first, parents):
    """Node of the first mesh that each node is a copy of."""
    root = np.concatenate([np.arange(n_first), parents])
    while (root[root] != root).any():
        root = root[root]
    return root


@pytest.fixture(scope="module")
def random_cuts(patches, n_random):
    """10,000 patches, each with 2 to 100 % of its inner edges cut in random order."""
    n = n_random(10_000)
    nodes, triangles, patch, _ = patches(n, 6)
    rng = np.random.default_rng(5)
    inner = inner_edges(triangles)
    share = rng.uniform(0.02, 1.0, n)[patch[triangles[inner[:, 0], 0]]]
    chosen = rng.random(len(inner)) < share
    cuts = rng.permutation(inner[chosen])
    velocity = rng.normal(size=nodes.shape)
    topology = Topology(nodes, triangles)
    topology.follow(velocity)
    topology.split(cuts[:, :2])
    return topology, nodes, triangles, patch, inner[~chosen], cuts, velocity


def test_random_cuts_leave_one_fan_a_node_and_keep_mass_and_momentum(random_cuts):
    topology, nodes, triangles, patch, links, cuts, velocity = random_cuts
    topology.check()
    state, edits = topology.state(), topology.edits()

    # The same partition as by union-find over the edges left whole: tips stay, nothing hangs by
    # a node, and no node is split further than it has to be.
    group = groups_of_corners(triangles, links)
    corners = state.triangles.ravel().astype(np.int64)
    n_groups = group.max() + 1
    assert topology.n_nodes == n_groups
    assert len(np.unique(corners * n_groups + group)) == n_groups
    assert len(edits.opened) == len(cuts)

    # Boundaries are simple loops: each node is left once and reached once.
    open_element, open_edge = np.nonzero(state.neighbours < 0)
    left = np.bincount(state.triangles[open_element, open_edge], minlength=n_groups)
    reached = np.bincount(state.triangles[open_element, (open_edge + 1) % 3], minlength=n_groups)
    assert left.max() == 1
    np.testing.assert_array_equal(left, reached)

    # Mass: the copies of a node weigh together what it weighed. Six terms round six times.
    root = roots(len(nodes), edits.node_parent[:, 0])
    before, after = lumped(nodes, triangles), lumped(state.nodes, state.triangles)
    copies = np.bincount(root, after)
    assert np.abs(copies / before - 1).max() < 1e-15
    np.testing.assert_array_equal(state.nodes, nodes[root])

    # Momentum of each patch, against the sum of its parts.
    moved = topology.field()
    np.testing.assert_array_equal(moved, velocity[root])
    for i in range(2):
        old = np.bincount(patch, before * velocity[:, i])
        new = np.bincount(patch[root], after * moved[:, i])
        scale = np.bincount(patch, before * abs(velocity[:, i]))
        assert (abs(new - old) / scale).max() < 1e-13


def test_cutting_again_changes_nothing(random_cuts):
    topology, *_, cuts, _ = random_cuts
    changes = topology.changes
    topology.split(cuts[:, 2:])  # the same edges, from their other sides
    assert topology.changes == changes


def test_order_and_portions_of_the_cuts_do_not_matter(patches):
    nodes, triangles, _, _ = patches(200, 6)
    rng = np.random.default_rng(6)
    inner = inner_edges(triangles)
    cuts = inner[rng.random(len(inner)) < 0.5]
    partitions = []
    for portions in (1, 7, 7):
        topology = Topology(nodes, triangles)
        for part in np.array_split(rng.permutation(cuts), portions):
            topology.split(part[:, :2])
        corners = topology.state().triangles.ravel()
        _, first, number = np.unique(corners, return_index=True, return_inverse=True)
        partitions.append(first[number])  # lowest corner with the same node
    np.testing.assert_array_equal(partitions[0], partitions[1])
    np.testing.assert_array_equal(partitions[0], partitions[2])


def copies_of(topology, node):
    """How many nodes lie where `node` lies."""
    nodes = topology.state().nodes
    return int((np.abs(nodes - nodes[node]).max(axis=1) < 1e-12).sum())


def test_a_crack_from_the_boundary_ends_in_a_tip(hexagon):
    topology = Topology(*hexagon)
    topology.split([[0, 0]])  # the spoke to node 1
    assert copies_of(topology, 0) == 1
    assert copies_of(topology, 1) == 2


def test_a_lone_inner_cut_opens_nothing(patches):
    nodes, triangles, _, _ = patches(1, 6, jitter=0.0)
    inner_nodes = ((nodes > 0) & (nodes < 6)).all(axis=1)
    topology = Topology(nodes, triangles)
    cut = next(c for c in inner_edges(triangles) if inner_nodes[triangles[c[0]]].all())
    topology.split([cut[:2]])
    assert topology.n_nodes == len(nodes)
    assert (topology.state().neighbours[cut[0], cut[1]]) == -1
    topology.check()


def test_a_crack_through_a_node_opens_it(hexagon):
    topology = Topology(*hexagon)
    topology.split([[0, 0], [3, 0]])  # spokes to nodes 1 and 4
    assert topology.n_nodes == 7 + 3
    assert copies_of(topology, 0) == 2


def test_a_branch_has_three_copies(hexagon):
    topology = Topology(*hexagon)
    topology.split([[0, 0], [2, 0], [4, 0]])
    assert copies_of(topology, 0) == 3


def test_a_crack_that_hits_a_crack_has_three_copies(hexagon):
    topology = Topology(*hexagon)
    topology.split([[0, 0], [3, 0]])
    topology.split([[1, 0]])
    assert copies_of(topology, 0) == 3


def test_six_loose_triangles_meet_in_six_copies(hexagon):
    topology = Topology(*hexagon)
    topology.split([[i, 0] for i in range(6)])
    assert copies_of(topology, 0) == 6
    assert topology.n_nodes == 18
    assert (topology.state().neighbours == -1).all()
    topology.check()


def test_a_block_cut_all_around_is_loose(patches):
    """The middle four cells of a square keep their own nodes and share none with the rest."""
    nodes, triangles, _, _ = patches(1, 6, jitter=0.0)
    inside = (abs(nodes[triangles].mean(axis=1) - 3) < 1).all(axis=1)
    edges = inner_edges(triangles)
    topology = Topology(nodes, triangles)
    topology.split(edges[inside[edges[:, 0]] != inside[edges[:, 2]]][:, :2])
    topology.check()
    state = topology.state()
    block, rest = state.triangles[inside], state.triangles[~inside]
    assert not np.intersect1d(block, rest).size
    assert topology.n_nodes == len(nodes) + 8  # the rim of the block has eight nodes
    _, after = topology.boundary()
    loop, start = [], np.intersect1d(block, np.flatnonzero(after >= 0))[0]
    while start not in loop:
        loop.append(start)
        start = after[start]
    assert len(loop) == 8


def test_the_fan_with_the_lowest_element_keeps_the_node(hexagon):
    topology = Topology(*hexagon)
    topology.split([[1, 0], [4, 0]])
    triangles = topology.state().triangles
    np.testing.assert_array_equal(triangles[[5, 0]][:, 0], [0, 0])
    assert (triangles[[4]][:, 0] == 0).all()
    assert (triangles[[1, 2, 3]][:, 0] != 0).all()


def test_a_copy_belongs_to_the_body_of_its_elements():
    nodes = [[0, 0], [1, 0], [1, 1], [0, 1]]
    topology = Topology(nodes, [[0, 1, 2], [0, 2, 3]], body=[0, 1])
    topology.split([[0, 2]])
    state = topology.state()
    for element in range(2):
        assert (state.body_of_node[state.triangles[element]] == element).all()


def test_boundary_edges_are_left_alone(hexagon):
    topology = Topology(*hexagon)
    topology.split([[0, 1]])
    assert topology.changes == 0


def test_all_arms_of_a_crack_open_or_none(patches):
    nodes, triangles, _, _ = patches(1, 4, jitter=0.1)
    topology = Topology(nodes, triangles)
    elements, _, _ = topology.fan(12)
    edge = [list(triangles[e]).index(12) for e in elements]
    good = (elements[0], (edge[0] + 1) % 3, 0.5)
    bad = (elements[3], (edge[3] + 1) % 3, 0.1)
    old = topology.state()
    verdict = topology.open([good, bad], Guard(least_step=0.0))
    assert verdict == "too near the end of the edge"
    for before, after in zip(old, topology.state(), strict=True):
        np.testing.assert_array_equal(before, after)
    assert topology.open([good, (elements[3], edge[3], None)], Guard(least_step=0.0)) == "sound"
    topology.check()
    assert copies_of(topology, 12) == 2


@pytest.mark.parametrize(
    ("edge", "words"),
    [
        ([9, 0], "no such element"),
        ([-1, 0], "no such element"),
        ([0, 3], "edges are numbered 1 to 3"),
    ],
)
def test_an_edge_that_does_not_exist_is_refused(hexagon, edge, words):
    with pytest.raises(CoreError, match=words):
        Topology(*hexagon).split([edge])
