"""Size law of the initiation stress (analysis/size_law.py)."""

import numpy as np
import pytest

from lithofrac.analysis.size_law import fit_size_law

pytestmark = pytest.mark.no_core
RADII = np.array([1.6, 3.2, 6.4, 9.5, 12.7, 16.3, 19.1, 25.0, 31.0])


def law(asymptote, length, power):
    return asymptote * (1.0 + length / RADII) ** power


@pytest.mark.parametrize("power", [0.5, 1.0])
def test_law_without_noise_comes_back(power):
    fit = fit_size_law(RADII, law(6.0, 12.0, power))
    assert fit.power == power
    assert fit.asymptote == pytest.approx(6.0, rel=1e-4)
    assert fit.length == pytest.approx(12.0, rel=1e-3)
    assert fit.note == ""
    np.testing.assert_allclose(fit.at(RADII), law(6.0, 12.0, power), rtol=1e-5)


def test_constant_is_its_own_asymptote():
    fit = fit_size_law(RADII, np.full(RADII.size, 9.7))
    assert fit.asymptote == pytest.approx(9.7, rel=1e-4)
    assert fit.length == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("power", [0.5, 1.0])
def test_pure_power_law_has_no_asymptote(power):
    fit = fit_size_law(RADII, 100.0 * RADII**-power)
    assert fit.note.startswith("asymptote not determined")
    assert np.isnan(fit.length)


def test_noise_that_hides_the_asymptote_is_said():
    random = np.random.default_rng(2)
    noise = np.exp(random.normal(0.0, 0.3, RADII.size))
    fit = fit_size_law(RADII, law(1.0, 200.0, 0.5) * noise)
    assert fit.note.startswith("asymptote not determined")


def test_interval_holds_the_asymptote_as_often_as_it_says():
    """200 laws with 3 % noise; 95 % within four standard errors of a count, the interval is
    linear and the power is chosen by the data."""
    random = np.random.default_rng(1)
    hits = 0
    for _ in range(200):
        fit = fit_size_law(RADII, law(6.0, 6.0, 1.0) * (1 + random.normal(0.0, 0.03, RADII.size)))
        hits += fit.low <= 6.0 <= fit.high
    assert hits / 200 >= 0.95 - 4 * np.sqrt(0.95 * 0.05 / 200)


def test_three_radii_are_too_few():
    assert fit_size_law(RADII[:3], RADII[:3]) is None
