"""Kinetic over internal energy before failure: what says that a run is quasi-static."""

import numpy as np
import pandas as pd

from lithofrac.analysis.runs import Run

SHARE = 0.1  # of the peak load, from which on the ratio is looked at


def ratio_before_peak(run: Run) -> float:
    """Largest kinetic over internal energy from a tenth of the peak load to the peak.

    The peak is the first one, else the largest stress. Below that tenth the ratio says nothing: the
    internal energy begins at nothing and grows with the square of the load, while the ramp sets the
    body moving at once. A run without an axial stress has no peak load: there the window is that of
    an elastic body, from a hundredth of the largest internal energy to this energy.

    NaN when no record lies in the window.
    """
    energy = run.energy
    internal = energy["elastic_J"] + energy["compressive_dissipation_J"]
    internal = internal + energy["fracture_dissipation_J"]
    inside = energy["time_s"].between(*_window(run, energy["time_s"], internal))
    ratio = (energy["kinetic_J"] / internal)[inside & (internal > 0.0)]
    return float(ratio.max()) if len(ratio) else float("nan")


def _window(run: Run, time_s: pd.Series, internal: pd.Series) -> tuple[float, float]:
    """First and last moment that count [s]."""
    if not run.has_axial_stress:
        return _rise(time_s.to_numpy(), internal.to_numpy(), SHARE**2, int(internal.argmax()))
    stress = run.history["axial_stress_MPa"].to_numpy()
    last = run.peak.index if run.peak else int(stress.argmax())
    return _rise(run.history["time_s"].to_numpy(), stress, SHARE, last)


def _rise(time_s: np.ndarray, load: np.ndarray, share: float, last: int) -> tuple[float, float]:
    """Moment from which on a load stays above a share of that of the row `last`, and its moment."""
    below = np.flatnonzero(load[: last + 1] < share * load[last])
    first = int(below[-1]) + 1 if below.size else 0
    return float(time_s[first]), float(time_s[last])
