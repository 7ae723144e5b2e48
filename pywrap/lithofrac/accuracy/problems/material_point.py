"""The material point: stress against the strain step."""

from __future__ import annotations

import time
from functools import cache

import numpy as np
import pandas as pd

from lithofrac import point
from lithofrac.accuracy.subject import REPEATS, Outcome, Subject

END_STRAIN = 0.025
CONFINEMENT = 10.0  # [MPa]
FINEST = 12_800  # steps of the path that the others are held against


def curve(steps: int) -> pd.DataFrame:
    """Triaxial test of the sandstone through its peak and its softening."""
    return point.drive("sandstone", "triaxial", CONFINEMENT, END_STRAIN, steps)


@cache
def finest() -> pd.DataFrame:
    """The path in the smallest steps."""
    return curve(FINEST)


def material_point(strain_step: float) -> Outcome:
    """Largest error of the axial stress at the ends of the steps, over the peak."""
    steps, least = round(END_STRAIN / strain_step), np.inf
    for _ in range(REPEATS):
        start = time.process_time()
        found = curve(steps)
        least = min(least, time.process_time() - start)
    exact = finest()
    stress = np.interp(found["axial_strain"], exact["axial_strain"], exact["axial_stress_MPa"])
    error = abs(found["axial_stress_MPa"] - stress).max() / exact["axial_stress_MPa"].max()
    return Outcome({"axial stress": float(error)}, least, 1, len(found) - 1)


MATERIAL_POINT = Subject(
    "material_point",
    "sandstone at 10 MPa, triaxial, to 2.5 % strain; error held against 12,800 steps",
    material_point,
    {"strain_step": END_STRAIN / point.STEPS},
    {"strain_step": tuple(END_STRAIN / n for n in (5, 10, 25, 50, 100, 1600))},
    ("axial stress",),
    size="strain_step",
    reasons={
        "axial stress": "A choice: a test takes less than 0.1 s either way, and its steps are the "
        "points of the curve that is drawn."
    },
)
