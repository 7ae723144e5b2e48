"""Error against core seconds: a panel a problem and quantity, the front, how far the default is."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from lithofrac.analysis.front import (
    DEFAULT,
    FINEST,
    TARGET,
    distance,
    pareto_front,
    safe_errors,
)
from lithofrac.data import DataError
from lithofrac.data.csv_file import read_columns
from lithofrac.plots import style

COLUMNS = 3
PANEL_HEIGHT = 1.75  # inches
LEGEND_HEIGHT = 0.6  # inches
FLOOR = 1e-4  # [%], smaller errors are drawn there
MARGIN = 1.15  # about the values
SIZE = (style.BLUE, "o", "element size, strain step")
RATE = (style.ORANGE, "s", "loading rate")
KNOBS = {
    "element_size_mm": SIZE,
    "strain_step": SIZE,
    "speed_m_s": RATE,
    "ramp_transits": RATE,
    "hold_transits": (style.ORANGE, "<", "time at rest"),
    "time_step_factor": (style.GREEN, "^", "time step factor"),
    "damping_fraction": (style.PURPLE, "v", "damping ratio"),
    "contact_tolerance": (style.SKY, "D", "contact tolerance"),
    "insertion": (style.RED, "P", "insertion mode"),
    "release_steps": (style.GREY, "X", "release steps"),
}
NEEDED = ["problem", "quantity", "knob", "error_percent", "core_seconds", "elements", "steps"]


def figure(inputs: list[Path], data: Path) -> Figure:
    """Panels in the order of the table; the one input is `accuracy.csv`.

    Raises
    ------
    DataError
        When it is another table.
    """
    if len(inputs) != 1:
        raise DataError(f"plot accuracy: expected one accuracy.csv, got {len(inputs)} files")
    table = read_columns(inputs[0], NEEDED, "accuracy.csv", ("error_percent", "core_seconds"))
    table = table[table["knob"] != FINEST]
    groups = list(table.groupby(["problem", "quantity"], sort=False))
    rows = -(-len(groups) // COLUMNS)
    drawn, axes = style.new_figure(rows, COLUMNS, height=rows * PANEL_HEIGHT + LEGEND_HEIGHT)
    for panel, ((problem, quantity), own) in zip(axes.flat, groups, strict=False):
        draw_panel(panel, own)
        panel.set_title(f"{problem.replace('_', ' ')}\n{quantity}", fontsize=7.5)
    for panel in axes.flat[len(groups) :]:
        panel.set_axis_off()
    for row in axes:
        row[0].set_ylabel("error [%]")
    for column in range(min(COLUMNS, len(groups))):
        axes[(len(groups) - 1 - column) // COLUMNS, column].set_xlabel("core seconds [s]")
    labels = {}
    for panel in axes.flat:
        labels |= dict(zip(*panel.get_legend_handles_labels()[::-1], strict=True))
    drawn.legend(labels.values(), labels.keys(), loc="outside upper center", ncols=4)
    return drawn


def draw_panel(panel: Axes, own: pd.DataFrame) -> None:
    """All runs of one quantity of one problem; the front is that of errors not small by chance."""
    cost = own["core_seconds"].to_numpy(float)
    error = own["error_percent"].clip(lower=FLOOR).to_numpy(float)
    knob = own["knob"].to_numpy()
    for name, (colour, marker, words) in KNOBS.items():
        at = knob == name
        if at.any():
            panel.loglog(cost[at], error[at], marker, color=colour, ms=4.0, ls="", label=words)
    safe = safe_errors(own)
    on = pareto_front(cost, safe)
    front = safe[on].clip(min=FLOOR)
    panel.step(
        cost[on], front, where="post", color=style.BLACK, lw=0.9, zorder=1, label="Pareto front"
    )
    at = knob == DEFAULT
    far = distance(cost, safe, int(np.flatnonzero(at)[0]), TARGET)
    panel.annotate(
        f"distance {far:.1f}", (0.97, 0.95), xycoords="axes fraction", ha="right", va="top",
        fontsize=6.5,
    )  # fmt: skip
    panel.loglog(
        cost[at], error[at], "*", ls="", ms=11.0, mfc="none", mec=style.BLACK, label="default"
    )
    panel.axhline(TARGET, color=style.BLACK, lw=0.7, ls=":")
    for axis, values, limit in (
        (panel.xaxis, cost, panel.set_xlim),
        (panel.yaxis, np.append(error, TARGET), panel.set_ylim),
    ):
        limit(*limits(values))
        axis.set_minor_formatter(NullFormatter())


def limits(values: np.ndarray) -> tuple[float, float]:
    """Whole decades that hold the values (n,), some room beside them."""
    ends = np.log10([np.nanmin(values) / MARGIN, np.nanmax(values) * MARGIN])
    return float(10.0 ** np.floor(ends[0])), float(10.0 ** np.ceil(ends[1]))
