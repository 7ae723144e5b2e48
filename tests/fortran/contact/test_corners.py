"""Two wedges of material at one place (fortran/contact/corners.f90)."""

import numpy as np
import pytest

from lithofrac.kernels import CORNER_KINDS, corner_kind


def wedge(start, width):
    """Unit tangents into and out of a node whose material spans `width` from angle `start`."""
    out = np.array([np.cos(start), np.sin(start)])
    back = np.array([np.cos(start + width), np.sin(start + width)])
    return [-back, out]


def kind_of(first, second):
    kind, faces, _ = corner_kind(np.array([*first, *second]).T)
    return CORNER_KINDS[kind], list(faces)


@pytest.mark.parametrize("turn", np.linspace(0.0, 6.0, 13))
def test_the_faces_of_a_fresh_flat_crack_are_one_face(turn):
    kind, _ = kind_of(wedge(turn, np.pi), wedge(turn + np.pi, np.pi))
    assert kind == "flat"


@pytest.mark.parametrize("turn", np.linspace(0.0, 6.0, 13))
def test_a_convex_tip_in_its_own_notch_has_both_faces_of_the_notch(turn):
    assert kind_of(wedge(turn, 2.0), wedge(turn + 2.0, 2 * np.pi - 2.0)) == ("both", [3, 4])
    assert kind_of(wedge(turn, 2 * np.pi - 2.0), wedge(turn - 2.0, 2.0)) == ("both", [1, 2])


@pytest.mark.parametrize("turn", np.linspace(0.0, 6.0, 13))
def test_two_convex_tips_may_part_along_any_line_between_them(turn):
    """Gap of 0.4 on one side: lines between the facing edges."""
    kind, faces = kind_of(wedge(turn, 1.0), wedge(turn + 1.4, 1.0))
    assert kind == "any"
    assert faces == [1, 4]


def test_six_pieces_round_a_point_have_two_neighbours_each():
    width = np.pi / 3
    pieces = [wedge(i * width, width) for i in range(6)]
    for i in range(6):
        for j in range(6):
            if i != j:
                near = (i - j) % 6 in (1, 5)
                *_, neighbours = corner_kind(np.array([*pieces[i], *pieces[j]]).T)
                assert neighbours == near


def test_a_tip_in_a_notch_has_nothing_beside_it():
    """However narrow the tip: the notch itself keeps others out."""
    *_, neighbours = corner_kind(np.array([*wedge(1.3, 0.5), *wedge(np.pi, np.pi + 0.6)]).T)
    assert neighbours
    *_, neighbours = corner_kind(np.array([*wedge(1.3, 0.5), *wedge(np.pi, np.pi)]).T)
    assert not neighbours


def test_wedges_that_overlap_meet_elsewhere():
    assert kind_of(wedge(0.0, 4.0), wedge(1.0, 4.0))[0] == "none"


def test_the_kind_does_not_depend_on_the_order_of_the_nodes():
    rng = np.random.default_rng(1)
    for _ in range(200):
        start, first, gap = rng.uniform(0, 6), rng.uniform(0.3, 3.0), rng.uniform(0.0, 0.4)
        second = rng.uniform(0.3, 2 * np.pi - first - gap)
        a, b = wedge(start, first), wedge(start + first + gap, second)
        assert kind_of(a, b)[0] == kind_of(b, a)[0]
