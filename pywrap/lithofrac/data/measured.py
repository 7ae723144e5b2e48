"""Measured strengths that are known as numbers (one folder a source, `triaxial_strength.csv`)."""

from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.config.errors import one_line
from lithofrac.data.csv_file import read_columns
from lithofrac.data.errors import DataError

COLUMNS = ("confinement_MPa", "strength_MPa")


def measured_strength(data: Path, source: str) -> pd.DataFrame:
    """Strength against confinement as a source measured it.

    Parameters
    ----------
    data : the folder `data/`
    source : its folder for the source, such as "tautona"

    Returns
    -------
    DataFrame with `confinement_MPa` and `strength_MPa` (mean), in some sources also
    `strength_min_MPa`, `strength_max_MPa` and `tests`; compression positive.

    Raises
    ------
    DataError
        When the file is missing, lacks a column, or holds anything but finite numbers.
    """
    path = data / source / "triaxial_strength.csv"
    table = read_columns(path, COLUMNS, "measured strengths")
    for column in table:
        values = pd.to_numeric(table[column], errors="coerce")
        bad = ~np.isfinite(values)
        if bad.any():
            row = int(np.argmax(bad))
            value = one_line(table[column].iloc[row])
            raise DataError(
                f"{path}: line {row + 2}, column '{one_line(column)}': '{value}', expected a finite"
                " number"
            )
    return table
