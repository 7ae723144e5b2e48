"""Claims on sandstone in triaxial and plane strain compression (Klerck 2004, section 3.2)."""

from itertools import pairwise

import numpy as np

from lithofrac.analysis.bands import crack_angles, find_band, near_axis_share
from lithofrac.analysis.claim_parts import (
    CannotCheckError,
    Check,
    Source,
    Value,
    distance,
    largest,
    smallest,
)
from lithofrac.analysis.localisation import band_width
from lithofrac.analysis.runs import Run

TRIAXIAL, SOFT, STIFF = "sandstone_triaxial", "sandstone_soft", "sandstone_plane_strain"
SWEEP = ("sandstone_plane_strain_k01", "sandstone_plane_strain_k02", "sandstone_plane_strain_k05")
# Of the rise to the peak, where slopes are taken; first yield at 30 MPa is at 0.24 of it.
FIRST, SECOND = (0.02, 0.10), (0.10, 0.20)
EXACT_DEG = 1.0  # a segment within this angle of the load axis counts as exactly vertical


def slope(run: Run, part: tuple[float, float]) -> float:
    """Slope of the curve between two shares of its rise to the peak [MPa]."""
    curve = run.history.iloc[: _peak(run).index + 1]
    stress = curve["axial_stress_MPa"].to_numpy()
    share = (stress - stress[0]) / (stress[-1] - stress[0])
    inside = (share >= part[0]) & (share <= part[1])
    return float(np.polyfit(curve["axial_strain"].to_numpy()[inside], stress[inside], 1)[0])


def inelastic_share(run: Run) -> float:
    """Share of the strain at the peak that the elastic slope of the curve does not explain [%]."""
    peak = _peak(run)
    rise = peak.stress - float(run.history["axial_stress_MPa"].iloc[0])
    return 100.0 * (1.0 - rise / slope(run, SECOND) / peak.strain)


def hardening(run: Run) -> float:
    """Rise after the lowest stress behind the peak, over the peak [%]."""
    peak = _peak(run)
    after = run.history["axial_stress_MPa"].to_numpy()[peak.index :]
    lowest = int(np.argmin(after))
    return 100.0 * float(after[lowest:].max() - after[lowest]) / peak.stress


def _peak(run: Run):
    if run.peak is None:
        raise CannotCheckError(f"{run.name} has no peak")
    return run.peak


def _end(run: Run) -> float:
    return float(run.history["axial_stress_MPa"].iloc[-1])


def _initial(source: Source) -> dict[str, Value]:
    runs = [run for name in (TRIAXIAL, SOFT, STIFF) for run in source.series(name) if run.peak]
    bends = {run.name: 100.0 * abs(slope(run, SECOND) / slope(run, FIRST) - 1.0) for run in runs}
    return {"bend": largest(bends)}


def _triaxial(source: Source) -> dict[str, Value]:
    runs = source.series(TRIAXIAL)
    left = {run.name: 100.0 * _end(run) / _peak(run).stress for run in runs}
    residual = largest(left)
    note = f"{residual.note}; {min(left.values()):.0f} % at {runs[0].confinement_MPa:g} MPa"
    return {
        "bend": smallest({run.name: inelastic_share(run) for run in runs}),
        "residual": Value(residual.value, note),
    }


def _plane_strain(source: Source) -> dict[str, Value]:
    runs = source.series(STIFF)
    return {
        "bend": largest({run.name: inelastic_share(run) for run in runs}),
        "hardening": smallest({run.name: hardening(run) for run in runs}),
    }


def _bend(source: Source) -> dict[str, Value]:
    pairs = _pairs(source, TRIAXIAL, STIFF)
    return {
        "difference": largest(
            {stiff.name: inelastic_share(stiff) - inelastic_share(soft) for soft, stiff in pairs}
        )
    }


def _rises(source: Source) -> dict[str, Value]:
    steps = {}
    for name in (TRIAXIAL, SOFT, STIFF):
        for low, high in pairwise(source.series(name, needed=2)):
            gained = _peak(high).stress - _peak(low).stress
            steps[f"{low.name} to {high.name}"] = gained / (
                high.confinement_MPa - low.confinement_MPa
            )
    return {"rise": smallest(steps)}


def _above(source: Source) -> dict[str, Value]:
    pairs = _pairs(source, TRIAXIAL, STIFF)
    return {"excess": smallest({stiff.name: _excess(soft, stiff) for soft, stiff in pairs})}


def _stiffness(source: Source) -> dict[str, Value]:
    """Runs that differ in the lateral stiffness alone: soft, then the sweep of the continuum."""
    strength, end = {}, {}
    for below, above in pairwise((SOFT, *SWEEP)):
        for low, high in _pairs(source, below, above):
            strength[high.name] = _excess(low, high)
            end[high.name] = 100.0 * (_end(high) / _end(low) - 1.0)
    return {"strength": smallest(strength), "end": smallest(end)}


def _excess(low: Run, high: Run) -> float:
    return 100.0 * (_peak(high).stress / _peak(low).stress - 1.0)


def _pairs(source: Source, first: str, second: str) -> list[tuple[Run, Run]]:
    """Runs of two series at the same confinement."""
    others = {run.confinement_MPa: run for run in source.series(second)}
    pairs = [
        (run, others[run.confinement_MPa])
        for run in source.series(first)
        if run.confinement_MPa in others
    ]
    if not pairs:
        raise CannotCheckError(f"no confinement at which both {first} and {second} were run")
    return pairs


def _agreement(source: Source) -> dict[str, Value]:
    curves = source.experiments("10")
    x, y = {}, {}
    for name in (TRIAXIAL, SOFT, STIFF):
        if any(known.startswith(f"{name}_p") for known in source.runs):
            runs = [run for run in source.series(name) if run.peak]
            x[name] = np.array([run.confinement_MPa for run in runs])
            y[name] = np.array([run.peak.stress for run in runs])
    return {"rms": distance(curves, x, y)}


def width(run: Run) -> float:
    """Width of the band at the end over the size of an element."""
    return band_width(run.last_frame) / float(run.case["scene"]["element_size_mm"])


def _localised(source: Source, name: str) -> dict[str, float]:
    widths = {run.name: width(run) for run in source.series(name)}
    known = {name: value for name, value in widths.items() if not np.isnan(value)}
    if not known:
        raise CannotCheckError(f"no plastic strain in {name}_p*")
    return known


def _width(source: Source) -> dict[str, Value]:
    return {"width": largest(_localised(source, STIFF))}


def _alike(source: Source) -> dict[str, Value]:
    known = [_localised(source, name) for name in (SOFT, STIFF)]
    soft, stiff = (float(np.mean(list(widths.values()))) for widths in known)
    note = f"{soft:.2g} elements under soft pressure, {stiff:.2g} between platens"
    by_end = [{name.removeprefix(series): width for name, width in widths.items()}
              for series, widths in zip((SOFT, STIFF), known, strict=True)]  # fmt: skip
    pairs = {end: (width, by_end[1][end]) for end, width in by_end[0].items() if end in by_end[1]}
    if pairs:
        end = max(pairs, key=lambda end: max(pairs[end]) / min(pairs[end]))
        one, other = pairs[end]
        pressure = source.run(f"{SOFT}{end}").confinement_MPa
        note += f", furthest apart at {pressure:g} MPa: {one:.3g} against {other:.3g}"
    return {"ratio": Value(max(soft / stiff, stiff / soft), note)}


def _cracked(source: Source) -> list[Run]:
    runs = [run for run in source.series(STIFF) if run.discrete and len(run.cracks)]
    if not runs:
        raise CannotCheckError(f"no cracks in {STIFF}_p*")
    return runs


def _echelon(source: Source) -> dict[str, Value]:
    """Band and segments of the runs that have one band."""
    runs = _cracked(source)
    near = smallest({run.name: 100.0 * near_axis_share(run.cracks) for run in runs})
    oblique = {}
    for run in runs:
        band = find_band(run.last_frame)
        if not band.note:
            oblique[run.name] = band.angle_deg - float(np.median(crack_angles(run.cracks)))
    one = smallest(oblique) if oblique else Value(float("nan"), "no run has a single band")
    return {"near_axis": near, "oblique": one}


def _vertical(source: Source) -> dict[str, Value]:
    shares = {run.name: 100.0 * near_axis_share(run.cracks, EXACT_DEG) for run in _cracked(source)}
    return {"vertical": largest(shares)}


def _pattern(source: Source) -> dict[str, Value]:
    raise CannotCheckError("the photograph of Fig. 11b is not at hand")


CURVES, STRENGTH, EVOLUTION = "stress_strain.svg", "strength.svg", "fracture_evolution.svg"
SANDSTONE = {
    "initial_linear": Check(_initial, CURVES),
    "triaxial_curve": Check(_triaxial, CURVES),
    "plane_strain_curve": Check(_plane_strain, CURVES),
    "plane_strain_bend": Check(_bend, CURVES),
    "strength_rises": Check(_rises, STRENGTH),
    "plane_strain_above": Check(_above, STRENGTH),
    "stiffness_raises": Check(_stiffness, "stiffness_sweep.svg"),
    "sandstone_agreement": Check(_agreement, STRENGTH),
    "localisation_width": Check(_width, EVOLUTION),
    "localisation_alike": Check(_alike, "fracture_series.svg"),
    "sandstone_echelon": Check(_echelon, EVOLUTION),
    "echelon_vertical": Check(_vertical, EVOLUTION),
    "sandstone_pattern": Check(_pattern, EVOLUTION),
}
