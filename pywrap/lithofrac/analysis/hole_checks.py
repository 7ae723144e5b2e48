"""Checks of the initiation stresses: null test, convergence, bound of the elastic solution."""

from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.analysis.hole import HoleRun
from lithofrac.analysis.hole_tables import MPA, hole_initiation, hole_runs
from lithofrac.analysis.mohr_coulomb import first_yield
from lithofrac.analysis.verdict import OPEN, verdict

COLUMNS = [
    "check", "case", "zone", "criterion", "initiation_MPa", "reference_MPa",
    "difference_percent", "band_percent", "verdict",
]  # fmt: skip
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
    bands = pd.read_csv(file).set_index("quantity")["band"]
    table, runs = hole_initiation(paths, data), hole_runs(paths)
    rows = [
        *_null_test(table, bands["hole_null_test"]),
        *_variants(table, bands["hole_convergence"]),
        *_elastic(table, runs),
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def _null_test(table: pd.DataFrame, band: float) -> list[dict]:
    """Runs with Gf, ramps and damping in proportion to R, against their own mean."""
    rows = []
    own = table[table["series"] == "null"]
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
    """No initiation below the load at which the elastic gauge of the same mesh reaches strength.

    That is ft at crown and fan, the first yield of Table 1 at the sidewall. A value whose interval
    reaches the bound is not below it.
    """
    elastic = {run.radius_mm: run for run in runs if run.series == "elastic"}
    rows = []
    for run in runs:
        if run.series != "similar" or run.seed != 1 or run.radius_mm not in elastic:
            continue
        for row in table[table["case"] == run.run.name].itertuples():
            bound = elastic_bound(elastic[run.radius_mm], run, row.zone, row.probe)
            percent = 100.0 * (row.initiation_MPa / bound - 1.0)
            word = OPEN if np.isnan(percent) else verdict(row.high_MPa >= bound)
            rows.append(_row(ELASTIC, row, bound, percent, 0.0, word))
    return rows


def elastic_bound(elastic: HoleRun, run: HoleRun, zone: str, probe: str) -> float:
    """Axial stress [MPa] at which a gauge of the elastic run reaches the strength of `run`.

    `probe` is the gauge, or empty for the one of the zone that gets there first; NaN where the
    elastic stress of the gauge is of the wrong sign.
    """
    probes = pd.read_parquet(elastic.run.folder / "probes.parquet")
    last = float(elastic.times[int(np.argmax(elastic.stress))])
    load = float(elastic.stress.max())
    names = [probe] if probe else [gauge.name for gauge in elastic.zone(zone)]
    at_end = probes[np.isclose(probes["time_s"], last) & probes["probe"].isin(names)]
    xx, yy, xy = (at_end[f"stress_{c}_MPa"].to_numpy() for c in ("xx", "yy", "xy"))
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
