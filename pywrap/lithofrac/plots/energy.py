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
    ("friction_J", "friction", style.PURPLE),
    ("insertion_J", "crack insertion", style.SKY),
    ("contact_J", "contact pressure", style.BLACK),
    ("relump_J", "mass lumping", style.LIGHT),
    ("damping_J", "damping", style.GREY),
    ("kinetic_J", "kinetic", style.GREEN),
)
WORK = ("friction_J", "insertion_J", "contact_J", "relump_J", "damping_J")  # negative: takes energy
SMALL = (
    ("kinetic_J", "kinetic", style.GREEN, "-"),
    ("friction_J", "friction", style.PURPLE, "-"),
    ("insertion_J", "crack insertion", style.SKY, "-"),
    ("contact_J", "contact pressure", style.BLACK, "-"),
    ("relump_J", "mass lumping", style.RED, "--"),
    ("turning_J", "turns of a step", style.BLUE, ":"),
    ("reset_J", "state reset,\nno part of the sum", style.ORANGE, ":"),
)
DECADES = 1e-9  # of the largest energy: what lies below is not shown


def figure(inputs: list[Path], data: Path) -> Figure:
    """Ledger of one run over its residual, against time; with contact, the small entries between.

    What takes energy is stacked; the small entries are sizes, of either sign.
    """
    run = find_runs(inputs)[0]
    small = [entry for entry in SMALL[1:] if _used(run, entry[0])]
    rows = [3, 2, 1.3] if small else [3, 1.3]
    drawn, axes = style.new_figure(
        len(rows), 1, height=1.4 + sum(rows) * 0.75, sharex=True,
        gridspec_kw={"height_ratios": rows},
    )  # fmt: skip
    draw_ledger(axes[0, 0], run)
    if small:
        draw_small(axes[1, 0], run)
    draw_residual(axes[-1, 0], run)
    axes[0, 0].set_title(run.name)
    axes[-1, 0].set_xlabel("time [ms]")
    return drawn


def draw_ledger(axes: Axes, run: Run) -> None:
    """Parts stacked, the external work as a line on top of them."""
    table = run.energy
    time = 1e3 * table["time_s"]
    parts = [part for part in PARTS if part in PARTS[:3] or _used(run, part[0])]
    axes.stackplot(
        time,
        [(-table[name] if name in WORK else table[name]).clip(lower=0.0) for name, _, _ in parts],
        labels=[label for _, label, _ in parts],
        colors=[colour for _, _, colour in parts],
        lw=0,
    )
    axes.plot(time, table["external_J"], "--", color=style.BLACK, label="external work")
    axes.set(ylabel=f"energy [{unit(run)}]", ylim=(0, None))
    _legend(axes)


def draw_small(axes: Axes, run: Run) -> None:
    """Sizes of the entries that a stack hides, on a logarithmic axis."""
    table = run.energy
    floor = DECADES * _scale(run)
    for column, label, colour, dash in SMALL:
        if _used(run, column) and table[column].abs().max() > floor:
            size = table[column].abs()
            axes.semilogy(
                1e3 * table["time_s"], size.where(size > floor), dash, color=colour, label=label
            )
    axes.set(ylabel=f"small entries\n[{unit(run)}]", ylim=(floor, None))
    _legend(axes)


def draw_residual(axes: Axes, run: Run) -> None:
    """Size of the residual over the largest energy of the run: internal, external or kinetic."""
    residual = np.maximum(run.energy["residual_J"].abs() / _scale(run), 1e-17)
    axes.semilogy(1e3 * run.energy["time_s"], residual, color=style.BLACK)
    axes.axhline(1e-6, color=style.RED, ls=":", label="limit")
    axes.set(ylabel="|residual| /\nlargest energy [-]", ylim=(1e-17, 1e-4))
    _legend(axes)


def _legend(axes: Axes) -> None:
    """Names beside the panel, where they cover nothing."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _used(run: Run, column: str) -> bool:
    """Whether a run has an entry and has booked anything in it."""
    return column in run.energy and bool((run.energy[column] != 0.0).any())


def _scale(run: Run) -> float:
    """Largest energy of the run [J]."""
    table = run.energy
    internal = table[["elastic_J", "compressive_dissipation_J", "fracture_dissipation_J"]].sum(
        axis=1
    )
    parts = internal, table["external_J"], table["kinetic_J"]
    return max(part.abs().max() for part in parts) or 1.0


def unit(run: Run) -> str:
    """Unit of the energies of a run."""
    return f"J per {'radian' if run.axisymmetric else 'metre of depth'}"
