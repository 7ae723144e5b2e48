"""When ramps start and how long they last, so that a specimen is loaded without a jolt."""

from dataclasses import dataclass

from scipy.optimize import brentq

from lithofrac.problem import Ramp


@dataclass(frozen=True)
class Timing:
    """Ramps of a test with prescribed end velocities.

    Attributes
    ----------
    ends : ramp of the velocity of the ends
    confinement : ramp of the lateral pressure
    start_time : axial loading proper starts, the confinement is complete [s]
    end_time : the end strain is reached [s]
    """

    ends: Ramp
    confinement: Ramp
    start_time: float
    end_time: float


def velocity_timing(rate: float, ramp: float, end_strain: float, preload: float = 0.0) -> Timing:
    """Start the ends so that they have gone `preload` when the confinement is complete.

    Choice: ends and lateral pressure start within one ramp of each other instead of one after the
    other. The axial stress then equals the confinement at `start_time`, as in a pressure cell,
    and no velocity has to change twice.

    Parameters
    ----------
    rate : axial strain rate at full speed [1/s]
    ramp : shortest duration of a ramp [s]
    end_strain : axial strain after `start_time` [-]
    preload : axial strain under the confinement alone, compression positive [-]
    """
    end = ramp / 2 + (preload + end_strain) / rate
    if preload == 0.0:
        return Timing(Ramp(0.0, ramp), Ramp(0.0, ramp), 0.0, end)
    lead = time_to_go(preload / rate, ramp)
    full = max(ramp, lead)
    start = full - lead
    return Timing(Ramp(start, ramp), Ramp(0.0, full), full, start + end)


def time_to_go(distance: float, ramp: float) -> float:
    """Time [s] in which a smooth start of duration `ramp` covers `distance` / full speed [s]."""
    if distance >= ramp / 2:
        return distance + ramp / 2
    # integral of 6 s^5 - 15 s^4 + 10 s^3 from 0 to s, which is 1/2 at s = 1
    return ramp * brentq(
        lambda s: s**4 * (2.5 - 3 * s + s * s) - distance / ramp, 0.0, 1.0, xtol=1e-14
    )
