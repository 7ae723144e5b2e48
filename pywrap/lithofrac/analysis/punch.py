"""Numbers of the strip punch curves (Klerck 2004, section 3.1 and Fig. 6)."""

from pathlib import Path

import pandas as pd

from lithofrac.analysis.runs import find_runs

COLUMNS = [
    "case",
    "cracks",
    "compressive_failure",
    "fracture_energy_J_m2",
    "first_peak_MPa",
    "strain_at_peak_percent",
    "lowest_after_peak_MPa",
    "largest_stress_MPa",
    "stress_at_end_MPa",
    "note",
]


def punch(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Peak, fall and end of the punch stress; runs of other scenes are left out."""
    rows = []
    for run in find_runs(inputs):
        if run.test != "punch":
            continue
        stress, peak, nan = run.history["axial_stress_MPa"], run.peak, float("nan")
        rows.append(
            {
                "case": run.name,
                "cracks": run.fracture.replace("_", "-"),
                "compressive_failure": "on" if run.rock.compression else "off",
                "fracture_energy_J_m2": run.rock.fracture_energy,
                "first_peak_MPa": peak.stress if peak else nan,
                "strain_at_peak_percent": 100.0 * peak.strain if peak else nan,
                "lowest_after_peak_MPa": float(stress[peak.index :].min()) if peak else nan,
                "largest_stress_MPa": float(stress.max()),
                "stress_at_end_MPa": float(stress.iloc[-1]),
                "note": "" if peak else "no peak",
            }
        )
    return pd.DataFrame(rows, columns=COLUMNS)
