"""Ramps of confined tests (pywrap/lithofrac/scenes/_timing.py)."""

import numpy as np
import pytest

from lithofrac.scenes._timing import velocity_timing

pytestmark = pytest.mark.no_core

RATE, RAMP = 6.0, 4e-5


def strain_at(timing, time):
    """Axial strain from the ramp of the ends, by quadrature."""
    t = np.linspace(0.0, time, 200_001)
    s = np.clip((t - timing.ends.start) / timing.ends.duration, 0.0, 1.0)
    return RATE * np.trapezoid(s**3 * (10 + s * (6 * s - 15)), t)


@pytest.mark.parametrize("preload", [1e-7, 1e-5, 1.1e-4, 1.3e-4, 6e-4])
def test_ends_have_gone_the_preload_when_the_confinement_is_complete(preload):
    timing = velocity_timing(RATE, RAMP, 0.01, preload)
    confined = timing.confinement.start + timing.confinement.duration
    assert confined == timing.start_time
    assert strain_at(timing, timing.start_time) == pytest.approx(preload, rel=1e-6)


@pytest.mark.parametrize("preload", [0.0, 1e-5, 6e-4])
def test_the_end_strain_is_counted_from_the_end_of_the_confinement(preload):
    timing = velocity_timing(RATE, RAMP, 0.01, preload)
    gone = strain_at(timing, timing.end_time) - strain_at(timing, timing.start_time)
    assert gone == pytest.approx(0.01, rel=1e-6)


@pytest.mark.parametrize("preload", [0.0, 1e-5, 6e-4])
def test_no_ramp_is_shorter_than_asked_and_none_starts_before_the_run(preload):
    timing = velocity_timing(RATE, RAMP, 0.01, preload)
    assert min(timing.ends.duration, timing.confinement.duration) >= RAMP
    assert min(timing.ends.start, timing.confinement.start) >= 0.0


def test_without_confinement_loading_starts_at_once():
    assert velocity_timing(RATE, RAMP, 0.01).start_time == 0.0
