"""Cutting elements (fortran/mesh/cut.f90)."""

from typing import NamedTuple

import numpy as np
import pytest

from lithofrac.errors import CoreError
from lithofrac.topology import Guard, Topology, triangle_shapes

FREE = Guard(snap=0.0, least_step=0.0, least_area=0.0, least_angle=0.0)
HALF = np.sqrt(3) / 2
RHOMBUS = [[0, 0], [0.5, -HALF], [1, 0], [0.5, HALF]]  # two equilateral triangles
HALVES = [[0, 1, 2], [0, 2, 3]]


def areas(nodes, triangles):
    a, b, c = (nodes[triangles[:, i]] for i in range(3))
    ab, ac = b - a, c - a
    return 0.5 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])


def lumped(nodes, triangles):
    shares = np.repeat(areas(nodes, triangles) / 3, 3)
    return np.bincount(triangles.ravel(), shares, minlength=len(nodes))


def test_both_sides_are_cut_and_stay_linked():
    topology = Topology(RHOMBUS, HALVES)
    cut = topology.cut(0, 2, 0.5, FREE)
    state = topology.state()
    assert cut.verdict == "sound"
    np.testing.assert_array_equal(state.nodes[cut.node], [0.5, 0.0])
    np.testing.assert_array_equal(state.alive, [False, False, True, True, True, True])
    np.testing.assert_array_equal(state.triangles[2:], [[1, 2, 4], [1, 4, 0], [3, 0, 4], [3, 4, 2]])
    np.testing.assert_array_equal(
        state.neighbours[2:], [[-1, 5, 3], [2, 4, -1], [-1, 3, 5], [4, 2, -1]]
    )
    np.testing.assert_array_equal(state.origin, [0, 1, 0, 0, 1, 1])
    element, edge = cut.middle
    np.testing.assert_array_equal(state.triangles[element][[edge, edge + 1]], [1, cut.node])
    topology.check()


def test_a_boundary_edge_has_one_side():
    topology = Topology(RHOMBUS, HALVES)
    cut = topology.cut(0, 0, 0.5, FREE)
    assert topology.n_elements == 4
    before, after = topology.boundary()
    assert (before[cut.node], after[cut.node]) == (0, 1)
    topology.check()


@pytest.mark.parametrize("s", [0.25 - 1e-12, 0.75 + 1e-12, 0.0, 1.0, -1.0, 2.0, np.nan])
def test_no_cut_near_an_end(s):
    topology = Topology(RHOMBUS, HALVES)
    assert topology.cut(0, 2, s, Guard()).verdict == "too near the end of the edge"
    assert topology.changes == 0


@pytest.mark.parametrize("s", [0.4, 0.5, 0.6])
def test_the_middle_of_an_equilateral_triangle_may_be_cut(s):
    assert Topology(RHOMBUS, HALVES).cut(0, 2, s, Guard()).verdict == "sound"


@pytest.mark.parametrize("s", [0.3, 0.36, 0.64, 0.7])
def test_the_step_guard_keeps_cuts_of_an_equilateral_triangle_in_its_middle(s):
    """A child at s has about the step s of its parent, 0.4 of which must remain."""
    verdict = Topology(RHOMBUS, HALVES).cut(0, 2, s, Guard()).verdict
    assert verdict == "a child would lower the time step too far"


def test_the_worst_of_both_sides_counts():
    """The same edge, seen from either side, with a flat triangle on one of them."""
    nodes = [*RHOMBUS[:3], [0.9, 0.12]]
    for element, edge in ((0, 2), (1, 0)):
        assert Topology(nodes, HALVES).cut(element, edge, 0.5, FREE).verdict == "sound"
        verdict = Topology(nodes, HALVES).cut(
            element, edge, 0.5, Guard(least_step=0, least_area=0, least_angle=np.pi / 9)
        )
        assert verdict.verdict == "a child would be too pointed"


def test_small_children_are_refused():
    guard = Guard(least_step=0.0, least_area=0.22)  # half of the triangle is 0.217 h^2
    verdict = Topology(RHOMBUS, HALVES).cut(0, 2, 0.5, guard).verdict
    assert verdict == "a child would be too small"


def test_the_first_element_is_the_measure_of_repeated_cuts():
    """A half may not be cut to 0.4 of itself: it would be 0.25 of the whole."""
    topology = Topology(RHOMBUS, HALVES)
    guard = Guard(least_area=0.0, least_angle=0.0)
    topology.cut(0, 2, 0.5, guard)
    state = topology.state()
    whole = triangle_shapes(state.nodes[state.triangles[:1]], 0.2)[0][0]
    for _ in range(4):
        for element in np.flatnonzero(topology.state().alive):
            for edge in range(3):
                if topology.state().alive[element]:
                    topology.cut(element, edge, 0.5, guard)
    state = topology.state()
    steps = triangle_shapes(state.nodes[state.triangles[state.alive]], 0.2)[0]
    assert steps.min() >= 0.4 * whole
    topology.check()


def test_a_cut_element_cannot_be_cut_again():
    topology = Topology(RHOMBUS, HALVES)
    topology.cut(0, 2, 0.5, FREE)
    with pytest.raises(CoreError, match="the element has been cut"):
        topology.cut(0, 2, 0.5, FREE)


class Cracked(NamedTuple):
    """Patches before and after cracks at random nodes in random directions."""

    nodes: np.ndarray
    triangles: np.ndarray
    patch: np.ndarray
    patch_of_element: np.ndarray
    velocity: np.ndarray
    topology: Topology
    crossings: np.ndarray  # (rounds, patches) arms through elements

    @property
    def living(self):
        return np.flatnonzero(self.topology.state().alive)

    @property
    def patch_of_node(self):
        """Patch of each node, those that were born included."""
        state = self.topology.state()
        patches = np.empty(len(state.nodes), dtype=int)
        living = self.living
        patches[state.triangles[living].T] = self.patch_of_element[state.origin[living]]
        return patches


POISSON = 0.3


CASES = {"even": (10_000, 1, 1.0), "stretched": (10_000, 1, 100.0), "repeated": (1_000, 12, 3.0)}


@pytest.fixture(scope="module", params=CASES)
def cracked(request, patches, n_random):
    """`rounds` cracks in each of n patches, which are stretched up to `aspect` times."""
    n, rounds, aspect = CASES[request.param]
    n = n_random(n)
    nodes, triangles, patch, patch_of_element = patches(n, 4, jitter=0.25, seed=7)
    rng = np.random.default_rng(8)
    nodes[:, 0] *= (aspect ** rng.uniform(size=n))[patch]
    velocity = rng.normal(size=nodes.shape)
    topology = Topology(nodes, triangles)
    topology.follow(velocity)
    made = Cracked(nodes, triangles, patch, patch_of_element, velocity, topology, [])
    for _ in range(rounds):
        angle = rng.uniform(0, np.pi, n)
        order = rng.permutation(topology.n_nodes)
        _, first = np.unique(made.patch_of_node[order], return_index=True)
        arms, crossings, verdict = topology.crack(
            order[first],
            np.column_stack([np.cos(angle), np.sin(angle)]),
            "intra",
            Guard(poisson=(POISSON,)),
        )
        assert not verdict.any()  # what is chosen can be done
        assert (arms > 0).mean() > 0.3
        made.crossings.append(crossings)
    return made


def test_random_cracks_hold_all_invariants_and_guards(cracked):
    topology, n_first = cracked.topology, len(cracked.triangles)
    topology.check()
    state, living = topology.state(), cracked.living
    born = living[living >= n_first]
    assert sum(map(sum, cracked.crossings)) > 0.1 * len(cracked.crossings[0])
    assert areas(state.nodes, state.triangles)[living].min() > 0
    corners = state.nodes[state.triangles]
    steps, angles, _ = triangle_shapes(corners, POISSON)
    _, _, squares = triangle_shapes(corners[state.origin], POISSON)
    assert (steps[born] >= 0.4 * steps[state.origin[born]]).all()
    assert (areas(state.nodes, state.triangles)[born] >= 0.05 * squares[born]).all()
    assert angles[born].min() >= np.pi / 18


def test_random_cracks_keep_area_mass_and_momentum(cracked):
    state, living = cracked.topology.state(), cracked.living
    before = lumped(cracked.nodes, cracked.triangles)
    after = lumped(state.nodes, state.triangles[living])
    assert after.min() > 0
    total = np.bincount(cracked.patch, before)
    np.testing.assert_allclose(np.bincount(cracked.patch_of_node, after), total, rtol=2e-15)
    moved = cracked.topology.field()
    for i in range(2):
        old = np.bincount(cracked.patch, before * cracked.velocity[:, i])
        new = np.bincount(cracked.patch_of_node, after * moved[:, i])
        scale = np.bincount(cracked.patch, before * abs(cracked.velocity[:, i]))
        assert (abs(new - old) / scale).max() < 1e-13


@pytest.mark.parametrize("cracked", ["even", "stretched"], indirect=True)
def test_random_cracks_leave_a_conforming_mesh(cracked):
    """With copies put together again, every edge has two sides, but for the outline.

    Not so for repeated cracks: one that ends on another puts a node on one of its faces only.
    """
    state, living = cracked.topology.state(), cracked.living
    place = np.unique(
        np.column_stack([cracked.patch_of_node, state.nodes]), axis=0, return_inverse=True
    )[1].ravel()[state.triangles[living]]
    start, end = place.ravel(), np.roll(place, -1, axis=1).ravel()
    size = int(place.max()) + 1
    single = ~np.isin(start * size + end, end * size + start)
    corners = state.nodes[state.triangles[living]]
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).ravel()
    patch = np.repeat(cracked.patch_of_element[state.origin[living]], 3)
    outline = np.bincount(patch[single], sides[single])
    width = np.maximum.reduceat(cracked.nodes[:, 0], np.arange(len(outline)) * 25)
    np.testing.assert_allclose(outline, 8 + 2 * width, rtol=1e-13)


def test_a_moving_edge_keeps_its_momentum_when_a_node_is_put_on_it():
    """Exactly: the mass that the ends give away moves at the velocity of the new node."""
    velocity = np.array([[1.0, 2.0], [0.0, 0.0], [-3.0, 5.0], [0.0, 1.0]])
    topology = Topology(RHOMBUS, HALVES)
    topology.follow(velocity)
    before = lumped(np.array(RHOMBUS), np.array(HALVES)) @ velocity
    topology.cut(0, 2, 0.3, FREE)
    state = topology.state()
    after = lumped(state.nodes, state.triangles[state.alive]) @ topology.field()
    np.testing.assert_allclose(after, before, rtol=1e-14)
