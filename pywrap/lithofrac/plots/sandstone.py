"""Sandstone in triaxial and plane strain compression (Klerck 2004, Figs 9 and 10)."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.bench import Bench, find_bench
from lithofrac.analysis.mohr_coulomb import peak_line
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.analysis.tables import NOT_DIGITISED
from lithofrac.config.material import Material
from lithofrac.data import Curve, load_curves
from lithofrac.plots import style

TITLES = {
    ("triaxial", False): "triaxial, soft pressure",
    ("plane_strain", False): "plane strain, soft pressure",
    ("plane_strain", True): "plane strain, stiff sides",
}  # test, and whether its lateral faces are stiff
DEFAULT_STIFFNESS = 0.02  # over Young's modulus: the calibrated value of the plane strain series
SOFT = (
    (("triaxial", False), "o", style.BLUE),
    (("plane_strain", False), "*", style.GREEN),
)
SWEEP = (
    ("v", style.ORANGE), ("s", style.RED), ("D", style.PURPLE), ("P", style.SKY),
    ("<", style.BLACK),
)  # fmt: skip
SERIES = ("^", "x", "+", "1", "2")  # markers of digitised series


def stress_strain(inputs: list[Path], data: Path) -> Figure:
    """Fig. 9: axial stress against axial strain, one panel a test, one curve a confinement."""
    runs = [run for run in find_runs(inputs) if run.stiffness in (0.0, DEFAULT_STIFFNESS)]
    tests = [test for test in TITLES if any(kind(run) == test for run in runs)]
    mixed = len({run.discrete for run in runs}) == 2
    digitised = load_curves(data, "9")
    drawn, axes = style.new_figure(1, max(len(tests), 1), height=3.6, sharey=True)
    colours = style.confinement_colours([run.confinement_MPa for run in runs])
    for panel, test in zip(axes.flat, tests, strict=False):
        own = [run for run in runs if kind(run) == test]
        for run in own:
            dash = "--" if mixed and not run.discrete else "-"
            draw_curve(panel, run, colours[run.confinement_MPa], dash)
        for marker, curve in zip(SERIES, _of(digitised, own), strict=False):
            draw_points(panel, curve, marker)
        panel.set(title=TITLES[test], xlabel="axial strain [%]", xlim=(0, None), ylim=(0, None))
        if not any(curve.sheet.origin == "experiment" for curve in _of(digitised, own)):
            style.badge(panel, NOT_DIGITISED, "upper right")
        panel.set_ylim(0, 1.12 * panel.get_ylim()[1])
        handles, labels = panel.get_legend_handles_labels()
        if handles:
            panel.legend(handles, labels, loc="center right")
    axes[0, 0].set_ylabel("axial stress [MPa]")
    handles = [
        axes[0, 0].plot([], [], color=colour, label=f"{level:g}")[0]
        for level, colour in colours.items()
    ]
    handles += axes[0, 0].plot([], [], "o", ms=4, mfc="white", mec=style.BLACK, label="peak")
    for dash, words in (("-", "discrete"), ("--", "continuum")) if mixed else ():
        handles += axes[0, 0].plot([], [], dash, color=style.BLACK, label=words)
    drawn.legend(
        handles=handles,
        loc="outside upper center",
        ncols=len(handles),
        title="confinement [MPa]",
    )
    return drawn


def strength(inputs: list[Path], data: Path) -> Figure:
    """Fig. 10: strength against confinement, beside Table 1 and the stiff material point.

    `inputs` holds runs, and curves of the bench in stiff confinement.
    """
    runs = find_runs(inputs)
    drawn, axes = style.new_figure(height=4.2)
    panel = axes[0, 0]
    stiff = find_bench(inputs, "stiff_confinement")
    draw_line(panel, runs[0].rock, max(one.confinement_MPa for one in [*runs, *stiff]))
    draw_bench(panel, stiff)
    for test, marker, colour in SOFT:
        own = [run for run in runs if kind(run) == test]
        draw_series(panel, own, marker, colour, TITLES[test])
    sweep = sorted({(run.stiffness, run.discrete) for run in runs if run.stiffness > 0.0})
    for (marker, colour), (stiffness, discrete) in zip(SWEEP, sweep, strict=False):
        own = [run for run in runs if (run.stiffness, run.discrete) == (stiffness, discrete)]
        words = ", discrete" if discrete else ""
        label = f"plane strain, k = {stiffness:g} E{words}"
        draw_series(panel, own, marker, colour, label, hollow=discrete)
    digitised = load_curves(data, "10")
    for marker, curve in zip(SERIES, digitised, strict=False):
        panel.errorbar(
            curve.x,
            curve.y,
            xerr=curve.x_error,
            yerr=curve.y_error,
            fmt=marker,
            color=style.BLACK,
            ls="none",
            label=f"{curve.sheet.origin}: {curve.sheet.series}",
        )
    panel.set(xlabel="confinement [MPa]", ylabel="strength (first peak) [MPa]")
    panel.set_ylim(0, 1.05 * panel.get_ylim()[1])
    panel.legend(loc="upper left")
    if not any(curve.sheet.origin == "experiment" for curve in digitised):
        style.badge(panel, NOT_DIGITISED)
    return drawn


def kind(run: Run) -> tuple[str, bool]:
    """Test of a run, and whether its lateral faces are stiff; a key of `TITLES`."""
    return run.test, run.stiffness > 0.0


def draw_curve(axes: Axes, run: Run, colour, dash: str = "-") -> None:
    """Draw one run and its peak; strain in %."""
    strain, stress = 100.0 * run.history["axial_strain"], run.history["axial_stress_MPa"]
    axes.plot(strain, stress, dash, color=colour)
    if run.peak:
        axes.plot(100.0 * run.peak.strain, run.peak.stress, "o", ms=4, mfc="white", mec=colour)


def draw_points(axes: Axes, curve: Curve, marker: str) -> None:
    """Draw a digitised stress-strain curve; strain in %."""
    axes.errorbar(
        100.0 * curve.x,
        curve.y,
        xerr=100.0 * curve.x_error,
        yerr=curve.y_error,
        fmt=marker,
        ms=4,
        elinewidth=0.7,
        color=style.BLACK,
        label=f"{curve.sheet.origin}: {curve.sheet.series}",
    )


def draw_line(axes: Axes, rock: Material, end: float) -> None:
    """Draw the strength of a hardening table, largest over the plastic strain, up to `end` MPa."""
    confinement = np.linspace(0.0, end or 1.0, 61)
    line = peak_line(rock.table, 1e6 * confinement) / 1e6
    axes.plot(confinement, line, color=style.GREY, label="Table 1, closed form")


def draw_bench(axes: Axes, curves: list[Bench]) -> None:
    """Draw first peaks of the material point in stiff confinement."""
    peaks = [(curve.confinement_MPa, curve.peak.stress) for curve in curves if curve.peak]
    if peaks:
        label = f"material point, k = {DEFAULT_STIFFNESS:g} E"
        axes.plot(*zip(*peaks, strict=True), "--", color=style.GREY, label=label)


def draw_series(
    axes: Axes, runs: list[Run], marker: str, colour: str, label: str, hollow: bool = False
) -> None:
    """Draw first peaks; a run without one is a hollow mark on the axis with "no peak".

    Hollow marks are larger, so that what lies beneath them is seen.
    """
    peaks = [(run.confinement_MPa, run.peak.stress) for run in runs if run.peak]
    if peaks:
        looks = {"mfc": "none", "ms": 9.0} if hollow else {}
        axes.plot(*zip(*peaks, strict=True), marker, color=colour, label=label, **looks)
    without = [run.confinement_MPa for run in runs if run.peak is None]
    if without:
        height = np.full(len(without), 0.02)
        axes.plot(without, height, marker, mfc="white", mec=colour, clip_on=False,
                  transform=axes.get_xaxis_transform(), label=f"{label}: no peak")  # fmt: skip


def _of(curves: list[Curve], runs: list[Run]) -> list[Curve]:
    """Digitised curves that belong to these runs."""
    names = {run.name for run in runs}
    return [curve for curve in curves if curve.sheet.compare_with in names]
