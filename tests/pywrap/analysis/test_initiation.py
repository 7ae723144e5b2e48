"""Change of curvature of a gauge (analysis/initiation.py)."""

import numpy as np
import pytest

from lithofrac.analysis.initiation import CONFIDENCE, find_kink

pytestmark = pytest.mark.no_core
SLOPE = 50e-6  # strain per MPa of a gauge on rock
AT = 6.0  # MPa, the kink of the synthetic curves
STRESS = np.linspace(0.0, 24.0, 240)


def strain(kind, stress=STRESS, at=AT):
    """Gauges: straight to `at`, then as the name says."""
    beyond = np.maximum(stress - at, 0.0)
    return (
        SLOPE * stress
        + {
            "straight": 0.0 * beyond,
            "softening": 60e-6 * beyond,
            "hardening": -25e-6 * beyond,
            "reversal": -90e-6 * beyond,
            "bend": 15e-6 * beyond**2,
            "far from straight": 60e-6 * beyond + 40e-6 * np.maximum(stress - 11.0, 0.0) ** 2,
        }[kind]
    )


def noisy(kind, noise, seed, **keys):
    clean = strain(kind, **keys)
    return clean + noise * np.random.default_rng(seed).normal(size=clean.size)


SHARP = ["softening", "hardening", "reversal", "far from straight"]


@pytest.mark.parametrize("kind", SHARP)
def test_kink_without_noise_is_exact(kind):
    kink = find_kink(STRESS, strain(kind))
    assert kink.stress == pytest.approx(AT, abs=1e-3)
    assert kink.low <= kink.stress <= kink.high
    assert kink.slope_before == pytest.approx(SLOPE, rel=1e-6)


def test_compressive_gauge_is_the_mirror_of_a_tensile_one():
    up = find_kink(STRESS, noisy("softening", 5e-6, 1))
    down = find_kink(STRESS, -noisy("softening", 5e-6, 1))
    assert (down.stress, down.low, down.high) == (up.stress, up.low, up.high)
    assert down.slope_after == pytest.approx(-up.slope_after)


def test_slopes_and_strain_at_the_kink_come_back():
    kink = find_kink(STRESS, noisy("softening", 2e-6, 3))
    assert kink.slope_before == pytest.approx(SLOPE, rel=0.05)
    assert kink.slope_after == pytest.approx(SLOPE + 60e-6, rel=0.05)
    assert kink.strain == pytest.approx(SLOPE * AT, rel=0.05)


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_units_of_strain_change_nothing(factor):
    curve = noisy("softening", 5e-6, 2)
    kink, scaled = find_kink(STRESS, curve), find_kink(STRESS, factor * curve)
    assert scaled.stress == pytest.approx(kink.stress, rel=1e-6)


@pytest.mark.parametrize("noise", [0.0, 1e-6, 1e-5, 1e-4])
def test_straight_curve_has_no_kink(noise):
    """60 curves; the F-test alone would give one in 10 000 per window."""
    found = [find_kink(STRESS, noisy("straight", noise, seed)) for seed in range(60)]
    assert found.count(None) >= 59


def test_curve_that_is_all_noise_has_no_kink():
    random = np.random.default_rng(4)
    found = [find_kink(STRESS, random.normal(size=STRESS.size)) for _ in range(30)]
    assert found.count(None) >= 29


def test_ringing_is_not_taken_for_a_kink():
    """Platens that ring make neighbours go together; as white noise they would pass the F-test."""
    for period in (1.5, 3.0, 6.0):
        ringing = 5e-6 * np.sin(2 * np.pi * STRESS / period)
        assert find_kink(STRESS, strain("straight") + ringing, resolution=3e-6) is None


def test_kink_below_the_resolution_of_the_gauge_is_not_seen():
    """It departs by 18 x 5e-6 = 90 microstrain at the end."""
    curve = SLOPE * STRESS + 6e-6 * np.maximum(STRESS - AT, 0.0)
    assert find_kink(STRESS, curve, resolution=1e-6) is not None
    assert find_kink(STRESS, curve, resolution=1e-4) is None


def test_change_of_slope_below_a_tenth_is_none():
    curve = SLOPE * (STRESS + 0.08 * np.maximum(STRESS - AT, 0.0))
    assert find_kink(STRESS, curve) is None


@pytest.mark.parametrize(("kind", "noise"), [("softening", 1e-6), ("softening", 1e-5),
                                             ("hardening", 5e-6), ("reversal", 2e-5)])  # fmt: skip
def test_interval_holds_the_true_kink_as_often_as_it_says(kind, noise):
    """100 curves; 95 % within four standard errors of a count, or a little above."""
    kinks = [find_kink(STRESS, noisy(kind, noise, seed)) for seed in range(100)]
    hits = np.mean([kink.low <= AT <= kink.high for kink in kinks])
    assert hits >= CONFIDENCE - 4 * np.sqrt(CONFIDENCE * (1 - CONFIDENCE) / 100)


def test_interval_is_no_wider_than_it_has_to_be():
    """Six times the scatter of the kinks at most; 3.9 would be exact for a normal scatter."""
    kinks = [find_kink(STRESS, noisy("softening", 1e-5, seed)) for seed in range(80)]
    scatter = np.std([kink.stress for kink in kinks])
    assert np.mean([kink.high - kink.low for kink in kinks]) < 6.0 * scatter


def test_uncertainty_grows_with_noise_and_falls_with_points():
    def width(noise, n):
        stress = np.linspace(0.0, 24.0, n)
        kinks = [find_kink(stress, noisy("softening", noise, s, stress=stress)) for s in range(20)]
        return np.mean([kink.high - kink.low for kink in kinks])

    assert width(2e-5, 240) == pytest.approx(2.0 * width(1e-5, 240), rel=0.3)
    assert width(1e-5, 960) == pytest.approx(0.5 * width(1e-5, 240), rel=0.3)


def test_later_bends_do_not_pull_the_kink():
    """Two lines through the whole record meet far beyond the true kink."""
    kinks = [find_kink(STRESS, noisy("far from straight", 1e-6, seed)) for seed in range(20)]
    assert np.mean([kink.stress for kink in kinks]) == pytest.approx(AT, abs=0.02)
    assert all(kink.window < 14.0 for kink in kinks)


def test_smooth_bend_is_found_where_it_leaves_the_noise():
    """A parabola 15e-6 d^2 has left the noise of 1 microstrain by d = 0.26 MPa."""
    kinks = [find_kink(STRESS, noisy("bend", 1e-6, seed)) for seed in range(20)]
    late = np.array([kink.stress for kink in kinks]) - AT
    assert np.all(late > 0.0) and np.all(late < 1.0)


def test_lower_noise_brings_a_smooth_bend_to_its_beginning():
    def late(noise):
        return find_kink(STRESS, strain("bend"), resolution=noise).stress - AT

    assert 0.0 < late(1e-7) < late(1e-6) < late(1e-5)


def test_kink_near_the_end_is_found():
    kink = find_kink(STRESS, noisy("softening", 1e-6, 5, at=23.0))
    assert kink.low <= 23.0 <= kink.high


def test_kink_near_the_start_is_found():
    kink = find_kink(STRESS, noisy("softening", 1e-6, 5, at=1.4))
    assert kink.low <= 1.4 <= kink.high


def test_uneven_records_give_the_same_kink():
    """A smooth start of the load bunches the records there."""
    stress = 24.0 * np.linspace(0.0, 1.0, 400) ** 1.6
    kink = find_kink(stress, noisy("softening", 2e-6, 6, stress=stress))
    assert kink.low <= AT <= kink.high


def test_what_comes_after_the_largest_stress_does_not_count():
    stress = np.concatenate([STRESS, np.linspace(24.0, 2.0, 100)])
    curve = np.concatenate([strain("straight"), np.linspace(1.2e-3, 9e-3, 100)])
    assert find_kink(stress, curve) is None


def test_ripples_of_the_stress_do_no_harm():
    stress = STRESS + 0.05 * np.sin(40.0 * STRESS)
    kink = find_kink(stress, strain("softening", stress=stress))
    assert kink.stress == pytest.approx(AT, abs=0.05)


@pytest.mark.parametrize("n", [0, 1, 5, 11])
def test_few_points_have_no_kink(n):
    stress = np.linspace(0.0, 24.0, n)
    assert find_kink(stress, strain("softening", stress=stress)) is None


def test_few_points_are_enough_for_a_sharp_kink():
    stress = np.linspace(0.0, 24.0, 25)
    kink = find_kink(stress, noisy("softening", 1e-6, 7, stress=stress))
    assert kink.low <= AT <= kink.high


def test_curve_without_load_has_no_kink():
    assert find_kink(np.zeros(100), np.zeros(100)) is None


def test_lengths_that_differ_are_refused():
    with pytest.raises(ValueError, match="as many"):
        find_kink(STRESS, STRESS[1:])
