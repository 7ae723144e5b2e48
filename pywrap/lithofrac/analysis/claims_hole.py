"""Claims on the hole in a block (Klerck 2004, section 3.3, Figs 12 to 16).

Initiation stresses are those of the paper's own criterion: of single runs from the table
`hole_initiation`, means over the realisations of a mesh from the table `size_effect`.
"""

import itertools
import re

import numpy as np
import pandas as pd
from scipy.stats import spearmanr

from lithofrac.analysis.claim_parts import (
    CannotCheckError,
    Check,
    Source,
    Value,
    distance,
    largest,
    smallest,
)
from lithofrac.analysis.hole import AFTER
from lithofrac.analysis.hole_cracks import direction_deg, hole_radius, zoned_cracks
from lithofrac.analysis.runs import Run

MAIN = re.compile(r"hole_r\d+\.\d(@seed\d+)?")  # blocks similar at every radius
SHOWN = re.compile(r"hole_r25\.0(@seed\d+)?")  # the radius of Figs 14 and 15
SERIES = "similar"  # the same in the tables
CRITERION, STRESS = "curvature", "initiation_MPa"
ZONES = ("primary", "remote", "sidewall")
FIGURES = dict(zip(ZONES, ("16a", "16b", "16c"), strict=True))
APART = 0.01  # relative difference of stress at which both sides do not begin at once


def initiation(source: Source) -> pd.DataFrame:
    """Rows of the paper's criterion that have a stress before the largest, R of Fig. 15."""
    table = _shown(source)
    table = table[table["criterion"] == CRITERION]
    if table.empty:
        raise CannotCheckError("the table hole_initiation has no initiation at R = 25 mm")
    return table


def _shown(source: Source) -> pd.DataFrame:
    """The same by every criterion."""
    table = source.table("hole_initiation")
    chosen = table["case"].map(lambda name: SHOWN.fullmatch(name) is not None)
    return table[chosen & (table["note"] != AFTER)].dropna(subset=STRESS)


def by_radius(source: Source, zone: str, needed: int = 3) -> pd.Series:
    """Mean initiation stress over the realisations [MPa], by rising radius [mm]."""
    table = source.table("size_effect")
    chosen = (table["series"] == SERIES) & (table["criterion"] == CRITERION)
    table = table[chosen & (table["zone"] == zone)]
    means = table.set_index("radius_mm")["mean_MPa"].dropna().sort_index()
    if len(means) < needed:
        raise CannotCheckError(f"{zone} initiation at {len(means)} of at least {needed} radii")
    return means


def _order(source: Source) -> dict[str, Value]:
    table = initiation(source).pivot_table(STRESS, "case", "zone")
    missing = [zone for zone in ZONES if zone not in table]
    if missing:
        raise CannotCheckError(f"no {missing[0]} initiation at R = 25 mm")
    remote, sidewall = table["remote"] - table["primary"], table["sidewall"] - table["remote"]
    last = smallest(sidewall.to_dict())
    words = "; ".join([last.note, *_other_order(source)])
    return {"remote": smallest(remote.to_dict()), "sidewall": Value(last.value, words)}


def _other_order(source: Source) -> list[str]:
    """Where another order stands beside the one that is judged, in words.

    By the other criteria, within the intervals of the judged stresses, and at the other radii.
    """
    table, words = _shown(source), []
    for criterion, own in table.groupby("criterion"):
        reverse = _reversed(*2 * [own.pivot_table(STRESS, "case", "zone")])
        if criterion != CRITERION and reverse:
            words.append(f"reversed by {criterion} in {', '.join(reverse)}")
    own = table[table["criterion"] == CRITERION]
    low, high = (own.pivot_table(f"{end}_MPa", "case", "zone") for end in ("low", "high"))
    if overlap := _reversed(low, high):
        words.append(f"intervals overlap in {', '.join(overlap)}")
    if "size_effect" in source.tables:
        means = pd.DataFrame({zone: by_radius(source, zone) for zone in ZONES})
        if reverse := _reversed(means, means):
            shown = [f"{radius:g} mm by {by:.2g} MPa" for radius, by in reverse.items()]
            words.append(f"means reversed at R = {', '.join(shown)}")
    return words


def _reversed(low: pd.DataFrame, high: pd.DataFrame) -> dict:
    """Rows in which a zone starts by its low end before the one ahead of it does by its high end.

    `low` and `high` have a column a zone; the result is the largest difference by row [MPa].
    """
    pairs = [(high.get(a), low.get(b)) for a, b in itertools.pairwise(ZONES)]
    behind = [first - second for first, second in pairs if first is not None and second is not None]
    if not behind:
        return {}
    most = pd.concat(behind, axis=1).max(axis=1)
    return most[most > 0.0].to_dict()


def _bound(source: Source) -> dict[str, Value]:
    table = initiation(source)
    return {"largest": largest(table.groupby("zone")[STRESS].max().to_dict())}


def _cracked(source: Source, cases: re.Pattern, zone: str) -> dict[str, pd.DataFrame]:
    """Cracks of a zone by run, of those runs that have any there."""
    runs = [run for name, run in source.runs.items() if cases.fullmatch(name) and run.discrete]
    if not runs:
        raise CannotCheckError("no run with cracks at a hole")
    tables = {run.name: zoned_cracks(run) for run in runs}
    tables = {name: table[table["zone"] == zone] for name, table in tables.items()}
    tables = {name: table for name, table in tables.items() if len(table)}
    if not tables:
        raise CannotCheckError(f"no {zone} crack in any of {len(runs)} runs")
    return tables


def _primary_parallel(source: Source) -> dict[str, Value]:
    tables = _cracked(source, MAIN, "primary")
    return {"direction": largest({name: direction_deg(table) for name, table in tables.items()})}


def _remote_parallel(source: Source) -> dict[str, Value]:
    """Each run and each side by itself: cracks that lean to both sides would have an upright mean.

    What opens after the largest stress belongs to the collapse of the block.
    """
    sides, angles = {-1: "left", 1: "right"}, {}
    for name, table in _cracked(source, MAIN, "remote").items():
        history = source.run(name).history
        end = history["time_s"][history["axial_stress_MPa"].idxmax()]
        for side, own in table[table["time_s"] <= end].groupby("side"):
            angles[f"{name}, {sides[side]}"] = direction_deg(own)
    if not angles:
        raise CannotCheckError("no remote crack before the largest stress")
    return {"direction": largest(angles)}


def _place(source: Source) -> dict[str, Value]:
    tips, walls = {}, {}
    for name, table in _cracked(source, SHOWN, "remote").items():
        run, first = source.run(name), table.iloc[0]
        walls[name] = float(first["radius"]) - 1.0
        tips[name] = _to_primary(run, first) / hole_radius(run)
    return {"to_tip": largest(tips), "from_wall": smallest(walls)}


def _to_primary(run: Run, crack: pd.Series) -> float:
    """Distance of a crack from the outer end of the primary one at that time [mm]."""
    table = zoned_cracks(run)
    table = table[(table["zone"] == "primary") & (table["time_s"] <= crack["time_s"])]
    if table.empty:
        return float("nan")
    ends = np.concatenate([table[[f"x{i}_mm", f"y{i}_mm"]].to_numpy() for i in (1, 2)])
    tip = ends[np.argmax(np.linalg.norm(ends, axis=1))]
    middle = 0.5 * np.array([crack["x1_mm"] + crack["x2_mm"], crack["y1_mm"] + crack["y2_mm"]])
    return float(np.linalg.norm(middle - tip))


def _growth(source: Source) -> dict[str, Value]:
    tables = _cracked(source, SHOWN, "remote")
    inward = {name: _first(table) - table["radius"].min() for name, table in tables.items()}
    outward = {name: table["radius"].max() - _first(table) for name, table in tables.items()}
    return {"inward": smallest(inward), "outward": smallest(outward)}


def _first(table: pd.DataFrame) -> float:
    return float(table["radius"].iloc[0])


def _apart(source: Source) -> dict[str, Value]:
    """A side without any remote crack counts as one that does not begin at once."""
    tables = _cracked(source, MAIN, "remote")
    apart = []
    for table in tables.values():
        first = table.groupby("side")["stress_MPa"].first()
        apart.append(len(first) < 2 or first.max() > (1.0 + APART) * first.min())
    return {"share": Value(100.0 * float(np.mean(apart)), f"runs: {len(tables)}, upper half")}


def _breakout(source: Source) -> dict[str, Value]:
    table = pd.concat(_cracked(source, MAIN, "sidewall").values())
    compressive = table.loc[table["mode"] != "tensile", "length_mm"].sum()
    share = float(compressive / table["length_mm"].sum())
    return {"compressive_share": Value(100.0 * share, f"{len(table)} crack edges")}


def _agreement(source: Source) -> dict[str, Value]:
    curves = [curve for figure in FIGURES.values() for curve in _known(source, figure)]
    if not curves:
        source.experiments("16a")
    stresses = {f"hole_{zone}": by_radius(source, zone) for zone in ZONES}
    x = {name: means.index.to_numpy() for name, means in stresses.items()}
    return {"rms": distance(curves, x, {name: one.to_numpy() for name, one in stresses.items()})}


def _known(source: Source, figure: str):
    try:
        return source.experiments(figure)
    except CannotCheckError:
        return []


def _strain(source: Source) -> dict[str, Value]:
    source.experiments("15")
    raise CannotCheckError("no initiation strain is read from the digitised curves")


def _size(source: Source) -> dict[str, Value]:
    quotients, left = {}, {}
    for zone in ZONES:
        means = by_radius(source, zone)
        radius, stress = means.index.to_numpy(), means.to_numpy()
        quotients[zone] = stress[-1] / stress[0]
        late = np.interp(0.5 * radius[-1], radius, stress) - stress[-1]
        fall = stress[0] - stress[-1]
        left[zone] = 100.0 * late / fall if fall > 0.0 else float("nan")
    return {"ratio": largest(quotients), "slope": largest(left)}


def _falls(zone: str):
    def measures(source: Source) -> dict[str, Value]:
        means = by_radius(source, zone)
        same = means.nunique() == 1
        rank = 0.0 if same else float(spearmanr(means.index, means).statistic)
        note = f"{means.iloc[0]:.1f} to {means.iloc[-1]:.1f} MPa over {len(means)} radii"
        note += _by_other_criteria(source, zone)
        ratio = float(means.iloc[-1] / means.iloc[0])
        return {"correlation": Value(rank, note), "ratio": Value(ratio)}

    return measures


def _by_other_criteria(source: Source, zone: str) -> str:
    """The same stresses by the criteria that are not the paper's, in words."""
    table = source.table("size_effect")
    chosen = (table["series"] == SERIES) & (table["zone"] == zone)
    words = ""
    for criterion, own in table[chosen].dropna(subset="mean_MPa").groupby("criterion"):
        means = own.set_index("radius_mm")["mean_MPa"].sort_index()
        if criterion != CRITERION:
            words += f"; by {criterion} {means.iloc[0]:.1f} to {means.iloc[-1]:.1f} MPa"
            words += f" from R = {means.index[0]:g} mm on"
    return words


def _asymptotes(source: Source) -> dict[str, Value]:
    """Those that the radii determine; a fit that does not says so in its note."""
    table = source.table("hole_fits")
    chosen = (table["series"] == SERIES) & (table["criterion"] == CRITERION) & table["note"].isna()
    ends = table[chosen].set_index("zone")["asymptote_MPa"].dropna().sort_values()
    if len(ends) < 2:
        raise CannotCheckError(f"{len(ends)} of 3 asymptotes are determined")
    gap = 100.0 * float(np.diff(ends).min() / ends.mean())
    words = ", ".join(f"{zone} {value:.1f} MPa" for zone, value in ends.items())
    return {"gap": Value(gap, f"{words}; whether a stress falls towards them is 16a to 16c")}


def _below(zone: str):
    def measures(source: Source) -> dict[str, Value]:
        stress = by_radius(source, zone)
        return {"largest": Value(float(stress.max()), f"at R = {stress.idxmax():g} mm")}

    return measures


GAUGES, SIZE, STAGES = "hole_gauges.svg", "size_effect.svg", "hole_patterns.svg"
HOLE = {
    "hole_order": Check(_order, GAUGES),
    "hole_primary_parallel": Check(_primary_parallel, STAGES),
    "hole_remote_parallel": Check(_remote_parallel, STAGES),
    "hole_remote_place": Check(_place, STAGES),
    "hole_remote_growth": Check(_growth, STAGES),
    "hole_remote_apart": Check(_apart, STAGES),
    "hole_breakout": Check(_breakout, STAGES),
    "hole_agreement": Check(_agreement, SIZE),
    "hole_strain": Check(_strain, GAUGES),
    "hole_stress_bound": Check(_bound, GAUGES),
    "size_effect": Check(_size, SIZE),
    "size_asymptotes": Check(_asymptotes, SIZE),
    **{f"size_{zone}_falls": Check(_falls(zone), SIZE) for zone in ZONES},
    **{f"size_{zone}_bound": Check(_below(zone), SIZE) for zone in ZONES},
}
