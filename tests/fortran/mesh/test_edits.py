"""Lists of changes (fortran/mesh/edits.f90)."""

import numpy as np
import pytest

from lithofrac.topology import Guard, Topology

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]
HALVES = [[0, 1, 2], [0, 2, 3]]


def assert_same(old, new):
    for name, before, after in zip(old._fields, old, new, strict=True):
        np.testing.assert_array_equal(before, after, err_msg=name)


def test_a_cut_across_a_square_lists_two_copies_and_the_opened_edge():
    topology = Topology(SQUARE, HALVES)
    topology.split([[0, 2]])
    edits = topology.edits()
    assert sorted(edits.node_parent[:, 0]) == [0, 2]
    np.testing.assert_array_equal(edits.node_parent[:, 0], edits.node_parent[:, 1])
    np.testing.assert_array_equal(edits.share, [0, 0])
    np.testing.assert_array_equal(edits.opened, [[0, 2, 1, 0]])
    assert set(edits.changed) == {0, 1}
    assert len(edits.retired) == len(edits.element_parent) == 0


def test_a_cut_edge_lists_its_node_two_retired_elements_and_four_new_ones():
    topology = Topology(SQUARE, HALVES)
    topology.cut(0, 2, 0.4, Guard(least_step=0.0))
    edits = topology.edits()
    np.testing.assert_array_equal(edits.node_parent, [[2, 0]])
    np.testing.assert_array_equal(edits.share, [0.4])
    np.testing.assert_array_equal(edits.element_parent, [0, 0, 1, 1])
    np.testing.assert_array_equal(edits.retired, [0, 1])
    assert len(edits.opened) == 0


def test_a_field_is_copied_to_copies_and_interpolated_on_edges():
    topology = Topology(SQUARE, HALVES)
    topology.follow([[1.0, 0.1], [2.0, 0.2], [3.0, 0.3], [4.0, 0.4]])
    cut = topology.cut(0, 2, 0.4, Guard(least_step=0.0))
    np.testing.assert_allclose(topology.field()[4], [3 - 0.4 * 2, 0.3 - 0.4 * 0.2], rtol=1e-15)
    topology.split([cut.middle])
    edits = topology.edits()
    field = topology.field()
    np.testing.assert_array_equal(field[edits.node_parent[:, 0]], field[5:])


@pytest.mark.parametrize("mode", ["inter", "intra"])
def test_changes_are_taken_back_to_the_bit(mode, patches, n_random):
    nodes, triangles, patch, _ = patches(n_random(300, 20), 4, seed=3)
    rng = np.random.default_rng(4)
    topology = Topology(nodes, triangles)
    for angle, first in zip(
        rng.uniform(0, np.pi, patch[-1] + 1), np.arange(patch[-1] + 1) * 25, strict=True
    ):
        node = first + rng.choice([6, 7, 8, 11, 12, 13, 16, 17, 18])
        old = topology.state() if first % 250 == 0 else None  # a whole copy takes its time
        topology.crack(node, [np.cos(angle), np.sin(angle)], mode)
        if old is None:
            continue
        assert topology.n_nodes > len(old.nodes)
        topology.undo()
        assert_same(old, topology.state())
    topology.check()


def test_taking_back_is_a_change_as_well():
    """Whoever keeps something by the counter must see that the mesh was touched."""
    topology = Topology(SQUARE, HALVES)
    topology.split([[0, 2]])
    before = topology.changes
    topology.undo()
    assert topology.changes > before > 0


def test_numbers_are_never_used_again(patches):
    nodes, triangles, _, _ = patches(20, 4)
    topology = Topology(nodes, triangles)
    topology.crack(
        np.arange(20) * 25 + 12, np.tile([0.8, 0.6], (20, 1)), "intra", Guard(least_step=0.3)
    )
    state = topology.state()
    retired = ~state.alive
    assert retired.any()
    assert (np.flatnonzero(retired) < len(triangles)).all()
    np.testing.assert_array_equal(state.triangles[: len(triangles)][retired[: len(triangles)]],
                                  triangles[retired[: len(triangles)]])  # fmt: skip
    np.testing.assert_array_equal(state.nodes[: len(nodes)], nodes)
    assert (state.origin[len(triangles) :] < len(triangles)).all()
