"""Checks of the initiation stresses: null test, convergence, bound of the elastic solution."""

from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.analysis.hole import WHOLE, HoleRun
from lithofrac.analysis.hole_tables import MPA, hole_initiation, hole_runs
from lithofrac.analysis.mohr_coulomb import first_yield
from lithofrac.analysis.verdict import OPEN, verdict
from lithofrac.data.csv_file import read_bands

COLUMNS = [
    "check", "case", "zone", "criterion", "initiation_MPa", "reference_MPa",
    "difference_percent", "band_percent", "verdict",
]  # fmt: skip
NULL_OF = "hole_r25.0"  # Gf of the null tests is in proportion to R, that of R = 25 mm unchanged
VARIANTS = {"fine": "half the element size", "slow": "half the speed"}
ELASTIC, CONVERGED, NOT_CONVERGED = "above the elastic solution", "converged", "not converged"


def hole_checks(inputs: list[Path], data: Path) -> pd.DataFrame:
    """All checks, a row each.

    Parameters
    ----------
    inputs : `bands.csv` and results of the hole runs; `hole_initiation.csv` if it is there
    data : the folder `data/`
    """
    paths = [Path(path) for path in inputs]
    (file,) = (path for path in paths if path.name == "bands.csv")
    bands = read_bands(file)
    table, runs = hole_initiation(paths, data), hole_runs(paths)
    rows = [
        *_null_test(table, bands["hole_null_test"]),
        *_variants(table, bands["hole_convergence"]),
        *_elastic(table, runs),
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def _null_test(table: pd.DataFrame, band: float) -> list[dict]:
    """Runs with Gf, ramps and damping in proportion to R, and the one they are in proportion to,
    against their mean."""
    rows = []
    own = table[(table["series"] == "null") | (table["case"] == NULL_OF)]
    if not (own["series"] == "null").any():
        return rows
    for _, group in own.groupby(["zone", "criterion"], sort=False):
        mean = group["initiation_MPa"].mean()
        for row in group.itertuples():
            missing = np.isnan(row.initiation_MPa) and not np.isnan(mean)
            percent = 100.0 * (row.initiation_MPa / mean - 1.0)
            word = verdict(abs(percent) <= band) if not np.isnan(percent) else OPEN
            rows.append(
                _row("null test", row, mean, percent, band, verdict(False) if missing else word)
            )
    return rows


def _variants(table: pd.DataFrame, band: float) -> list[dict]:
    """Finer and slower runs against the run that their name begins with."""
    rows = []
    known = table.set_index(["case", "zone", "criterion"])["initiation_MPa"]
    for row in table[table["series"].isin(VARIANTS)].itertuples():
        base = row.case.removesuffix(f"_{row.series}")
        reference = known.get((base, row.zone, row.criterion), float("nan"))
        percent = 100.0 * (row.initiation_MPa / reference - 1.0)
        if np.isnan(row.initiation_MPa) and np.isnan(reference):
            word = OPEN
        else:
            word = CONVERGED if abs(percent) <= band else NOT_CONVERGED
        rows.append(_row(VARIANTS[row.series], row, reference, percent, band, word))
    return rows


def _elastic(table: pd.DataFrame, runs: list[HoleRun]) -> list[dict]:
    """No initiation in a zone below the load at which it reaches its strength elastically.

    That is ft at crown and fan, the first yield of Table 1 at the sidewall, at the gauge of the
    zone that gets there first: gauges beside it bend as well when it softens.
    """
    rows = []
    for run in runs:
        for row in table[table["case"] == run.run.name].itertuples():
            if run.run.rock.elastic:
                continue
            bound = elastic_bound(run, row.zone)
            percent = 100.0 * (row.initiation_MPa / bound - 1.0)
            word = OPEN if np.isnan(percent) else verdict(row.initiation_MPa >= bound)
            rows.append(_row(ELASTIC, row, bound, percent, 0.0, word))
    return rows


def elastic_bound(run: HoleRun, zone: str) -> float:
    """Axial stress [MPa] at which the first gauge of a zone would reach its strength elastically.

    The elastic solution of the mesh of a run is the run itself before any gauge yields, here its
    last record before that. NaN where the stress of all gauges is of the wrong sign.
    """
    probes = run.run.probes
    soft = probes["plastic_strain"] > 0.0
    for i in (1, 2, 3):
        strength = probes[f"tensile_strength_{i}_MPa"]
        soft |= strength < (1.0 - WHOLE) * run.run.rock.tensile_strength / MPA
    yielded = probes.loc[soft, "time_s"].min()
    row = int(np.flatnonzero(~(run.times >= yielded))[-1])
    load = run.stress[row]
    names = [gauge.name for gauge in run.zone(zone)]
    then = probes[np.isclose(probes["time_s"], run.times[row]) & probes["probe"].isin(names)]
    xx, yy, xy = (then[f"stress_{c}_MPa"].to_numpy() for c in ("xx", "yy", "xy"))
    middle, radius = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    rock = run.run.rock
    if zone == "sidewall":
        factors, strength = (radius - middle) / load, first_yield(rock.table, 0.0) / MPA
    else:
        factors, strength = (middle + radius) / load, rock.tensile_strength / MPA
    factors = factors[factors > 0.0]
    return float(strength / factors.max()) if factors.size else float("nan")


def _row(check: str, row, reference: float, percent: float, band: float, word: str) -> dict:
    return {
        "check": check,
        "case": row.case,
        "zone": row.zone,
        "criterion": row.criterion,
        "initiation_MPa": row.initiation_MPa,
        "reference_MPa": reference,
        "difference_percent": percent,
        "band_percent": band,
        "verdict": word,
    }
