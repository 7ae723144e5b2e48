"""Numbers of the strip punch curves (Klerck 2004, section 3.1 and Fig. 6)."""

from pathlib import Path

import pandas as pd

from lithofrac.analysis.runs import find_runs
from lithofrac.analysis.stages import Stages, find_stages

COLUMNS = [
    "case",
    "fracture",
    "compressive_failure",
    "fracture_energy_J_m2",
    "first_peak_MPa",
    "strain_at_peak_percent",
    "lowest_after_peak_MPa",
    "largest_stress_MPa",
    "a_to_b_percent",
    "b_to_c_percent",
    "strain_at_d_percent",
    "stress_at_end_MPa",
    "note",
]


def punch(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Peak, fall and end of the punch stress; runs of other scenes are left out.

    A to D are the stages of `find_stages`, their falls and rises over the stress at A.
    """
    rows = []
    for run in find_runs(inputs):
        if run.test != "punch":
            continue
        stress, peak, nan = run.history["axial_stress_MPa"], run.peak, float("nan")
        strain = run.history["axial_strain"]
        stages = find_stages(strain, stress)
        rows.append(
            {
                "case": run.name,
                "fracture": run.fracture.replace("_", "-"),
                "compressive_failure": "on" if run.rock.compression else "off",
                "fracture_energy_J_m2": run.rock.fracture_energy,
                "first_peak_MPa": peak.stress if peak else nan,
                "strain_at_peak_percent": 100.0 * peak.strain if peak else nan,
                "lowest_after_peak_MPa": float(stress[peak.index :].min()) if peak else nan,
                "largest_stress_MPa": float(stress.max()),
                "a_to_b_percent": 100.0 * (1.0 - stress[stages.b] / peak.stress) if peak else nan,
                "b_to_c_percent": 100.0 * stages.regain if stages.c is not None else nan,
                "strain_at_d_percent": 100.0 * strain[stages.d] if stages.d is not None else nan,
                "stress_at_end_MPa": float(stress.iloc[-1]),
                "note": note(stages),
            }
        )
    return pd.DataFrame(rows, columns=COLUMNS)


def note(stages: Stages) -> str:
    """Which stages of Fig. 6a a curve lacks, in words."""
    if stages.a is None:
        return "no peak"
    lacking = ["no regain"] if stages.c is None else []
    return ", ".join(lacking + (["no complete failure"] if stages.d is None else []))
