"""Load curve of a run with discrete cracks, and when each of them opened."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from lithofrac.analysis.runs import Run, find_runs
from lithofrac.plots import style
from lithofrac.plots.fractures import MODES


def figure(inputs: list[Path], data: Path) -> Figure:
    """Stress over the crack edges, one tick each, over their length; against axial strain.

    A run without cracks shows its stress alone.
    """
    run = find_runs(inputs)[0]
    if run.cracks.empty:
        return _without_cracks(run)
    drawn, axes = style.new_figure(
        3, 1, height=4.6, sharex=True, gridspec_kw={"height_ratios": [3, 0.5, 1.4]}
    )
    curve, ticks, length = axes[:, 0]
    draw_stress(curve, run)
    draw_ticks(ticks, run)
    draw_length(length, run)
    curve.set_title(run.name)
    length.set_xlabel("axial strain [%]")
    length.set_xlim(0.0, 100.0 * run.history["axial_strain"].max())
    return drawn


def _without_cracks(run: Run) -> Figure:
    drawn, axes = style.new_figure(1, 1, height=3.0)
    curve = axes[0, 0]
    draw_stress(curve, run)
    style.badge(curve, "no cracks")
    curve.set(title=run.name, xlabel="axial strain [%]")
    curve.set_xlim(0.0, 100.0 * run.history["axial_strain"].max())
    return drawn


def strain_at(run: Run, time_s: np.ndarray) -> np.ndarray:
    """Axial strain at moments, (n,) [%]; 0 before the axial loading."""
    return 100.0 * np.interp(time_s, run.history["time_s"], run.history["axial_strain"])


def draw_stress(axes: Axes, run: Run) -> None:
    """Draw axial stress (of a punch: over the strip), its first peak and the first crack."""
    history = run.history
    axes.plot(100.0 * history["axial_strain"], history["axial_stress_MPa"], color=style.BLACK)
    if run.peak:
        axes.plot(
            100.0 * run.peak.strain, run.peak.stress, "o", ms=4, mfc="white", mec=style.BLACK,
            label=f"first peak: {run.peak.stress:.4g} MPa",
        )  # fmt: skip
    if len(run.cracks):
        first = strain_at(run, run.cracks["time_s"].iloc[0])
        axes.axvline(first, color=style.GREY, ls=":", label=f"first crack: {first:.3g} %")
    axes.set(ylabel=stress_label(run), ylim=(0, None))
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="best")


def draw_ticks(axes: Axes, run: Run) -> None:
    """Draw a tick for each crack edge at the strain at which it opened, one row a mode."""
    for row, (mode, (_, colour)) in enumerate(MODES.items()):
        strain = strain_at(run, run.cracks.loc[run.cracks["mode"] == mode, "time_s"].to_numpy())
        ends = [[(x, -row - 0.4), (x, -row + 0.4)] for x in strain]
        axes.add_collection(LineCollection(ends, colors=colour, linewidths=0.6, alpha=0.7))
    counts = run.cracks["mode"].value_counts()
    labels = [f"{words}: {counts.get(mode, 0)}" for mode, (words, _) in MODES.items()]
    axes.set_yticks(-np.arange(len(MODES)), labels)
    axes.set_ylim(-len(MODES) + 0.4, 0.6)
    axes.set_ylabel("crack\nedges")
    axes.grid(visible=False)
    axes.tick_params(left=False)


def draw_length(axes: Axes, run: Run) -> None:
    """Draw the cumulated crack length, of each mode and of both."""
    end = run.history["time_s"].iloc[-1]
    parts = [("all", style.BLACK, run.cracks)]
    parts += [(words, colour, run.cracks[run.cracks["mode"] == mode])
              for mode, (words, colour) in MODES.items()]  # fmt: skip
    for words, colour, table in parts:
        strain = strain_at(run, np.concatenate([[0.0], table["time_s"], [end]]))
        length = np.concatenate([[0.0], table["length_mm"].cumsum(), [table["length_mm"].sum()]])
        axes.step(strain, length, where="post", color=colour, label=words)
    axes.set(ylabel="crack length\n[mm]", ylim=(0, None))
    axes.set_ylim(top=1.35 * axes.get_ylim()[1])  # room for the legend above the curves
    axes.legend(loc="upper left", ncols=3)


def stress_label(run: Run) -> str:
    """Words for the axial stress of a scene."""
    words = {"punch": "punch stress", "brazilian": "2 P / (π D)"}
    return f"{words.get(run.test, 'axial stress')} [MPa]"
