"""Zigong sandstone: `lithofrac fit` on every other confinement, the rest predicted."""

from pathlib import Path

import pandas as pd

from lithofrac.analysis.rock_fit import RockFit, fit_rock, unknowns
from lithofrac.analysis.rock_start import one_row
from lithofrac.config.material import COLUMNS, Material
from lithofrac.data.triaxial import load_triaxial

FITTED_ON = (10.0, 30.0, 50.0, 70.0)  # MPa; the tests between and above are predicted


def zigong_prediction(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Strengths that were fitted and strengths that were predicted beside the measured ones.

    `inputs` holds one file: a material for the constants beside the fit, on which no strength
    depends.
    """
    table = _fit(inputs[0], data).strengths
    return table[["confinement_MPa", "role", "strength_MPa", "computed_MPa", "difference_percent"]]


def zigong_prediction_error(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Rms and largest error of both roles; `inputs` as of `zigong_prediction`."""
    fit = _fit(inputs[0], data)
    rows = [(role, *fit.error_percent(role)) for role in ("fitted", "predicted")]
    names = ["role", "rms_percent", "largest_percent", "largest_at_confinement_MPa"]
    return pd.DataFrame(rows, columns=names)


def _fit(base: Path, data: Path) -> RockFit:
    tests = load_triaxial([data / "zigong" / "triaxial_strength.csv"])
    fitted = [test for test in tests if test.confinement_MPa in FITTED_ON]
    predicted = [test for test in tests if test.confinement_MPa not in FITTED_ON]
    one = dict.fromkeys(COLUMNS, (0.0,))
    rock = Material.load(base).model_copy(update=one)
    strongest = max(test.strength_MPa for test in fitted)
    return fit_rock(unknowns(rock, one_row(fitted), strongest), fitted, predicted)
