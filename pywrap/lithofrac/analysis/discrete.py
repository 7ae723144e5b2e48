"""Tables of the runs with discrete cracks: what opened, what it cost, and which way it runs.

Every function takes the input files and the folder `data/`, as those of `tables`.
"""

from pathlib import Path

import pandas as pd

from lithofrac.analysis.bands import crack_angles, find_band, near_axis_share
from lithofrac.analysis.runs import Run, find_runs

CRACK_COLUMNS = [
    "case",
    "continuum",
    "cracks",
    "crack_length_mm",
    "tensile_percent",
    "fallbacks",
    "fragments",
    "insertion_J",
    "energy_residual",
    "time_step_over_continuum",
    "contact_pairs_max",
    "contact_sweeps_mean",
    "contact_unconverged_steps",
    "max_penetration_over_h",
    "core_seconds",
    "core_time_over_continuum",
]
BAND_COLUMNS = [
    "case",
    "confinement_MPa",
    "band_angle_deg",
    "band_elongation",
    "band_spread",
    "note",
    "cracks_near_axis_percent",
    "median_crack_angle_deg",
]
OWN_KEYS = ("title", "fracture", "output", "probes")  # of a case; they leave the continuum as it is


def cracks(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Cracks, contact and cost of the discrete runs, beside the continuum run of the same case.

    Shares are of the crack length. The time step is the smallest of the run over that of the
    continuum (`continuum_step`).
    """
    runs = find_runs(inputs)
    rows = []
    for run in runs:
        if not run.discrete:
            continue
        summary, table = run.summary, run.cracks
        twin = continuum_of(run, runs)
        length = table["length_mm"].sum()
        tensile = table.loc[table["mode"] == "tensile", "length_mm"].sum()
        rows.append(
            {
                "case": run.name,
                "continuum": twin.name if twin else None,
                "cracks": summary["cracks"],
                "crack_length_mm": length,
                "tensile_percent": 100.0 * tensile / length if length > 0.0 else float("nan"),
                "fallbacks": int(table["fallback"].sum()),
                "fragments": summary["fragments"],
                "insertion_J": float(run.energy["insertion_J"].iloc[-1]),
                "energy_residual": summary["energy_residual"],
                "time_step_over_continuum": summary["time_step_min_s"] / continuum_step(run, runs),
                "contact_pairs_max": summary["contact_pairs_max"],
                "contact_sweeps_mean": summary["contact_sweeps_mean"],
                "contact_unconverged_steps": summary["contact_unconverged_steps"],
                "max_penetration_over_h": summary["max_penetration_over_h"],
                "core_seconds": summary["core_seconds"],
                "core_time_over_continuum": (
                    summary["core_seconds"] / twin.summary["core_seconds"] if twin else float("nan")
                ),
            }
        )
    return pd.DataFrame(rows, columns=CRACK_COLUMNS)


def bands(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Angle of the shear band and of the crack segments to the load axis, discrete runs."""
    rows = []
    for run in find_runs(inputs):
        if not run.discrete:
            continue
        band = find_band(run.last_frame)
        rows.append(
            {
                "case": run.name,
                "confinement_MPa": run.confinement_MPa,
                "band_angle_deg": band.angle_deg,
                "band_elongation": band.elongation,
                "band_spread": band.spread,
                "note": f"no band, {band.note}" if band.note else "",
                "cracks_near_axis_percent": 100.0 * near_axis_share(run.cracks),
                "median_crack_angle_deg": _median_angle(run.cracks),
            }
        )
    return pd.DataFrame(rows, columns=BAND_COLUMNS)


def continuum_of(run: Run, runs: list[Run]) -> Run | None:
    """The run without cracks whose case is the same in all that decides the continuum."""
    return next((other for other in _alike(run, runs) if not other.discrete), None)


def continuum_step(run: Run, runs: list[Run]) -> float:
    """Time step of the continuum in a run's case [s]; NaN where nothing tells it.

    That of the twin, else of the same problem built without cracks, which a run puts on record.
    """
    twin = continuum_of(run, runs)
    if twin is not None:
        return twin.summary["time_step_min_s"]
    return run.summary.get("time_step_continuum_s", float("nan"))


def _alike(run: Run, runs: list[Run]) -> list[Run]:
    """Runs, this one among them, whose cases agree in all but `OWN_KEYS`."""
    wanted, *others = (
        {key: value for key, value in one.case.items() if key not in OWN_KEYS}
        for one in (run, *runs)
    )
    return [one for one, case in zip(runs, others, strict=True) if case == wanted]


def _median_angle(table: pd.DataFrame) -> float:
    """Angle to the load axis below which half of the crack length runs [degrees]."""
    if table.empty:
        return float("nan")
    ordered = table.assign(angle=crack_angles(table)).sort_values("angle")
    passed = ordered["length_mm"].cumsum() >= 0.5 * ordered["length_mm"].sum()
    return float(ordered["angle"][passed].iloc[0])
