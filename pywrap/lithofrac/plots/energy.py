"""Where the energy of a run went."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.runs import Run, find_runs
from lithofrac.plots import style

PARTS = (
    ("elastic_J", "elastic", style.BLUE),
    ("compressive_dissipation_J", "compressive dissipation", style.RED),
    ("fracture_dissipation_J", "fracture", style.ORANGE),
    ("damping_J", "damping", style.GREY),
    ("kinetic_J", "kinetic", style.GREEN),
)


def figure(inputs: list[Path], data: Path) -> Figure:
    """Ledger of one run over its residual, against time."""
    run = find_runs(inputs)[0]
    drawn, axes = style.new_figure(
        2, 1, height=4.4, sharex=True, gridspec_kw={"height_ratios": [3, 1]}
    )
    draw_ledger(axes[0, 0], run)
    draw_residual(axes[1, 0], run)
    axes[0, 0].set_title(run.name)
    axes[1, 0].set_xlabel("time [ms]")
    return drawn


def draw_ledger(axes: Axes, run: Run) -> None:
    """Parts stacked, the external work as a line on top of them."""
    table = run.energy
    time = 1e3 * table["time_s"]
    axes.stackplot(
        time,
        [table[column].abs() for column, _, _ in PARTS],  # damping is booked as negative work
        labels=[label for _, label, _ in PARTS],
        colors=[colour for _, _, colour in PARTS],
        lw=0,
    )
    axes.plot(time, table["external_J"], "--", color=style.BLACK, label="external work")
    depth = "radian" if run.axisymmetric else "metre of depth"
    axes.set(ylabel=f"energy [J per {depth}]", ylim=(0, None))
    axes.legend(loc="upper left")


def draw_residual(axes: Axes, run: Run) -> None:
    """Size of the residual over the largest external work."""
    table = run.energy
    scale = table["external_J"].abs().max() or 1.0
    residual = np.maximum(table["residual_J"].abs() / scale, 1e-17)
    axes.semilogy(1e3 * table["time_s"], residual, color=style.BLACK)
    axes.axhline(1e-6, color=style.RED, ls=":", label="limit")
    axes.set(ylabel="|residual| /\nexternal work [-]", ylim=(1e-17, 1e-4))
    axes.legend(loc="lower right")
