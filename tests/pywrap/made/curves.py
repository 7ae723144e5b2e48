"""Curves of a made results folder whose slopes, peaks and falls are known exactly."""

import numpy as np
import pandas as pd


def give_curve(folder, *knots):
    """Replace the curve of `make_run` by straight lines between knots (strain, stress [MPa]).

    The knots are rows. Moments keep to 0.1 s times the strain.
    """
    ends = [strain for strain, _ in knots]
    strain = np.unique(np.concatenate([np.linspace(0.0, ends[-1], 301), ends]))
    pd.DataFrame(
        {
            "time_s": 0.1 * strain,
            "step": np.arange(len(strain)),
            "axial_strain": strain,
            "axial_stress_MPa": np.interp(strain, *zip(*knots, strict=True)),
        }
    ).to_parquet(folder / "history.parquet")
    return folder
