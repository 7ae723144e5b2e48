"""Pareto front, order, chance and distance on points with known answers (analysis/front.py)."""

import numpy as np
import pytest

from lithofrac.analysis.front import (
    cheapest,
    distance,
    observed_order,
    pareto_front,
    safe_error,
)

pytestmark = pytest.mark.no_core

COST = np.array([1.0, 2.0, 4.0, 8.0, 3.0, 8.0])
ERROR = np.array([9.0, 5.0, 5.0, 1.0, 7.0, 2.0])


def test_front_holds_what_nothing_is_better_than():
    assert list(pareto_front(COST, ERROR)) == [0, 1, 3]


def test_front_leaves_out_runs_without_a_number():
    assert list(pareto_front([1.0, np.nan, 2.0], [np.nan, 1.0, 3.0])) == [2]
    assert list(pareto_front([], [])) == []


def test_front_takes_the_better_of_two_that_cost_the_same():
    assert list(pareto_front([1.0, 1.0], [2.0, 1.0])) == [1]


@pytest.mark.parametrize("order", [1.0, 2.0, 0.5])
def test_order_is_that_of_a_power(order):
    size = np.array([4.0, 1.0, 2.0])
    assert observed_order(size, 3.0 * size**order) == pytest.approx(order, abs=1e-12)


def test_order_needs_two_errors_above_zero():
    assert np.isnan(observed_order([1.0, 2.0], [0.0, 1.0]))
    assert observed_order([1.0, 2.0, 4.0], [0.0, 1.0, 2.0]) == pytest.approx(1.0)


def test_an_error_that_more_work_makes_larger_is_a_chance():
    work = [1.0, 2.0, 4.0, 8.0]
    np.testing.assert_array_equal(safe_error(work, [9.0, 0.1, 3.0, 2.0]), [9.0, 3.0, 3.0, 2.0])


def test_work_that_is_equal_is_no_chance_and_a_run_without_a_number_bars_the_cheaper_ones():
    np.testing.assert_array_equal(safe_error([1.0, 1.01], [1.0, 5.0]), [1.0, 5.0])
    np.testing.assert_array_equal(safe_error([1.0, 2.0], [1.0, np.nan]), [np.inf, np.nan])


def test_cheapest_meets_the_target():
    assert cheapest(COST, ERROR, 5.0) == 1
    assert cheapest(COST, ERROR, 0.5) is None
    assert cheapest(COST, np.where(ERROR == 9.0, np.nan, ERROR), 10.0) == 1


def test_distance_is_the_cost_over_the_least_for_the_same_aim():
    assert distance(COST, ERROR, default=3, target=5.0) == 4.0  # 8 s, where 2 s do
    assert distance(COST, ERROR, default=3, target=1.0) == 1.0  # nothing cheaper does
    assert distance(COST, ERROR, default=2, target=1.0) == 2.0  # misses it: its own error counts


def test_an_error_a_tenth_above_that_of_the_default_counts_as_equal():
    assert distance([1.0, 2.0], [2.19, 2.0], default=1, target=1.0) == 2.0
    assert distance([1.0, 2.0], [2.21, 2.0], default=1, target=1.0) == 1.0
