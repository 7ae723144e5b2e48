"""Cracks around a hole by zone: primary, remote, sidewall (Klerck 2004, Fig. 12a).

The hole is centred at the origin, the load runs along y.
"""

import numpy as np
import pandas as pd

from lithofrac.analysis.bands import angle_to_axis
from lithofrac.analysis.runs import Run

REMOTE_DEG = (20.0, 70.0)  # from the load axis, as the fan of gauges
REMOTE_RADII = (1.3, 3.0)  # over R
NEAR = {"primary": 3.0, "sidewall": 1.3}  # over R: what opens further out is of neither


def zoned_cracks(run: Run) -> pd.DataFrame:
    """Cracks of a run in the order of opening, with where they stand and the stress then.

    Primary and remote fractures open in tension (section 3.3); what compression opens where
    they stand belongs to the shear bands of the failing block, and to no zone.

    Columns beside those of `cracks.parquet`: `radius` of the middle over R, `side` (-1 left, 1
    right), `zone` (primary, remote, sidewall, or empty), `stress_MPa` on the block.
    """
    table, radius = run.cracks, hole_radius(run)
    middle = 0.5 * np.column_stack(
        [table["x1_mm"] + table["x2_mm"], table["y1_mm"] + table["y2_mm"]]
    )
    far, angle = np.linalg.norm(middle, axis=1) / radius, angle_to_axis(middle)
    low, high = REMOTE_DEG
    tensile = (table["mode"] == "tensile").to_numpy()
    remote = (angle >= low) & (angle <= high)
    remote &= (far >= REMOTE_RADII[0]) & (far <= REMOTE_RADII[1])
    zone = np.select(
        [
            tensile & (angle < low) & (far <= NEAR["primary"]),
            tensile & remote,
            (angle > high) & (far <= NEAR["sidewall"]),
        ],
        ["primary", "remote", "sidewall"],
        "",
    )
    history = run.history
    stress = np.interp(table["time_s"], history["time_s"], history["axial_stress_MPa"])
    return table.assign(
        radius=far, side=np.where(middle[:, 0] < 0.0, -1, 1), zone=zone, stress_MPa=stress
    )


def direction_deg(cracks: pd.DataFrame) -> float:
    """Angle to the load axis of the mean direction of cracks, 0 to 90 degrees.

    Directions have no sign, so the mean is that of doubled angles, weighted by length: a crack that
    zigzags along element edges has the direction in which it gets on.
    """
    across = cracks["x2_mm"] - cracks["x1_mm"]
    along = cracks["y2_mm"] - cracks["y1_mm"]
    doubled = 2.0 * np.arctan2(across, along)
    weight = cracks["length_mm"]
    mean = np.arctan2((weight * np.sin(doubled)).sum(), (weight * np.cos(doubled)).sum())
    return float(np.degrees(abs(mean)) / 2.0)


def hole_radius(run: Run) -> float:
    """Radius of the hole [mm]."""
    return float(run.case["scene"]["hole_radius_mm"])
