"""Single numbers of a run, for its summary."""

from __future__ import annotations

import math

import numpy as np

from lithofrac.analysis.strength import first_peak


def peak(history, energy) -> dict:
    """First peak of the axial stress (else the largest), kinetic over internal energy there."""
    if "axial_stress_MPa" not in history:
        return {"peak_stress_MPa": None, "peak_strain": None, "kinetic_ratio_at_peak": None}
    stress = history["axial_stress_MPa"].to_numpy()
    found = first_peak(history["axial_strain"].to_numpy(), stress)
    row = found.index if found is not None else int(np.nanargmax(stress))
    entry = energy.iloc[row]
    internal = (
        entry["elastic_J"] + entry["compressive_dissipation_J"] + entry["fracture_dissipation_J"]
    )
    return {
        "peak_stress_MPa": finite(history["axial_stress_MPa"].iloc[row]),
        "peak_strain": finite(history["axial_strain"].iloc[row]),
        "kinetic_ratio_at_peak": finite(entry["kinetic_J"] / internal) if internal > 0 else None,
    }


def residual(energy) -> float | None:
    """Largest residual of the ledger over the largest energy that the run has seen."""
    internal = energy["elastic_J"] + energy["compressive_dissipation_J"]
    internal = internal + energy["fracture_dissipation_J"]
    scale = max(internal.abs().max(), energy["external_J"].abs().max(), energy["kinetic_J"].max())
    return finite(energy["residual_J"].abs().max() / scale) if scale > 0.0 else 0.0


def ratio(part: float, whole: float) -> float:
    """`part / whole`, 0 where there is no whole."""
    return float(part / whole) if whole else 0.0


def finite(value: float) -> float | None:
    """A JSON number, or null where there is none."""
    return float(value) if math.isfinite(value) else None
