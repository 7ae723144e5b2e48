"""Coulomb contact of one pair in closed form (fortran/contact/friction.f90)."""

import numpy as np
import pytest

from lithofrac.kernels import pair_impulse

NORMAL = np.array([[0.0], [1.0]])


def turned(angle):
    return np.array([[np.sin(angle)], [np.cos(angle)]])


def velocity_after(d0, compliance, impulse):
    return d0 + compliance * impulse


def test_a_pair_that_separates_feels_nothing():
    np.testing.assert_array_equal(pair_impulse([3.0, 1.0], NORMAL, [0.0], 0.5, [1, 1]), [0, 0])


def test_an_open_pair_may_close_its_gap_and_no_more():
    free = pair_impulse([0.0, -0.4], NORMAL, [0.5], 0.5, [1, 1])
    np.testing.assert_array_equal(free, [0, 0])
    impulse = pair_impulse([0.0, -0.7], NORMAL, [0.5], 0.0, [1, 2])
    np.testing.assert_allclose(impulse, [0, 0.1])
    assert velocity_after(-0.7, 2.0, impulse[1]) == pytest.approx(-0.5)


def test_below_the_cone_the_pair_sticks_without_creep():
    d0 = np.array([0.2, -1.0])
    impulse = pair_impulse(d0, NORMAL, [0.0], 0.3, [1, 1])
    np.testing.assert_allclose(velocity_after(d0, 1.0, impulse), 0.0, atol=1e-16)


def test_beyond_the_cone_friction_is_mu_times_pressure_against_the_slip():
    impulse = pair_impulse([0.9, -1.0], NORMAL, [0.0], 0.3, [1, 1])
    np.testing.assert_allclose(impulse, [-0.3, 1.0])


def test_one_face_meets_signorini_and_coulomb_for_random_input():
    rng = np.random.default_rng(1)
    slid = stuck = 0
    for _ in range(500):
        normal = turned(rng.uniform(0, 2 * np.pi))
        tangent = np.array([-normal[1, 0], normal[0, 0]])
        d0, bias, mu = rng.normal(size=2), rng.normal() * 0.5, rng.uniform(0, 1.5)
        w = np.full(2, rng.uniform(0.1, 3))
        p = pair_impulse(d0, normal, [bias], mu, w)
        d, pressure, friction = velocity_after(d0, w, p), p @ normal[:, 0], p @ tangent
        gap_rate = d @ normal[:, 0] + bias
        assert gap_rate >= -1e-13
        assert pressure >= -1e-13
        assert abs(gap_rate * pressure) < 1e-12
        assert abs(friction) <= mu * pressure + 1e-12
        if pressure > 1e-9 and abs(friction) < mu * pressure * (1 - 1e-9):
            stuck += 1
            assert abs(d @ tangent) < 1e-12
        elif pressure > 1e-9:
            slid += 1
            assert friction * (d @ tangent) <= 1e-12
    assert slid > 50
    assert stuck > 50


def test_two_frictionless_faces_hold_together_or_alone():
    """A node in a right-angled corner: each component is its own contact."""
    normals = np.array([[1.0, 0.0], [0.0, 1.0]])
    rng = np.random.default_rng(2)
    for d0 in rng.normal(size=(200, 2)):
        impulse = pair_impulse(d0, normals, [0.0, 0.0], 0.0, [2.0, 0.5])
        np.testing.assert_allclose(impulse, np.maximum(0.0, -d0 / [2.0, 0.5]), atol=1e-15)


def test_two_faces_are_never_entered():
    rng = np.random.default_rng(3)
    for _ in range(500):
        angle = rng.uniform(0, 2 * np.pi)
        normals = np.hstack([turned(angle), turned(angle + rng.uniform(0.1, 2.5))])
        d0, bias = rng.normal(size=2), rng.uniform(0, 0.3, 2)
        w = np.full(2, rng.uniform(0.1, 3))
        p = pair_impulse(d0, normals, bias, rng.uniform(0, 1.2), w)
        assert np.all(velocity_after(d0, w, p) @ normals + bias >= -1e-11)


def test_unequal_compliance_still_closes_the_face():
    """One component prescribed (almost no compliance): friction is what it can be."""
    normal = turned(0.3)
    p = pair_impulse([0.5, -1.0], normal, [0.0], 0.4, [1.0, 1e-9])
    d = velocity_after(np.array([0.5, -1.0]), np.array([1.0, 1e-9]), p)
    assert d @ normal[:, 0] == pytest.approx(0.0, abs=1e-9)
