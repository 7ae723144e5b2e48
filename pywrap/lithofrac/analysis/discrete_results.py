"""Rows of the table of results that runs with discrete cracks give: direction, step, cost."""

from pathlib import Path

import pandas as pd

from lithofrac.analysis.bands import NEAR_AXIS_DEG
from lithofrac.analysis.discrete import bands, cracks
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.analysis.verdict import OPEN, verdict

ROUNDING = 1e-9  # of a quotient of two time steps that are to be equal


def discrete_rows(paths: list[Path], data: Path, limits: pd.Series) -> list[dict]:
    """Results of the discrete runs, keys as in `results.COLUMNS`.

    Parameters
    ----------
    paths : `summary.json` of runs, discrete and continuum
    data : the folder `data/`
    limits : quantity -> band, from `bands.csv`
    """
    runs = {run.name: run for run in find_runs(paths)}
    rows = []
    for row in bands(paths, data).itertuples():
        if is_soft_block(runs[row.case]):
            rows += [_band(row, limits), _direction(row, limits)]
    for row in cracks(paths, data).itertuples():
        rows.append(_step(row, runs[row.case], limits))
        if not pd.isna(row.continuum):
            rows.append(_cost(row, limits))
    return rows


def is_soft_block(run: Run) -> bool:
    """Whether a run is a block in plane strain under a soft pressure, free to shear."""
    return run.test == "plane_strain" and run.stiffness == 0.0


def _band(row, limits: pd.Series) -> dict:
    """Uniaxial: near the load axis or none; under confinement: between two angles."""
    if row.confinement_MPa == 0.0:
        most = limits["band_angle_uniaxial"]
        good = bool(row.note) or row.band_angle_deg < most
        expected = f"below {most:g}° or none"
    else:
        low, high = limits["band_angle_triaxial_least"], limits["band_angle_triaxial_most"]
        good = not row.note and low <= row.band_angle_deg <= high
        expected = f"{low:g}° to {high:g}°"
    return _row(
        row.case,
        "angle of the shear band to the load axis",
        computed=_angle(row),
        band=expected,
        verdict=verdict(good),
    )


def _angle(row) -> str:
    """Angle of the principal axis, and why it is not that of a band."""
    if pd.isna(row.band_angle_deg):
        return row.note
    return f"{row.band_angle_deg:.1f}°" + (f" ({row.note})" if row.note else "")


def _direction(row, limits: pd.Series) -> dict:
    """Segments are near-vertical when at least a share of their length is."""
    share, least = row.cracks_near_axis_percent, limits["crack_share_near_axis"]
    return _row(
        row.case,
        f"share of the crack length within {NEAR_AXIS_DEG:g}° of the load axis",
        computed="no cracks" if pd.isna(share) else f"{share:.0f} %",
        band=f"at least {least:g} %",
        verdict=OPEN if pd.isna(share) else verdict(share >= least),
    )


def _step(row, run: Run, limits: pd.Series) -> dict:
    """Cracks along edges leave the time step as it is, cracks through elements may lower it."""
    mode, ratio = run.fracture, row.time_step_over_continuum
    least = limits[f"time_step_{mode}"]
    return _row(
        row.case,
        f"smallest time step over the continuum's, {mode.replace('_', '-')}",
        computed="-" if pd.isna(ratio) else f"{ratio:.4g}",
        band="1" if least == 1.0 else f"at least {least:g}",
        verdict=OPEN if pd.isna(ratio) else verdict(ratio >= least - ROUNDING),
    )


def _cost(row, limits: pd.Series) -> dict:
    """Of a step: cutting elements shortens it, for which there is a band of its own."""
    most = limits["core_time"]
    value = row.core_time_over_continuum * row.time_step_over_continuum
    return _row(
        row.case,
        f"core time of a step over that of {row.continuum}",
        computed=f"{value:.2f}",
        band=f"at most {most:g}",
        verdict=verdict(value <= most),
    )


def _row(case: str, quantity: str, **values) -> dict:
    """A row without a measured value, and whose band is all that is expected."""
    blank = {"expected": "-", "measured": "-", "difference": "-"}
    return {"case": case, "quantity": quantity, **blank, **values}
