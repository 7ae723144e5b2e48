"""Stages A to D of a curve (analysis/stages.py)."""

import numpy as np
import pytest

from lithofrac.analysis.stages import (
    Stages,
    brittleness,
    final_fall,
    find_stages,
    plateau,
)

pytestmark = pytest.mark.no_core


def curve(*knots):
    """Straight lines between knots (strain, stress), strain in steps of 0.01."""
    strain = np.linspace(0.0, knots[-1][0], round(100 * knots[-1][0]) + 1)
    return strain, np.interp(strain, *zip(*knots, strict=True))


PUNCH = [(0, 0), (1, 100), (2, 60), (3, 90), (4, 20), (5, 25)]


def test_stages_are_the_knots_of_a_curve_that_has_them_all():
    assert find_stages(*curve(*PUNCH)) == Stages(100, 200, 300, 400, pytest.approx(0.3))


def test_curve_that_falls_for_good_has_no_c_and_its_lowest_stress_is_b_and_d():
    stages = find_stages(*curve((0, 0), (1, 100), (2, 20), (3, 20)))
    assert (stages.a, stages.b, stages.c, stages.d) == (100, 200, None, 200)
    assert stages.regain == 0.0


@pytest.mark.parametrize(("risen", "c"), [(62.9, None), (63.1, 300)])
def test_regain_counts_from_three_percent_of_the_first_peak_on(risen, c):
    assert find_stages(*curve((0, 0), (1, 100), (2, 60), (3, risen), (4, 20))).c == c


def test_what_is_regained_after_complete_failure_is_no_stage():
    stages = find_stages(*curve((0, 0), (1, 100), (2, 20), (3, 40), (4, 10)))
    assert (stages.b, stages.c, stages.d) == (200, None, 200)


@pytest.mark.parametrize(("risen", "d"), [(40.9, 400), (41.1, 200)])
def test_rise_of_one_percent_of_the_first_peak_ends_the_fall_to_d(risen, d):
    """A 100; below half at 40, then a ripple, then lower still."""
    assert find_stages(*curve((0, 0), (1, 100), (2, 40), (3, risen), (4, 10))).d == d


def test_curve_that_keeps_half_of_its_peak_has_no_complete_failure():
    stages = find_stages(*curve((0, 0), (1, 100), (2, 60), (3, 80)))
    assert (stages.b, stages.c, stages.d) == (200, 300, None)


@pytest.mark.parametrize(("least", "d"), [(50.5, None), (49.5, 200)])
def test_failure_is_complete_when_less_than_half_of_the_peak_is_left(least, d):
    assert find_stages(*curve((0, 0), (1, 100), (2, least), (3, least))).d == d


def test_stages_scale_with_the_stress_and_not_with_the_strain():
    strain, stress = curve(*PUNCH)
    assert find_stages(3.0 * strain, 7.0 * stress) == find_stages(strain, stress)


def test_curve_that_never_falls_has_no_stage():
    stages = find_stages(*curve((0, 0), (1, 100)))
    assert (stages.a, stages.b, stages.c, stages.d) == (None,) * 4
    assert np.isnan(stages.regain)


def test_plateau_of_a_sharp_peak_is_a_twentieth_and_that_of_a_flat_top_is_its_length():
    """A straight rise is within 5 % over its last twentieth; a fall of 100 over 0.01 adds none."""
    assert plateau(*curve((0, 0), (1, 100), (1.01, 0))) == pytest.approx(0.05)
    assert plateau(*curve((0, 0), (1, 100), (1.5, 100), (1.51, 0))) == pytest.approx(0.55)


def test_falls_count_to_half_of_the_peak():
    """The line from 100 to 0 over a strain of 1 passes 95 at 0.05 and 50 at 0.5 of it."""
    line = curve((0, 0), (1, 100), (2, 0))
    assert brittleness(*line) == pytest.approx(0.51)  # first row below half
    assert final_fall(*line) == pytest.approx(0.46)
    assert brittleness(*curve((0, 0), (1, 100), (2, 60))) == float("inf")
