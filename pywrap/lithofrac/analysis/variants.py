"""What the open choices change: runs that differ from a twin in the keys that are named alone.

The suite file says which case is a variant of which (`twin:`). All numbers of a row are those of
its own run; differences are to the twin. One run after the peak is one draw of many: a variant
that is nothing but another mesh shows how far two draws lie apart.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from lithofrac.analysis.bands import near_axis_share
from lithofrac.analysis.curves import compare
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.config.suite import load_suite
from lithofrac.data import DataError

COLUMNS = [
    "case",
    "twin",
    "choice",
    "peak_stress_MPa",
    "strain_at_peak_percent",
    "residual_stress_MPa",
    "work_after_peak_MJ_m3",
    "cracks",
    "crack_length_mm",
    "near_axis_percent",
    "tensile_percent",
    "fragments",
    "reset_J",
    "energy_residual",
    "core_seconds",
    "peak_change_percent",
    "strain_at_peak_change_percent",
    "residual_change_percent",
    "work_change_percent",
    "crack_length_change_mm",
    "curve_rms_percent",
    "core_time_over_twin",
    "what_changes",
]
END = 0.1  # share of the axial strain at whose end the residual stress is averaged
SAME = 1.0  # percent; a smaller change of a stress or strain is called none
QUANTITIES = {
    "peak_change_percent": "peak stress",
    "strain_at_peak_change_percent": "strain at peak",
    "residual_change_percent": "residual stress",
    "work_change_percent": "work after the peak",
}  # column -> words


def variants(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Each twin, followed by its variants; both must have been run.

    Parameters
    ----------
    inputs : the suite file (`.yaml`), which pairs variants and twins, and `summary.json` of runs
    data : the folder `data/`
    """
    rows = []
    for twin, own in families(inputs):
        rows.append({"case": twin.name, **_numbers(twin)})
        for run in own:
            row = {
                "case": run.name,
                "twin": twin.name,
                "choice": ", ".join(changed_keys(run, twin)),
                **_numbers(run),
                **_differences(run, twin),
            }
            rows.append({**row, "what_changes": _sentence(row, run, twin)})
    return pd.DataFrame(rows, columns=COLUMNS)


def families(inputs: list[Path]) -> list[tuple[Run, list[Run]]]:
    """(twin, its variants) in the order of the suite, where they have been run.

    Raises
    ------
    DataError
        When there is no suite file among the inputs, or more than one.
    """
    suites = [Path(path) for path in inputs if Path(path).suffix == ".yaml"]
    if len(suites) != 1:
        raise DataError(f"variants: {len(suites)} suite files among the inputs, expected one")
    runs = {run.name: run for run in find_runs([p for p in inputs if Path(p) != suites[0]])}
    found: dict[str, list[Run]] = {}
    for name, twin in load_suite(suites[0]).variants.items():
        if name in runs and twin in runs:
            found.setdefault(twin, []).append(runs[name])
    return [(runs[twin], own) for twin, own in found.items()]


def changed_keys(run: Run, twin: Run) -> list[str]:
    """`key: value` of a run for each key of its case in which it differs from its twin."""
    own, other = (_flat(one.case) for one in (run, twin))
    keys = [key for key in {**other, **own} if own.get(key) != other.get(key)]
    return [f"{key}: {own.get(key, 'left out')}" for key in keys if key != "title"]


def residual_stress(run: Run) -> float:
    """Mean axial stress over the last tenth of the axial strain [MPa]."""
    strain, stress = run.history["axial_strain"], run.history["axial_stress_MPa"]
    return float(stress[strain >= (1.0 - END) * strain.iloc[-1]].mean())


def work_after_peak(run: Run) -> float:
    """Area below the curve from its peak to its end [MJ/m3]; NaN without a peak."""
    if run.peak is None:
        return float("nan")
    after = run.history.iloc[run.peak.index :]
    return float(np.trapezoid(after["axial_stress_MPa"], after["axial_strain"]))


def _flat(values: dict[str, Any], above: str = "") -> dict[str, Any]:
    """Nested keys as dotted ones."""
    flat: dict[str, Any] = {}
    for key, value in values.items():
        flat |= _flat(value, f"{above}{key}.") if isinstance(value, dict) else {above + key: value}
    return flat


def _numbers(run: Run) -> dict:
    """Columns that follow from one run."""
    peak, nan = run.peak, float("nan")
    row = {
        "peak_stress_MPa": peak.stress if peak else nan,
        "strain_at_peak_percent": 100.0 * peak.strain if peak else nan,
        "residual_stress_MPa": residual_stress(run),
        "work_after_peak_MJ_m3": work_after_peak(run),
        "energy_residual": run.summary["energy_residual"],
        "core_seconds": run.summary["core_seconds"],
    }
    if not run.discrete:
        return row
    length = run.cracks["length_mm"]
    tensile = length[run.cracks["mode"] == "tensile"].sum()
    return row | {
        "cracks": run.summary["cracks"],
        "crack_length_mm": float(length.sum()),
        "near_axis_percent": 100.0 * near_axis_share(run.cracks),
        "tensile_percent": 100.0 * tensile / length.sum() if length.sum() > 0.0 else nan,
        "fragments": run.summary["fragments"],
        "reset_J": float(run.energy["reset_J"].iloc[-1]),
    }


def _differences(run: Run, twin: Run) -> dict:
    """Columns that hold a run against its twin; changes are relative to the twin."""
    own, other = _numbers(run), _numbers(twin)
    curves = [(100.0 * one.history["axial_strain"], one.history["axial_stress_MPa"])
              for one in (run, twin)]  # fmt: skip
    return {
        "peak_change_percent": _change(own, other, "peak_stress_MPa"),
        "strain_at_peak_change_percent": _change(own, other, "strain_at_peak_percent"),
        "residual_change_percent": _change(own, other, "residual_stress_MPa"),
        "work_change_percent": _change(own, other, "work_after_peak_MJ_m3"),
        "crack_length_change_mm": own.get("crack_length_mm", np.nan)
        - other.get("crack_length_mm", np.nan),
        "curve_rms_percent": 100.0 * compare(*curves[0], *curves[1]).rms_relative,
        "core_time_over_twin": own["core_seconds"] / other["core_seconds"],
    }


def _change(own: dict, other: dict, key: str) -> float:
    """Relative change [%]; NaN where the twin has none or nothing."""
    return 100.0 * (own[key] / other[key] - 1.0) if other[key] else float("nan")


def _sentence(row: dict, run: Run, twin: Run) -> str:
    """The differences of a row in words."""
    same = [words for key, words in QUANTITIES.items() if abs(row[key]) < SAME]
    parts = [f"{', '.join(same)} within {SAME:g} %"] if same else []
    parts += [
        f"{words} {row[key]:+.0f} %"
        for key, words in QUANTITIES.items()
        if abs(row[key]) >= SAME  # false for NaN
    ]
    if run.peak is None or twin.peak is None:
        peaks = [one.name for one in (run, twin) if one.peak]
        parts.append(f"a peak in {peaks[0]} alone" if peaks else "no peak in either")
    if run.discrete and twin.discrete:
        parts.append(f"crack events {twin.summary['cracks']} to {run.summary['cracks']}")
    return "; ".join(parts)
