"""First peaks of stress-strain curves (analysis/strength.py)."""

import numpy as np
import pytest

from lithofrac.analysis.strength import first_peak

pytestmark = pytest.mark.no_core
STRAIN = np.linspace(0.0, 1.0, 6)


def test_maximum_before_a_fall_of_three_percent_is_the_peak():
    peak = first_peak(STRAIN, [0.0, 50.0, 100.0, 96.9, 150.0, 200.0])
    assert (peak.strain, peak.stress, peak.index) == (0.4, 100.0, 2)


def test_fall_of_less_than_three_percent_is_no_peak():
    assert first_peak(STRAIN, [0.0, 50.0, 100.0, 97.1, 150.0, 200.0]) is None


def test_ripple_gives_way_to_the_higher_maximum_behind_it():
    assert first_peak(STRAIN, [0.0, 99.0, 98.0, 100.0, 60.0, 0.0]).index == 3


def test_curve_that_only_rises_has_no_peak():
    assert first_peak(STRAIN, 10.0 * STRAIN) is None


def test_first_of_two_peaks_counts_though_the_second_is_higher():
    assert first_peak(STRAIN, [0.0, 158.0, 101.0, 174.0, 100.0, 90.0]).stress == 158.0


def test_slow_fall_in_small_steps_counts_as_one_fall():
    stress = np.concatenate([np.linspace(0, 100, 50), np.linspace(100, 90, 500)])
    assert first_peak(np.arange(550.0), stress).stress == 100.0


def test_tension_has_no_peak():
    assert first_peak(STRAIN, -10.0 * STRAIN) is None


def test_peak_is_the_same_in_any_unit():
    stress = np.array([0.0, 50.0, 100.0, 60.0, 150.0, 200.0])
    assert first_peak(STRAIN, 1e6 * stress).index == first_peak(STRAIN, stress).index
