"""Claims on the strip punch (Klerck 2004, section 3.1, Figs 6 and 7)."""

import numpy as np
import pandas as pd

from lithofrac.analysis.bands import crack_angles, near_axis_share
from lithofrac.analysis.claim_parts import (
    CannotCheckError,
    Check,
    Source,
    Value,
    distance,
    smallest,
)
from lithofrac.analysis.discrete import continuum_step
from lithofrac.analysis.inelastic import first_damage
from lithofrac.analysis.punch_pattern import (
    Strip,
    axial_extent,
    compressive_share_below,
    failed_zone,
    open_cracks,
    pattern,
    pattern_time,
)
from lithofrac.analysis.runs import Run
from lithofrac.analysis.stages import (
    Stages,
    brittleness,
    final_fall,
    find_stages,
    plateau,
)

LOWEST, HIGHER = "punch_gf60", ("punch_gf300", "punch_gf1200")
DISCRETE, TENSION = "punch_discrete", "punch_tension_only"
VARIED = tuple(f"{TENSION}_{what}" for what in ("coarse", "gf300", "intra"))


def _curve(run: Run) -> tuple[np.ndarray, np.ndarray]:
    return run.history["axial_strain"].to_numpy(), run.history["axial_stress_MPa"].to_numpy()


def _stages(run: Run) -> Stages:
    stages = find_stages(*_curve(run))
    if stages.a is None:
        raise CannotCheckError(f"{run.name} has no peak")
    return stages


def _initiation(source: Source) -> dict[str, Value]:
    run = source.run(LOWEST)
    state = first_damage(run)
    if state is None:
        raise CannotCheckError(f"no frame of {run.name} has damage")
    plastic, area = state.frame.plastic_strain, state.frame.areas()
    worst = np.argmax(plastic if plastic.max() > 0.0 else state.opening.max(axis=1))
    share = area[state.damaged & (plastic > 0.0)].sum() / area[state.damaged].sum()
    at = np.interp(state.frame.time_s, run.history["time_s"], run.history["axial_stress_MPa"])
    centroid = state.frame.centroids()[[worst]]
    return {
        "edge_distance": Value(float(Strip.of(run).to_edge(centroid)[0]), f"frame at {at:.0f} MPa"),
        "edge_first": Value(_first_at(run, "strip_edge") / _first_at(run, "axis")),
        "compressive_share": Value(100.0 * float(share)),
    }


def _first_at(run: Run, probe: str) -> float:
    """Punch stress at the first record with damage at a probe; inf without any [MPa]."""
    table = run.probes
    table = table[(table["probe"] == probe) & (table["time_s"] >= run.history["time_s"].iloc[0])]
    strengths = table[[f"tensile_strength_{i}_MPa" for i in (1, 2, 3)]].min(axis=1)
    hit = table[(table["plastic_strain"] > 0.0) | (strengths < strengths.iloc[0])]
    if hit.empty:
        return float("inf")
    moment = hit["time_s"].iloc[0]
    return float(np.interp(moment, run.history["time_s"], run.history["axial_stress_MPa"]))


def _drop(source: Source) -> dict[str, Value]:
    run = source.run(DISCRETE)
    stages, stress = _stages(run), _curve(run)[1]
    note = "no regain: the fall is the final one" if stages.c is None else ""
    return {"fall": Value(100.0 * (1.0 - stress[stages.b] / stress[stages.a]), note)}


def _hardening(source: Source) -> dict[str, Value]:
    stages = _stages(source.run(DISCRETE))
    return {"regain": Value(100.0 * stages.regain, "no regain" if stages.c is None else "")}


def _failure(source: Source) -> dict[str, Value]:
    run = source.run(DISCRETE)
    stages, stress = _stages(run), _curve(run)[1]
    row = stages.d if stages.d is not None else len(stress) - 1
    note = "no complete failure" if stages.d is None else ""
    return {
        "residual": Value(100.0 * stress[row] / stress[stages.a], note),
        "below_b": Value(float(stress[row] / stress[stages.b])),
    }


def _cone(source: Source) -> dict[str, Value]:
    run = source.run(LOWEST)
    zone = failed_zone(run, pattern(run))
    return {
        "taper": Value(zone.taper, f"{zone.depth_mm:.1f} mm deep"),
        "depth": Value(zone.depth_mm / Strip.of(run).width),
    }


def _cleavage(source: Source) -> dict[str, Value]:
    run = source.run(DISCRETE)
    return {"extent": Value(100.0 * axial_extent(run, pattern_time(run)), "at stage D")}


def _tensile_field(source: Source) -> dict[str, Value]:
    run = source.run(LOWEST)
    share = compressive_share_below(run, pattern(run))
    note = "nothing strained there" if np.isnan(share) else ""
    return {"compressive_share": Value(100.0 * share, note)}


def _echelon(source: Source) -> dict[str, Value]:
    """Cracks beside the axis, no further than the strip is wide and no deeper than the zone."""
    run = source.run(DISCRETE)
    strip, table = Strip.of(run), open_cracks(run, pattern_time(run))
    aside = np.abs(table["x_mm"] - strip.axis) / strip.width
    depth = strip.top - table["y_mm"]
    inside = aside.between(0.25, 1.0) & (depth <= failed_zone(run, pattern(run)).depth_mm)
    if not inside.any():
        raise CannotCheckError(f"{run.name} has no cracks in the cone")
    share, median = near_axis_share(table[inside]), np.median(crack_angles(table[inside]))
    return {"near_axis": Value(100.0 * share, f"{inside.sum()} crack edges, median {median:.0f}°")}


def _cone_length(source: Source) -> dict[str, Value]:
    run = source.run(DISCRETE)
    depth = failed_zone(run, pattern(run)).depth_mm
    raise CannotCheckError(f"{depth:.1f} mm here; no length of the experiment is printed")


def _low_gf(source: Source) -> dict[str, Value]:
    own = source.run(LOWEST)
    others = {name: brittleness(*_curve(source.run(name))) for name in HIGHER}
    ratio = brittleness(*_curve(own)) / min(others.values())
    stages = _stages(own)
    note = "no regain" if stages.c is None else ""
    return {"brittleness": Value(ratio), "regain": Value(100.0 * stages.regain, note)}


def _high_gf(source: Source) -> dict[str, Value]:
    curves = {name: _curve(source.run(name)) for name in HIGHER}
    lowest = brittleness(*_curve(source.run(LOWEST)))
    flat = smallest({name: 100.0 * plateau(*curve) for name, curve in curves.items()})
    slow = smallest({name: brittleness(*curve) / lowest for name, curve in curves.items()})
    return {"plateau": flat, "gradual": slow}


def _discrete(source: Source) -> dict[str, Value]:
    own, continuum = _curve(source.run(DISCRETE)), _curve(source.run(LOWEST))
    return {
        "plateau": Value(100.0 * plateau(*own)),
        "sudden": Value(final_fall(*own) / final_fall(*continuum)),
    }


def _agreement(source: Source) -> dict[str, Value]:
    curves = source.experiments("6a")
    known = {name: _curve(run) for name, run in source.runs.items() if run.test == "punch"}
    x, y = ({name: curve[i] for name, curve in known.items()} for i in (0, 1))
    return {"rms": distance(curves, x, y)}


def _coupling(source: Source) -> dict[str, Value]:
    raise CannotCheckError("the law has no switch that takes the coupling alone away")


def _time_step(source: Source) -> dict[str, Value]:
    run = source.run(DISCRETE)
    continuum = continuum_step(run, list(source.runs.values()))
    return {"ratio": Value(run.summary["time_step_min_s"] / continuum, "none is needed here")}


def _tension_only(source: Source) -> dict[str, Value]:
    peak = float(_curve(source.run(TENSION))[1].max())
    peaks = {
        name: float(_curve(source.runs[name])[1].max()) for name in VARIED if name in source.runs
    }
    if not peaks:
        return {"peak": Value(peak), "spread": Value(float("nan"), "no run to compare")}
    words = ", ".join(
        f"{name.removeprefix(TENSION + '_')} {v:.0f} MPa" for name, v in peaks.items()
    )
    moved = max(abs(value / peak - 1.0) for value in peaks.values())
    return {"peak": Value(peak), "spread": Value(100.0 * moved, words)}


def _tension_excess(source: Source) -> dict[str, Value]:
    largest = [_curve(source.run(name))[1].max() for name in (TENSION, DISCRETE)]
    return {"ratio": Value(float(largest[0] / largest[1]))}


def _tension_crack(source: Source) -> dict[str, Value]:
    run = source.run(TENSION)
    strip, time_s = Strip.of(run), pattern_time(run)
    aside = np.abs(_opened(run)["x_mm"] - strip.axis) <= 0.5 * strip.width
    return {
        "extent": Value(100.0 * axial_extent(run, time_s), "at stage D"),
        "alone": Value(_length_share(_opened(run), aside)),
    }


def _tension_pattern(source: Source) -> dict[str, Value]:
    """Cracks near an edge of the strip, further than a quarter of its width from the axis."""
    run = source.run(TENSION)
    strip, table = Strip.of(run), _opened(run)
    near = strip.to_edge(table[["x_mm", "y_mm"]].to_numpy()) <= 0.5 * strip.width
    near &= np.abs(table["x_mm"] - strip.axis) > 0.25 * strip.width
    return {"edge_share": Value(_length_share(table, near), "at stage D")}


def _opened(run: Run) -> pd.DataFrame:
    table = open_cracks(run, pattern_time(run))
    if table.empty:
        raise CannotCheckError(f"{run.name} has no cracks")
    return table


def _length_share(table: pd.DataFrame, chosen: pd.Series) -> float:
    """Share of the crack length that is chosen [%]."""
    return 100.0 * float(table.loc[chosen, "length_mm"].sum() / table["length_mm"].sum())


CURVE, PATTERN = "punch.svg", "punch_patterns.svg"
PUNCH = {
    "punch_initiation": Check(_initiation, PATTERN),
    "punch_drop": Check(_drop, CURVE),
    "punch_hardening": Check(_hardening, CURVE),
    "punch_failure": Check(_failure, CURVE),
    "punch_cone": Check(_cone, PATTERN),
    "punch_cleavage": Check(_cleavage, PATTERN),
    "punch_tensile_field": Check(_tensile_field, PATTERN),
    "punch_echelon": Check(_echelon, PATTERN),
    "punch_cone_length": Check(_cone_length, PATTERN),
    "punch_low_gf": Check(_low_gf, CURVE),
    "punch_high_gf": Check(_high_gf, CURVE),
    "punch_discrete": Check(_discrete, CURVE),
    "punch_agreement": Check(_agreement, CURVE),
    "punch_coupling": Check(_coupling, CURVE),
    "punch_time_step": Check(_time_step, CURVE),
    "punch_tension_only": Check(_tension_only, CURVE),
    "punch_tension_excess": Check(_tension_excess, CURVE),
    "punch_tension_crack": Check(_tension_crack, PATTERN),
    "punch_tension_pattern": Check(_tension_pattern, PATTERN),
}
