"""What any run measured, on one page: load, sideways strain, energy."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.runs import Run, only_run
from lithofrac.plots import style
from lithofrac.plots.energy import unit
from lithofrac.plots.events import stress_label

ENERGIES = (
    ("external_J", "external work", style.BLACK, "--"),
    ("elastic_J", "elastic", style.BLUE, "-"),
    ("compressive_dissipation_J", "compressive\ndissipation", style.RED, "-"),
    ("fracture_dissipation_J", "fracture", style.ORANGE, "-"),
    ("friction_J", "friction", style.PURPLE, "-"),
    ("damping_J", "damping", style.GREY, "-"),
    ("kinetic_J", "kinetic", style.GREEN, "-"),
)  # column, words, colour, dash; what takes energy is drawn as what it took
ROUNDING = 1e-9  # of the largest force
COLOURS = (style.BLACK, style.BLUE, style.RED, style.GREEN, style.ORANGE, style.PURPLE, style.SKY)


def figure(inputs: list[Path], data: Path) -> Figure:
    """Stress, lateral and volumetric strain, and energy against axial strain.

    A run without a measure of a specimen shows the forces of its loads and its energy over time.
    """
    run = only_run(inputs, "curves")
    axis = Axis(run)
    sideways = "lateral_strain" in axis.history
    rows = [2, 1.2, 1.6] if sideways else [2, 1.6]
    drawn, axes = style.new_figure(
        len(rows), 1, height=1.2 + sum(rows) * 0.9, sharex=True,
        gridspec_kw={"height_ratios": rows},
    )  # fmt: skip
    (draw_stress if axis.measured else draw_forces)(axes[0, 0], run, axis)
    if sideways:
        draw_sideways(axes[1, 0], axis)
    draw_energy(axes[-1, 0], run, axis)
    axes[0, 0].set_title(run.name)
    axes[-1, 0].set_xlabel(axis.label)
    for panel in axes[:, 0]:
        if panel.get_legend_handles_labels()[0]:
            panel.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return drawn


class Axis:
    """What the records of a run are drawn against: axial strain [%], else time [ms].

    Attributes
    ----------
    measured : whether the run has an axial measure
    history : table of the records, of the axial loading where it is measured
    x : (n,) position of each record
    label : words for the axis
    """

    def __init__(self, run: Run) -> None:
        whole = run.records
        self.measured = "axial_strain" in whole
        self.history = run.history if self.measured else whole
        self.x = self._of(self.history)
        self.label = "axial strain [%]" if self.measured else "time [ms]"

    def _of(self, table: pd.DataFrame) -> np.ndarray:
        if self.measured:
            return 100.0 * table["axial_strain"].to_numpy()
        return 1e3 * table["time_s"].to_numpy()

    def at(self, time_s: np.ndarray) -> np.ndarray:
        """Positions of moments [s]; NaN before the first record that is drawn."""
        return np.interp(time_s, self.history["time_s"], self.x, left=np.nan)


def draw_stress(axes: Axes, run: Run, axis: Axis) -> None:
    """Draw axial stress and its first peak."""
    axes.plot(axis.x, axis.history["axial_stress_MPa"], color=style.BLACK)
    if run.peak:
        axes.plot(
            100.0 * run.peak.strain, run.peak.stress, "o", ms=4, mfc="white", mec=style.BLACK,
            label=f"first peak:\n{run.peak.stress:.4g} MPa",
        )  # fmt: skip
    axes.set_ylabel(stress_label(run))


def draw_forces(axes: Axes, run: Run, axis: Axis) -> None:
    """Draw the force of each load that is more than rounding."""
    loads = [name.removesuffix("_displacement_mm") for name in axis.history
             if name.endswith("_displacement_mm")]  # fmt: skip
    size = {name: axis.history[f"{name}_force_N"].abs().max() for name in loads}
    used = [name for name in loads if size[name] > ROUNDING * max(size.values())]
    for name, colour in zip(used, COLOURS, strict=False):
        axes.plot(axis.x, axis.history[f"{name}_force_N"] / 1e3, color=colour, label=name)
    axes.set_ylabel(f"force\n[k{unit(run).replace('J', 'N', 1)}]")


def draw_sideways(axes: Axes, axis: Axis) -> None:
    """Draw lateral strain (extension positive) and volumetric strain (dilation positive)."""
    for name, words, colour in (
        ("lateral_strain", "lateral\n(extension)", style.BLUE),
        ("volumetric_strain", "volumetric\n(dilation)", style.RED),
    ):
        axes.plot(axis.x, 100.0 * axis.history[name], color=colour, label=words)
    axes.axhline(0.0, color=style.GREY, lw=0.6)
    axes.set_ylabel("strain [%]")


def draw_energy(axes: Axes, run: Run, axis: Axis) -> None:
    """Draw the entries of the ledger that are not zero throughout."""
    x = axis.at(run.energy["time_s"].to_numpy())
    for column, words, colour, dash in ENERGIES:
        if column not in run.energy or not (run.energy[column] != 0.0).any():
            continue
        sign = -1.0 if column in ("friction_J", "damping_J") else 1.0
        axes.plot(x, sign * run.energy[column], dash, color=colour, label=words)
    axes.set_ylabel(f"energy\n[{unit(run)}]")
