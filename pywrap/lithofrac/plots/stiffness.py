"""Plane strain at several lateral stiffnesses (Klerck 2004, section 3.2: the loading system)."""

from pathlib import Path

from matplotlib.figure import Figure

from lithofrac.analysis.runs import Run, find_runs
from lithofrac.data import DataError
from lithofrac.plots import style
from lithofrac.plots.sandstone import draw_curve

MOST = 3  # panels
HARD = 1.0  # over E: stiffer sides hardly give way, their curve leaves the panel
ABOVE = 1.3  # of the highest peak, shown


def figure(inputs: list[Path], data: Path) -> Figure:
    """Axial stress against axial strain, one panel a confinement, one curve a stiffness.

    Drawn are the lowest, the middle and the highest confinement at which most stiffnesses were
    run. Discrete runs are solid, continuum runs dashed.
    """
    runs = [run for run in find_runs(inputs) if run.test == "plane_strain"]
    if not runs:
        raise DataError("plot stiffness_sweep: no run in plane strain among the inputs")
    shown = _chosen(runs)
    levels = sorted({run.stiffness for run in runs})
    colours = style.confinement_colours(levels)
    drawn, axes = style.new_figure(1, len(shown), height=3.8)
    for panel, confinement in zip(axes[0], shown, strict=True):
        own = [run for run in runs if run.confinement_MPa == confinement]
        for run in own:
            draw_curve(panel, run, colours[run.stiffness], "-" if run.discrete else "--")
        panel.set(title=f"{confinement:g} MPa", xlabel="axial strain [%]", xlim=(0, None))
        top = [run.history["axial_stress_MPa"].max() for run in own if run.stiffness < HARD]
        panel.set_ylim(0, ABOVE * max(top) if top else None)
    axes[0, 0].set_ylabel("axial stress [MPa]")
    handles = [
        axes[0, 0].plot([], [], color=colours[level], label=f"{level:g} E" if level else "soft")[0]
        for level in levels
    ]
    for dash, words, is_kind in (("-", "discrete", True), ("--", "continuum", False)):
        if any(run.discrete == is_kind for run in runs):
            handles += axes[0, 0].plot([], [], dash, color=style.BLACK, label=words)
    drawn.legend(
        handles=handles, loc="outside upper center", ncols=len(handles), title="lateral stiffness"
    )
    return drawn


def _chosen(runs: list[Run]) -> list[float]:
    """Confinements with the most stiffnesses: all, or the lowest, middle and highest [MPa]."""
    kinds = {
        level: len({run.stiffness for run in runs if run.confinement_MPa == level})
        for level in sorted({run.confinement_MPa for run in runs})
    }
    levels = [level for level, count in kinds.items() if count == max(kinds.values())]
    return levels if len(levels) <= MOST else [levels[0], levels[len(levels) // 2], levels[-1]]
