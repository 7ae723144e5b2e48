"""The numbers behind the figures, one table each: files in, a DataFrame out.

Every function takes the input files and the folder `data/`. Column names carry the unit; `_percent`
differences are relative to the expected value.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.analysis.bench import find_bench
from lithofrac.analysis.curves import compare
from lithofrac.analysis.fit import StrengthLine, fit_line
from lithofrac.analysis.kinetic import ratio_before_peak
from lithofrac.analysis.kirsch import infinite_plate
from lithofrac.analysis.kirsch_series import plate
from lithofrac.analysis.mohr_coulomb import first_yield, peak_strength, residual_strength
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.analysis.verdict import OPEN, verdict
from lithofrac.config.material import Material
from lithofrac.data import Curve, load_curves, measured_strength
from lithofrac.data.csv_file import read_bands
from lithofrac.problem import Mesh

MPA = 1e6
HOOP = {"crown": ("stress_xx_MPa", 0), "sidewall": ("stress_yy_MPa", 1)}  # probe -> hoop stress
NOT_DIGITISED = "experiment: not digitised"
SUMMARY = (
    "status",
    "elements",
    "nodes",
    "steps",
    "wall_seconds",
    "core_seconds",
    "expected_seconds",
    "expected_over_measured",
    "element_steps_per_core_second",
    "energy_residual",
    "kinetic_ratio_at_peak",
    "kinetic_ratio_before_peak",
    "kinetic_verdict",
    "version",
    "commit",
    "native",
    "machine",
    "finished",
)


def single_element(inputs: list[Path], data: Path) -> pd.DataFrame:
    """First yield, peak and end of the triaxial material-point curves beside their closed form.

    Columns `closed_form_*` follow from the hardening table alone, all others from the curve.
    """
    rows = []
    for curve in find_bench(inputs, "triaxial"):
        table, pressure = curve.material.table, curve.confinement_MPa * MPA
        peak, _ = peak_strength(table, pressure)
        at_peak = curve.curve.loc[curve.curve["axial_stress_MPa"].idxmax()]
        computed = float(at_peak["axial_stress_MPa"])
        rows.append(
            {
                "rock": curve.rock,
                "test": curve.test,
                "confinement_MPa": curve.confinement_MPa,
                "strength_MPa": computed,
                "closed_form_strength_MPa": peak / MPA,
                "difference_percent": 100.0 * (computed * MPA / peak - 1.0),
                "strain_at_peak_percent": 100.0 * at_peak["axial_strain"],
                "first_yield_MPa": curve.first_yield_MPa,
                "closed_form_first_yield_MPa": first_yield(table, pressure) / MPA,
                "residual_MPa": round(curve.residual_MPa, 9),
                "closed_form_residual_MPa": residual_strength(table, pressure) / MPA,
            }
        )
    return pd.DataFrame(rows)


def strength(inputs: list[Path], data: Path) -> pd.DataFrame:
    """First peaks of the runs beside the line of their hardening table."""
    rows = []
    for run in find_runs(inputs):
        line = peak_strength(run.rock.table, run.confinement_MPa * MPA)[0] / MPA
        peak = run.peak
        rows.append(
            {
                "case": run.name,
                "test": run.test,
                "confinement_MPa": run.confinement_MPa,
                "stiffness_over_young": run.stiffness,
                "table_1_line_MPa": line,
                "strength_MPa": peak.stress if peak else float("nan"),
                "above_line_percent": 100.0 * (peak.stress / line - 1.0) if peak else float("nan"),
                "strain_at_peak_percent": 100.0 * peak.strain if peak else float("nan"),
                "largest_stress_MPa": float(run.history["axial_stress_MPa"].max()),
                "note": "" if peak else "no peak",
            }
        )
    return pd.DataFrame(rows)


def tautona(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Measured strengths of TauTona quartzite beside the line of a hardening table.

    `inputs` holds one file, the material.
    """
    rock = Material.load(inputs[0])
    table = measured_strength(data, "tautona")
    line = [peak_strength(rock.table, p * MPA)[0] / MPA for p in table["confinement_MPa"]]
    inside = (line >= table["strength_min_MPa"]) & (line <= table["strength_max_MPa"])
    return table.assign(
        table_1_line_MPa=line,
        difference_percent=100.0 * (line / table["strength_MPa"] - 1.0),
        within_range=["yes" if value else "no" for value in inside],
    )


def zigong_line(data: Path) -> StrengthLine:
    """Line fitted to the strengths of Zigong sandstone [MPa]."""
    table = measured_strength(data, "zigong")
    return fit_line(table["confinement_MPa"], table["strength_MPa"])


def zigong(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Measured strengths of Zigong sandstone beside the line fitted to them."""
    table, line = measured_strength(data, "zigong"), zigong_line(data)
    fitted = line.at(table["confinement_MPa"])
    return table.assign(
        fitted_line_MPa=fitted,
        difference_percent=100.0 * (fitted / table["strength_MPa"] - 1.0),
    )


def zigong_fit(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Parameters of the line fitted to Zigong sandstone, with 95 % confidence."""
    line = zigong_line(data)
    rows = [
        ("intercept q [MPa]", line.q, line.q_half),
        ("slope N [-]", line.n, line.n_half),
        ("cohesion [MPa]", line.cohesion, None),
        ("friction angle [degrees]", line.friction_deg, None),
        ("rms of residuals [MPa]", line.rms, None),
        ("rms error of a point left out [%]", 100.0 * line.left_out_rms, None),
    ]
    return pd.DataFrame(rows, columns=["quantity", "value", "plus_minus"])


def kirsch(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Hoop stress at crown and sidewall of an elastic hole, over the stress applied.

    All are taken at the centroid of the recorded element, compression positive. The reference is
    the plate as wide and high as the block; the infinite plate shows what its width does.
    """
    rows = []
    for run in find_runs(inputs):
        table = run.probes
        mesh = Mesh.load(run.folder / "mesh.npz")
        for row in table.groupby("probe").tail(1).itertuples():
            if row.probe not in HOOP:
                continue
            component, index = HOOP[row.probe]
            centre = mesh.centroids()[row.element]
            radius = 1e-3 * run.case["scene"]["hole_radius_mm"]
            half = 0.5 * run.case["scene"]["block_over_radius"]
            exact = float(plate(half, half).stress(*centre[:, None] / radius)[index, 0])
            computed = -getattr(row, component) / run.case["loading"]["stress_MPa"]
            rows.append(
                {
                    "case": run.name,
                    "point": row.probe,
                    "distance_mm": 1e3 * float(np.hypot(*centre)),
                    "infinite_plate": infinite_plate(centre[None], radius)[0, index],
                    "finite_plate": exact,
                    "computed": computed,
                    "difference_percent": 100.0 * (computed / exact - 1.0),
                }
            )
    return pd.DataFrame(rows)


def run_time(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Size, cost and energy error of the runs.

    The kinetic ratio before the peak is held against its band in `bands.csv`, which is an input.
    """
    paths = [Path(path) for path in inputs]
    (file,) = (path for path in paths if path.name == "bands.csv")
    band = read_bands(file)["kinetic_ratio_before_peak"]
    rows = []
    for run in find_runs([path for path in paths if path != file]):
        ratio = ratio_before_peak(run)
        expected = run.summary.get("expected_seconds", np.nan)
        judged = {
            "expected_over_measured": expected / run.summary["core_seconds"],
            "kinetic_ratio_before_peak": ratio,
            "kinetic_verdict": OPEN if np.isnan(ratio) else verdict(ratio < band),
        }
        rows.append({"case": run.name, **{k: run.summary.get(k) for k in SUMMARY}, **judged})
    return pd.DataFrame(rows, columns=["case", *SUMMARY])


def errors(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Distance of the runs from the digitised curves of Figs 9 and 10, or that there are none."""
    runs = find_runs(inputs)
    rows = []
    for figure in ("9", "10"):
        curves = load_curves(data, figure)
        rows += [_error_row(curve, *_computed(curve, runs)) for curve in curves]
        if not any(curve.sheet.origin == "experiment" for curve in curves):
            rows.append({"figure": figure, "series": NOT_DIGITISED})
    columns = [
        "figure",
        "series",
        "origin",
        "case",
        "points",
        "points_left_out",
        "rms_MPa",
        "rms_percent",
        "largest_percent",
        "reading_error_MPa",
    ]
    return pd.DataFrame(rows, columns=columns)


def _computed(curve: Curve, runs: list[Run]) -> tuple:
    """Computed x and y to stand beside a digitised curve; empty when there are none."""
    name = curve.sheet.compare_with
    if curve.sheet.figure == "10":
        own = [run for run in runs if run.family == name and run.peak]
        own = {run.confinement_MPa: run.peak.stress for run in reversed(own)}
        return list(own), list(own.values())
    for run in runs:
        if run.name == name:
            return run.history["axial_strain"], run.history["axial_stress_MPa"]
    return [], []


def _error_row(curve: Curve, x, y) -> dict:
    row = {
        "figure": curve.sheet.figure,
        "series": curve.sheet.series,
        "origin": curve.sheet.origin,
        "case": curve.sheet.compare_with,
        "reading_error_MPa": curve.y_error,
    }
    if len(x) == 0:
        return row | {"points": 0, "points_left_out": len(curve.x)}
    try:
        error = compare(x, y, curve.x, curve.y)
    except ValueError:
        return row | {"points": 0, "points_left_out": len(curve.x)}
    return row | {
        "points": error.points,
        "points_left_out": error.left_out,
        "rms_MPa": error.rms,
        "rms_percent": 100.0 * error.rms_relative,
        "largest_percent": 100.0 * error.max_relative,
    }
