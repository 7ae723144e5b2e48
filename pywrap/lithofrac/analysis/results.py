"""The table of results: each quantity, what it is held against, its band, and a verdict.

Bands are fixed beforehand in `reports/bands.csv` and are an input: a verdict never sets its own.
"""

from pathlib import Path

import pandas as pd

from lithofrac.analysis.bench import find_bench
from lithofrac.analysis.discrete_results import discrete_rows
from lithofrac.analysis.kinetic import ratio_before_peak
from lithofrac.analysis.runs import find_runs
from lithofrac.analysis.tables import NOT_DIGITISED, errors, single_element, strength, tautona
from lithofrac.analysis.tables import zigong_line as fitted_line
from lithofrac.analysis.verdict import FAILS, OPEN, verdict
from lithofrac.data.csv_file import read_bands

COLUMNS = ("case", "quantity", "expected", "measured", "computed", "difference", "band", "verdict")
BENCH_STIFFNESS = 0.02  # lateral stiffness over E of `lithofrac point --test stiff_confinement`
QUALITY = {
    "energy_residual": "largest ledger residual over the largest energy of the run",
    "kinetic_ratio_at_peak": "kinetic over internal energy at peak",
    "kinetic_ratio_before_peak": "the same, largest from a tenth of the peak load to the peak",
}  # band -> what it is of


def verdicts(inputs: list[Path], data: Path) -> pd.DataFrame:
    """All results of the suite, one row each, as text with units.

    Parameters
    ----------
    inputs : `bands.csv`, the quartzite's material file, `summary.json` of runs, bench curves
    data : the folder `data/`
    """
    by_suffix = {suffix: [path for path in map(Path, inputs) if path.suffix == suffix]
                 for suffix in (".csv", ".yaml", ".json", ".parquet")}  # fmt: skip
    bands = read_bands(by_suffix[".csv"][0])
    rows = [
        *_single_elements(by_suffix[".parquet"], data, bands),
        *_sandstone(by_suffix[".json"], by_suffix[".parquet"], data, bands),
        *discrete_rows(by_suffix[".json"], data, bands),
        *_measured(by_suffix[".yaml"], data, bands),
        *_quality(by_suffix[".json"], bands),
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def _single_elements(paths: list[Path], data: Path, bands: pd.Series) -> list[dict]:
    """Worst confinement of each rock, beside the closed form."""
    table, band = single_element(paths, data), bands["single_element_strength"]
    if table.empty:
        return []
    rows = []
    for (rock, test), group in table.groupby(["rock", "test"]):
        worst = group.loc[group["difference_percent"].abs().idxmax()]
        rows.append(
            {
                "case": f"single element, {rock.replace('_', ' ')}, {test}",
                "quantity": f"strength at {worst['confinement_MPa']:g} MPa,"
                f" worst of {len(group)} confinements",
                "expected": f"{worst['closed_form_strength_MPa']:.1f} MPa (closed form of Table 1)",
                "measured": "-",
                "computed": f"{worst['strength_MPa']:.1f} MPa",
                **_judged(worst["difference_percent"], band),
            }
        )
    return rows


def _sandstone(paths: list[Path], curves: list[Path], data: Path, bands: pd.Series) -> list[dict]:
    """Peaks under a soft pressure beside the line of Table 1, between stiff platens above it.

    Plane strain with the stiffness of the bench has also the peak of the material point to meet.
    """
    stiff = {curve.confinement_MPa: curve.peak for curve in find_bench(curves, "stiff_confinement")}
    chosen = [run.folder for run in find_runs(paths) if run.test in ("triaxial", "plane_strain")]
    if not chosen:
        return []
    far = errors(chosen, data)
    known = far[(far["figure"] == "10") & (far["origin"] == "experiment")]
    rows = []
    for row in strength(chosen, data).itertuples():
        own = known[[row.case.startswith(f"{name}_p") for name in known["case"]]]
        measured = NOT_DIGITISED.removeprefix("experiment: ")
        if len(own):
            measured = f"Fig. 10, rms difference {own['rms_percent'].iloc[0]:.1f} %"
        entry = {
            "case": row.case,
            "quantity": "strength (first peak)",
            "expected": f"{row.table_1_line_MPa:.1f} MPa (closed form of Table 1)",
            "measured": measured,
            "computed": f"{row.strength_MPa:.1f} MPa" if not row.note else row.note,
        }
        if row.stiffness_over_young == 0.0:
            judged = _judged(row.above_line_percent, bands["triaxial_strength"])
        elif row.stiffness_over_young == BENCH_STIFFNESS and stiff.get(row.confinement_MPa):
            point = stiff[row.confinement_MPa].stress
            entry["expected"] = f"{point:.1f} MPa (material point)"
            judged = _judged(
                100.0 * (row.strength_MPa / point - 1.0), bands["plane_strain_strength"]
            )
        else:
            entry["expected"] = f"above {row.table_1_line_MPa:.1f} MPa (section 3.2)"
            judged = _above(row.above_line_percent)
        rows.append(entry | judged)
    return rows


def _measured(paths: list[Path], data: Path, bands: pd.Series) -> list[dict]:
    """Table 1's quartzite beside TauTona, a fitted line beside Zigong."""
    rows = []
    for row in tautona(paths, data).itertuples() if paths else ():
        rows.append(
            {
                "case": "quartzite of Table 1 and TauTona",
                "quantity": f"strength at {row.confinement_MPa:g} MPa",
                "expected": "within the measured range",
                "measured": f"{row.strength_MPa:.1f} ({row.strength_min_MPa:.1f} to"
                f" {row.strength_max_MPa:.1f}) MPa",
                "computed": f"{row.table_1_line_MPa:.1f} MPa",
                "difference": f"{row.difference_percent:+.1f} %",
                "band": "range of the tests",
                "verdict": verdict(row.within_range == "yes"),
            }
        )
    line = fitted_line(data)
    rows.append(
        {
            "case": "line fitted to Zigong sandstone",
            "quantity": "strength of a point left out",
            "expected": "-",
            "measured": "8 means, 10 to 80 MPa",
            "computed": f"{line.q:.1f} MPa + {line.n:.2f} σ₃",
            **_judged(100.0 * line.left_out_rms, bands["left_out_strength"], "rms "),
        }
    )
    return rows


def _quality(paths: list[Path], bands: pd.Series) -> list[dict]:
    """Worst energy residual, and worst kinetic shares, of the runs that have one.

    The residual is over the largest internal, external or kinetic energy that its run has seen. A
    run without an axial stress has no peak; `run_time` judges it as well.
    """
    rows, runs = [], find_runs(paths)
    known = {key: {run.name: run.summary.get(key) for run in runs} for key in QUALITY}
    known["kinetic_ratio_before_peak"] = {
        run.name: ratio_before_peak(run) for run in runs if run.has_axial_stress
    }
    for key, name in QUALITY.items():
        values = known[key]
        values = {name: abs(value) for name, value in values.items() if value is not None}
        if not values:
            continue
        worst = max(values, key=values.get)
        rows.append(
            {
                "case": f"worst of {len(values)} runs: {worst}",
                "quantity": name,
                "expected": "0",
                "measured": "-",
                "computed": f"{values[worst]:.1e}",
                "difference": f"{values[worst]:.1e}",
                "band": f"{bands[key]:g}",
                "verdict": verdict(values[worst] < bands[key]),
            }
        )
    return rows


def _judged(percent: float, band: float, prefix: str = "") -> dict:
    """Difference, band and verdict of a quantity that has a value to meet."""
    if pd.isna(percent):
        return {"difference": "-", "band": f"{band:g} %", "verdict": FAILS}
    return {
        "difference": f"{prefix}{_percent(percent, signed=not prefix)}",
        "band": f"{band:g} %",
        "verdict": verdict(abs(percent) <= band),
    }


def _percent(value: float, signed: bool) -> str:
    if abs(value) < 1e-4:
        return "below 0.0001 %"
    return f"{value:{'+' if signed else ''}.{1 if abs(value) >= 0.1 else 4}f} %"


def _above(percent: float) -> dict:
    """The same where the claim is only that the value lies above the line."""
    if pd.isna(percent):
        return {"difference": "-", "band": "above", "verdict": OPEN}
    return {
        "difference": f"{percent:+.1f} %",
        "band": "above",
        "verdict": verdict(percent > 0),
    }
