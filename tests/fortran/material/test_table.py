"""Softening tables (fortran/material/table.f90)."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lithofrac.errors import CoreError
from lithofrac.kernels import table_eval

STRAIN = [0.0, 0.002, 0.008, 0.01]
COHESION = [20e6, 16e6, 4e6, 0.0]  # sandstone, Klerck 2004, Table 1 [Pa]


def test_value_is_exact_at_the_table_points():
    value, _ = table_eval(STRAIN, COHESION, STRAIN)
    np.testing.assert_array_equal(value, COHESION)


def test_value_is_linear_between_the_points():
    value, slope = table_eval(STRAIN, COHESION, [0.001, 0.005])
    np.testing.assert_allclose(value, [18e6, 10e6], rtol=1e-14)
    np.testing.assert_allclose(slope, [-2e9, -2e9], rtol=1e-14)


def test_table_is_flat_beyond_both_ends():
    value, slope = table_eval([0.1, 0.2], [3.0, 5.0], [-1.0, 0.0999, 0.2, 7.0])
    np.testing.assert_array_equal(value, [3.0, 3.0, 5.0, 5.0])
    np.testing.assert_array_equal(slope, 0.0)


def test_slope_at_a_kink_is_that_of_the_right_segment():
    _, slope = table_eval([0.0, 1.0, 2.0], [0.0, 1.0, 4.0], [1.0])
    assert slope[0] == 3.0


def test_one_point_is_a_constant():
    value, slope = table_eval([0.5], [2.0], [0.0, 0.5, 1.0])
    np.testing.assert_array_equal(value, 2.0)
    np.testing.assert_array_equal(slope, 0.0)


@given(st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=64, unique=True), st.data())
def test_table_agrees_with_numpy(knots, data):
    knots = np.sort(knots)
    if np.diff(knots).min() < 1e-9:  # the slope of a shorter segment is mostly rounding
        return
    values = data.draw(st.lists(st.floats(-1e3, 1e3), min_size=len(knots), max_size=len(knots)))
    at = np.linspace(-1.2, 1.2, 97)
    np.testing.assert_allclose(
        table_eval(knots, values, at)[0], np.interp(at, knots, values), atol=1e-9
    )


@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        ([0.0, 0.0], [1.0, 2.0], "x must increase strictly"),
        ([1.0, 0.0], [1.0, 2.0], "x must increase strictly"),
        ([0.0, np.nan], [1.0, 2.0], "every number must be finite"),
        ([0.0, 1.0], [1.0, np.inf], "every number must be finite"),
        (np.arange(65.0), np.ones(65), "more than 64 knots"),
    ],
)
def test_numbers_that_make_no_table_are_refused(x, y, message):
    with pytest.raises(CoreError, match=f"^table: {message}$"):
        table_eval(x, y, [0.0])
