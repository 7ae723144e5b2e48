"""Zones around a hole end where they are said to (analysis/hole_cracks.py)."""

import numpy as np
import pytest

from lithofrac.analysis.hole_cracks import zoned_cracks
from lithofrac.analysis.runs import Run

pytestmark = pytest.mark.no_core


def at(radius, degrees):
    """Position in radii at an angle to the load axis, y."""
    return radius * np.sin(np.radians(degrees)), radius * np.cos(np.radians(degrees))


@pytest.mark.parametrize(
    ("radius", "degrees", "mode", "zone"),
    [
        (2.95, 10.0, "tensile", "primary"),
        (3.05, 10.0, "tensile", ""),
        (1.1, 19.0, "tensile", "primary"),
        (1.1, 21.0, "tensile", ""),  # too near the wall for a remote one
        (1.25, 45.0, "tensile", ""),
        (1.35, 45.0, "tensile", "remote"),
        (2.95, 45.0, "tensile", "remote"),
        (3.05, 45.0, "tensile", ""),
        (2.0, 69.0, "tensile", "remote"),
        (2.0, 71.0, "tensile", ""),
        (1.25, 71.0, "compressive_dilation", "sidewall"),
        (1.25, 90.0, "tensile", "sidewall"),
        (1.35, 90.0, "tensile", ""),
        (2.0, 90.0, "compressive_dilation", ""),
        (2.0, 10.0, "compressive_dilation", ""),
        (2.0, 45.0, "compressive_dilation", ""),
    ],
)
def test_crack_is_of_a_zone_by_distance_angle_and_mode(make_hole, radius, degrees, mode, zone):
    folder = make_hole("hole_r25.0", cracks=[(12.0, *at(radius, degrees), mode)])
    (found,) = zoned_cracks(Run(folder))["zone"]
    assert found == zone
