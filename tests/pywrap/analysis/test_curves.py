"""Distance of curves (analysis/curves.py)."""

import numpy as np
import pytest

from lithofrac.analysis.curves import compare

pytestmark = pytest.mark.no_core
X = np.linspace(0.0, 1.0, 11)


def test_curve_has_no_distance_from_points_on_it():
    error = compare(X, 3 * X, [0.25, 0.8], [0.75, 2.4])
    assert error.rms == pytest.approx(0.0, abs=1e-15)
    assert (error.points, error.left_out) == (2, 0)


def test_constant_offset_is_the_rms_and_relative_to_the_largest_reference():
    error = compare(X, 100 * X + 5, X, 100 * X)
    assert error.rms == pytest.approx(5.0)
    assert error.rms_relative == pytest.approx(0.05)
    assert error.max_relative == pytest.approx(0.05)


def test_rms_and_largest_difference_of_two_points():
    error = compare([0.0, 1.0], [0.0, 0.0], [0.0, 1.0], [3.0, -4.0])
    assert error.rms == pytest.approx(np.sqrt(12.5))
    assert error.max_relative == 1.0


def test_points_beyond_the_curve_are_left_out_and_counted():
    error = compare(X, X, [-1.0, 0.5, 2.0], [9.0, 0.5, 9.0])
    assert error.rms == 0.0
    assert (error.points, error.left_out) == (1, 2)


def test_order_of_the_points_of_a_curve_does_not_matter():
    assert compare(X[::-1], X[::-1], X, X + 1) == compare(X, X, X, X + 1)


def test_curves_that_do_not_overlap_are_refused():
    with pytest.raises(ValueError, match="no reference point lies within"):
        compare(X, X, [2.0], [1.0])


def test_reference_without_a_scale_is_refused():
    with pytest.raises(ValueError, match="all reference values are 0"):
        compare(X, X, X, 0 * X)
