"""Nodal failure map (fortran/fracture/failure_map.f90)."""

import numpy as np
import pytest

from lithofrac.errors import CoreError
from lithofrac.topology import Guard, Topology, failure_factors

TWO = [[0, 0], [1, 0], [0, 1], [-3, 0]]  # areas 1/2 and 3/2 at nodes 0 and 2
FANS = [[0, 1, 2], [0, 2, 3]]


def doubled(degrees):
    """Direction as (cos 2a, sin 2a), (n, 2)."""
    angle = 2 * np.radians(np.atleast_1d(degrees))
    return np.column_stack([np.cos(angle), np.sin(angle)])


def degrees_of(along):
    return np.degrees(np.arctan2(along[..., 1], along[..., 0]))


def turned(vectors, angle):
    c, s = np.cos(angle), np.sin(angle)
    return vectors @ np.array([[c, s], [-s, c]])


def test_factor_is_weighted_by_volume():
    mean, _, _ = Topology(TWO, FANS).average([2.0, 1.0], doubled([0, 0]))
    np.testing.assert_allclose(mean, [1.25, 2.0, 1.25, 1.0], rtol=1e-15)


def test_factor_weighted_by_itself():
    mean, _, _ = Topology(TWO, FANS).average([2.0, 1.0], doubled([0, 0]), "failure_factor")
    np.testing.assert_allclose(mean[0], (4 * 1 + 1 * 3) / (2 * 1 + 1 * 3), rtol=1e-15)


def test_virgin_material_has_no_failure_whatever_the_weights():
    for weights in ("volume", "failure_factor"):
        mean, along, agreement = Topology(TWO, FANS).average([0.0, 0.0], doubled([0, 0]), weights)
        assert not mean.any()
        assert not agreement.any()
        np.testing.assert_array_equal(along, np.tile([1.0, 0.0], (4, 1)))


def test_one_of_six_elements_takes_its_node_to_failure_by_passing_1(hexagon):
    factor = np.array([0, 0, 6.0, 0, 0, 0])
    mean, along, agreement = Topology(*hexagon).average(factor, doubled(np.full(6, 40.0)))
    assert mean[0] == pytest.approx(1.0, rel=1e-15)
    assert degrees_of(along[0]) == pytest.approx(40 - 90, abs=1e-12)
    assert agreement[0] == pytest.approx(1.0, rel=1e-15)


def test_crack_runs_across_the_direction_of_softening():
    _, along, _ = Topology(TWO, FANS).average([1.0, 1.0], doubled([0, 0]))
    np.testing.assert_allclose(abs(along[0]), [0.0, 1.0], atol=1e-15)


def test_directions_on_both_sides_of_180_degrees_do_not_cancel():
    """A plain mean of 1 and 179 degrees would be 90 degrees off."""
    nodes = [[0, 0], [1, 0], [0, 1], [-1, 0]]
    _, along, agreement = Topology(nodes, FANS).average([1.0, 1.0], doubled([1, 179]))
    np.testing.assert_allclose(abs(along[0]), [0.0, 1.0], atol=1e-14)
    assert agreement[0] == pytest.approx(np.cos(np.radians(2)), rel=1e-14)


def test_length_of_a_direction_has_no_weight():
    normal = doubled([10, 50]) * [[1e-6], [1e3]]
    _, along, _ = Topology(TWO, FANS).average([1.0, 1.0], normal)
    expected = doubled([10]) + 3 * doubled([50])
    angle = np.degrees(np.arctan2(expected[0, 1], expected[0, 0])) / 2
    assert degrees_of(along[0]) == pytest.approx(angle - 90, abs=1e-12)


def test_element_that_has_not_begun_to_fail_has_no_direction():
    mean, along, _ = Topology(TWO, FANS).average([1.0, 0.0], doubled([20, 80]))
    assert mean[0] == pytest.approx(0.25, rel=1e-15)
    assert degrees_of(along[0]) == pytest.approx(20 - 90, abs=1e-12)


def test_failure_out_of_the_plane_alone_has_no_direction():
    mean, _, agreement = Topology(TWO, FANS).average([1.0, 1.0], np.zeros((2, 2)))
    np.testing.assert_allclose(mean, 1.0)
    np.testing.assert_array_equal(agreement, 0.0)


@pytest.mark.parametrize(("factor", "winner"), [([1.0, 1.1], 1), ([1.1, 1.0], 0), ([1.0, 1.0], 0)])
def test_where_directions_conflict_the_most_failed_element_decides(factor, winner):
    """Of equal ones the lowest: the same every time."""
    nodes = [[0, 0], [1, 0], [0, 1], [-1, 0]]
    directions = [30.0, 120.0]
    _, along, agreement = Topology(nodes, FANS).average(factor, doubled(directions))
    assert agreement[0] < 0.1
    np.testing.assert_allclose(
        doubled(degrees_of(along[0]) + 90), doubled(directions[winner]), atol=1e-12
    )


@pytest.mark.parametrize("weights", ["volume", "failure_factor"])
@pytest.mark.parametrize("angle", [1e-6, 0.3, np.pi / 4, np.pi / 2, 2.0, np.pi, 5.5])
def test_turning_the_frame_turns_the_directions_and_nothing_else(rough_lattice, weights, angle):
    nodes, triangles = rough_lattice
    rng = np.random.default_rng(2)
    factor = rng.uniform(0, 2, len(triangles)) * (rng.random(len(triangles)) < 0.8)
    normal = doubled(rng.uniform(0, 180, len(triangles)))
    mean, along, agreement = Topology(nodes, triangles).average(factor, normal, weights)
    again = Topology(turned(nodes, angle), triangles).average(
        factor, turned(normal, 2 * angle), weights
    )
    np.testing.assert_allclose(again[0], mean, rtol=1e-13)
    np.testing.assert_allclose(again[2], agreement, atol=1e-12)
    off = turned(along, angle + np.pi / 2) * again[1]  # across: the sense is free
    assert abs(off.sum(axis=1)).max() < 1e-12


def test_copies_average_over_their_own_elements(hexagon):
    topology = Topology(*hexagon)
    topology.split([[0, 0], [3, 0]])
    mean, _, _ = topology.average([1.0, 1.0, 1.0, 3.0, 3.0, 3.0], doubled(np.zeros(6)))
    copies = topology.state().triangles[[0, 3], 0]
    np.testing.assert_allclose(mean[copies], [1.0, 3.0], rtol=1e-15)


def test_cutting_elements_leaves_the_map_of_their_node_as_it_is(lattice):
    """Children carry the state of their parent, and together its volume."""
    topology = Topology(*lattice)
    factor = np.random.default_rng(3).uniform(0, 2, topology.n_elements)
    normal = doubled(np.linspace(0, 90, topology.n_elements))
    mean, along, _ = topology.average(factor, normal)
    elements, _, _ = topology.fan(24)
    corner = list(topology.state().triangles[elements[0]]).index(24)
    topology.cut(elements[0], (corner + 1) % 3, 0.5, Guard())
    parents = topology.edits().element_parent
    again, along_again, _ = topology.average(
        np.concatenate([factor, factor[parents]]), np.concatenate([normal, normal[parents]])
    )
    assert again[24] == pytest.approx(mean[24], rel=1e-14)
    np.testing.assert_allclose(along_again[24], along[24], rtol=1e-13)


def test_arrays_that_do_not_fit_are_refused():
    with pytest.raises(CoreError, match="arrays do not fit"):
        Topology(TWO, FANS).average([1.0], doubled([0]))


def test_factor_of_a_plane_is_1_where_its_strength_is_used_up():
    strength, softening = 4e6, -2e9
    opening = strength / -softening
    factor = failure_factors(
        opening * np.array([-1.0, 0.0, 0.5, 1.0, 3.0, 50.0]), np.full(6, softening), np.full(6, 4e6)
    )
    np.testing.assert_allclose(factor, [0.0, 0.0, 0.5, 1.0, 3.0, 10.0], rtol=1e-15)


def test_plane_without_strength_or_softening_never_fails():
    np.testing.assert_array_equal(failure_factors([1.0, 1.0], [0.0, -1e9], [4e6, 0.0]), [0.0, 0.0])
