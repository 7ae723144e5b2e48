"""Fitted strength lines (analysis/fit.py)."""

import numpy as np
import pytest

from lithofrac.analysis.fit import fit_line

pytestmark = pytest.mark.no_core
P = np.array([0.0, 10.0, 20.0, 40.0, 80.0])


def test_exact_line_is_found_without_uncertainty():
    line = fit_line(P, 50.0 + 3.0 * P)
    assert (line.q, line.n) == (pytest.approx(50.0), pytest.approx(3.0))
    assert line.n_half == pytest.approx(0.0, abs=1e-12)
    assert line.left_out_rms == pytest.approx(0.0, abs=1e-12)


def test_cohesion_and_friction_come_back():
    """c = 10 MPa, phi = 30 degrees: N = 3, q = 20 sqrt 3."""
    line = fit_line(P, 20.0 * np.sqrt(3.0) + 3.0 * P)
    assert line.cohesion == pytest.approx(10.0)
    assert line.friction_deg == pytest.approx(30.0)


def test_interval_holds_the_truth_as_often_as_it_says():
    """2000 noisy lines; 95 % is met within three standard errors of a count."""
    random = np.random.default_rng(1)
    hits = 0
    for _ in range(2000):
        line = fit_line(P, 50.0 + 3.0 * P + random.normal(0.0, 5.0, P.size))
        hits += abs(line.n - 3.0) <= line.n_half
    assert hits / 2000 == pytest.approx(0.95, abs=3 * np.sqrt(0.95 * 0.05 / 2000))


def test_error_of_a_point_left_out_is_that_of_a_refit():
    strength = np.array([52.0, 77.0, 115.0, 168.0, 291.0])
    errors = []
    for i in range(P.size):
        slope, intercept = np.polyfit(np.delete(P, i), np.delete(strength, i), 1)
        errors.append((strength[i] - intercept - slope * P[i]) / strength[i])
    expected = np.sqrt(np.mean(np.square(errors)))
    assert fit_line(P, strength).left_out_rms == pytest.approx(expected, rel=1e-12)


def test_band_is_the_interval_of_the_intercept_at_no_confinement():
    line = fit_line(P, np.array([52.0, 77.0, 115.0, 168.0, 291.0]))
    assert line.half_width(0.0) == pytest.approx(line.q_half, rel=1e-12)


def test_two_points_are_refused():
    with pytest.raises(ValueError, match="at least 3"):
        fit_line([0.0, 1.0], [1.0, 2.0])
