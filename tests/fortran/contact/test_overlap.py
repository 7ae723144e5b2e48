"""Parts that overlap at the start (fortran/contact/overlap.f90, clashes.f90)."""

import re
from dataclasses import replace

import numpy as np
import pytest
from contact_models import UNIT, contact_problem, cut_all_edges, join, moved
from models import problem, rectangle

from lithofrac.core import CoreError, Run
from lithofrac.kernels import boundary_of
from lithofrac.problem import Mesh

NODE = re.compile(r"node (\d+) at (.+) m stands (.+) m inside another part")
ELEMENTS = re.compile(r"elements (\d+) and (\d+) of two parts cross at (.+) m, (.+) m deep")
# Bars of one cell, with nodes at their corners alone.
FLAT = rectangle(1, 1, 3.0, 1.0)
UPRIGHT = moved(rectangle(1, 1, 1.0, 3.0), (1.0, -1.0))


def said(mesh):
    """What contact and a look without contact say, which is the same; nothing if they accept."""
    try:
        Run(contact_problem(mesh))
        words = ""
    except CoreError as error:
        words = str(error)
    bare = Run(problem(mesh, materials=(UNIT,) * len(mesh.body_names)))
    if words:
        assert words.endswith("; parts must not overlap at the start")
        with pytest.raises(CoreError) as caught:
            bare.refuse_overlap()
        assert str(caught.value) == words.replace("contact:", "mesh:")
    else:
        bare.refuse_overlap()
    return words


def numbers(text):
    return [float(word) for word in text.split()]


def test_bars_that_cross_are_found_though_no_node_is_inside():
    first, second, place, depth = ELEMENTS.search(said(join(a=FLAT, b=UPRIGHT))).groups()
    assert int(first) in (1, 2) and int(second) in (3, 4)
    assert 1.0 <= numbers(place)[0] <= 2.0 and 0.0 <= numbers(place)[1] <= 1.0
    assert 1.0 < float(depth) < 2.0  # triangles part sooner than the bars, which take 2 m


def test_bars_that_lie_half_on_each_other_are_found_though_no_node_is_inside():
    assert ELEMENTS.search(said(join(a=FLAT, b=moved(FLAT, (1.0, 0.0)))))


def test_one_mesh_twice_at_one_place_is_found():
    assert ELEMENTS.search(said(join(a=FLAT, b=FLAT)))
    fine = rectangle(4, 4)
    node, place, depth = NODE.search(said(join(a=fine, b=fine))).groups()
    assert int(node) in (13, 25 + 13)
    assert numbers(place) == [0.5, 0.5]
    assert float(depth) == 0.5


@pytest.mark.parametrize("turn", [0.1, -0.1])
def test_the_deepest_node_is_told(turn):
    """A block that stands on a corner in a floor: its nodes go in, from little to most."""
    low, high = rectangle(8, 8, 2.0, 2.0), moved(rectangle(4, 4, 0.8, 0.8), turn=turn)
    mesh = join(low=low, high=moved(high, (0.6, 1.99 - high.nodes[:, 1].min())))
    deepest = len(low.nodes) + int(np.argmin(high.nodes[:, 1]))
    first = len(low.nodes) + int(np.flatnonzero(mesh.nodes[len(low.nodes) :, 1] < 2.0)[0])
    node, place, depth = NODE.search(said(mesh)).groups()
    assert (int(node), float(depth)) == (deepest + 1, pytest.approx(0.01, abs=1e-4))
    np.testing.assert_allclose(numbers(place), mesh.nodes[deepest], atol=1e-3)
    assert turn > 0 or first <= deepest  # and it is not merely the first


@pytest.mark.parametrize(
    "cells", [(1, 40), (40, 1), (3, 7)], ids=["fine on coarse", "coarse on fine", "odd"]
)
@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("far", [0.0, 50.0, 1e6])
def test_faces_that_touch_are_no_overlap(cells, turn, far):
    """Whatever the sizes of elements, in any direction, far away too: rounding is no depth."""
    floor, block = (rectangle(n, n) for n in cells)
    mesh = join(floor=floor, block=moved(block, (0.3, 1.0)), beside=moved(block, (1.3, 1.0)))
    assert said(moved(mesh, (far, -far), turn)) == ""


def test_rubble_of_single_elements_that_all_touch_is_no_overlap():
    assert said(cut_all_edges(rectangle(12, 12, jitter=0.3))) == ""


@pytest.mark.parametrize("cells", [(1, 40), (40, 1), (3, 7)])
@pytest.mark.parametrize(("share", "refused"), [(0.9e-3, False), (1.1e-3, True)])
def test_a_thousandth_of_the_shortest_edge_is_left_to_contact(cells, share, refused):
    floor, block = (rectangle(n, n) for n in cells)
    shortest = 1.0 / max(cells)
    mesh = join(floor=floor, block=moved(block, (0.3, 1.0 - share * shortest)))
    assert bool(said(mesh)) == refused


def test_a_body_within_one_element_of_another_is_found():
    small = moved(rectangle(3, 3, 1e-3, 1e-3), (0.7, 0.2))
    node, _, depth = NODE.search(said(join(large=rectangle(1, 1), small=small))).groups()
    assert int(node) > 4
    assert float(depth) == pytest.approx(0.201, abs=1e-3)


def test_a_fine_needle_through_a_coarse_block_is_found():
    needle = moved(rectangle(1, 400, 1e-3, 4.0), (0.5, -1.5))
    node, place, depth = NODE.search(said(join(block=rectangle(2, 2), needle=needle))).groups()
    assert int(node) > 9
    assert 0.0 < numbers(place)[1] < 1.0
    assert float(depth) == pytest.approx(0.5, abs=2e-3)


def test_a_displacement_that_lays_bars_across_each_other_is_refused():
    mesh = join(a=FLAT, b=moved(UPRIGHT, (5.0, 0.0)))
    run = Run(contact_problem(mesh))
    displacement = np.where(np.arange(8)[:, None] < 4, 0.0, [-5.0, 0.0])
    run.set_motion(displacement, 0 * displacement)
    with pytest.raises(CoreError, match="of two parts cross"):
        run.advance(1)


def shared_area(p, q):
    """Area of what two convex polygons share, by cutting one at the edges of the other."""
    for a, b in zip(q, np.roll(q, -1, axis=0), strict=True):
        side = [(b - a)[0] * (x - a)[1] - (b - a)[1] * (x - a)[0] for x in p]
        kept = []
        for i, (x, s) in enumerate(zip(p, side, strict=True)):
            y, t = p[i - 1], side[i - 1]
            if s * t < 0.0:
                kept.append(y + t / (t - s) * (x - y))
            if s >= 0.0:
                kept.append(x)
        p = kept
        if len(p) < 3:
            return 0.0
    x, y = np.transpose(p)
    return 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def of_triangles(corners):
    """A mesh of triangles, each a part of its own."""
    nodes = np.reshape(corners, (-1, 2))
    triangles = np.arange(len(nodes), dtype=np.int32).reshape(-1, 3)
    return Mesh(nodes, triangles, np.zeros(len(triangles), np.int32), ("rock",))


def test_two_random_triangles_are_refused_where_they_share_an_area(n_random):
    rng = np.random.default_rng(0)
    met = apart = 0
    for _ in range(n_random(400, least=100)):
        size = 10.0 ** rng.uniform(-2, 0, 2)
        pair = rng.random((2, 3, 2)) * size[:, None, None]
        pair[1] += pair[0].mean(axis=0) - pair[1].mean(axis=0) + rng.normal(0, 0.4 * size.max(), 2)
        for corner in pair:
            if np.linalg.det(corner[1:] - corner[0]) < 0.0:
                corner[:] = corner[::-1]
        if min(np.linalg.det(corner[1:] - corner[0]) for corner in pair) < 1e-7:
            continue
        area = shared_area(*pair)
        words = said(of_triangles(pair))
        assert bool(words) == (area > 0.0) or 0.0 < area < 1e-5
        met, apart = met + bool(words), apart + (not words)
    assert min(met, apart) > 10


@pytest.mark.parametrize("seed", range(4))
def test_one_pair_among_many_of_all_sizes_is_found(seed):
    """Triangles in cells of sizes from 1 to 1000, one of them moved onto a neighbour."""
    rng = np.random.default_rng(seed)
    n = 14
    lines = np.concatenate([[0.0], np.cumsum(10.0 ** rng.uniform(0, 3, n))])
    inside = np.array([[0.1, 0.1], [0.9, 0.2], [0.3, 0.9]])
    corners = np.array(
        [
            [lines[i], lines[j]] + inside * [lines[i + 1] - lines[i], lines[j + 1] - lines[j]]
            for i in range(n)
            for j in range(n)
        ]
    )
    assert said(of_triangles(corners)) == ""
    one, other = (int(k) for k in rng.choice(n * n, 2, replace=False))
    corners[one] += corners[other].mean(axis=0) - corners[one].mean(axis=0)
    words = said(of_triangles(corners))
    found = NODE.search(words)
    named = (
        [(int(found[1]) - 1) // 3]
        if found
        else [int(k) - 1 for k in ELEMENTS.search(words).groups()[:2]]
    )
    met = [k for k in range(n * n) if k != one and shared_area(corners[one], corners[k]) > 0.0]
    assert set(named) <= {one, *met}


def test_parts_of_one_body_are_held_apart_too():
    mesh = join(a=FLAT, b=UPRIGHT)
    assert said(replace(mesh, body=0 * mesh.body, body_names=("rock",)))


def test_depth_is_counted_in_the_shortest_edge_of_the_boundary():
    """A fine block elsewhere makes the same overlap too deep."""
    floor, block = rectangle(2, 2), moved(rectangle(2, 2), (0.1, 1.0 - 1e-4))
    mesh = join(floor=floor, block=block)
    assert boundary_of(mesh)[1] == pytest.approx(0.5)
    assert said(mesh) == ""
    assert said(join(floor=floor, block=block, fine=moved(rectangle(20, 20), (5.0, 0.0))))
