"""Where runs break: energy against the time step, and the margin of every cell of the matrix."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.data import DataError
from lithofrac.data.csv_file import read_columns
from lithofrac.plots import style

STYLES = {
    "one element": (style.GREY, "D", "-", "one free element"),
    "continuum": (style.BLUE, "o", "-", "continuum"),
    "contact": (style.ORANGE, "s", "--", "contact"),
    "cracked": (style.RED, "^", "-", "cracked (a: every edge cut)"),
}
OFFSETS = {"continuum": -0.22, "contact": 0.0, "cracked": 0.22}  # rows of the margins
CEILING = 1e6  # of the energy that is drawn
TICKS = (1, 1.5, 2, 3, 5, 10, 20, 30)
TABLES = "stability_limit.csv and stability.csv"
CURVES = ("time_step_factor", "mesh", "broke", "internal_over_put_in")
MARGINS = ("margin", "mesh", "family")
DEFAULT = 0.9  # time step factor of a case


def figure(inputs: list[Path], data: Path) -> Figure:
    """Largest internal energy over the time step factor, and margins by family.

    Inputs are `stability_limit.csv` and `stability.csv`, in any order.
    """
    tables = [
        read_columns(path, (), TABLES, keep_default_na=False, na_values=[""]) for path in inputs
    ]
    curves = [table for table in tables if set(CURVES) <= set(table)]
    matrix = [table for table in tables if set(MARGINS) <= set(table)]
    if len(curves) != 1 or len(matrix) != 1:
        raise DataError(f"plot stability: expected {TABLES}")
    drawn, axes = style.new_figure(1, 2, height=4.6, width_ratios=[1.0, 1.0])
    _draw_curves(axes[0, 0], curves[0])
    _draw_margins(axes[0, 1], matrix[0])
    drawn.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return drawn


def _draw_curves(panel: Axes, table: pd.DataFrame) -> None:
    """Energy of each mesh; runs that broke stand on the upper edge."""
    for mesh, (colour, marker, line, words) in STYLES.items():
        own = table[table["mesh"] == mesh].sort_values("time_step_factor")
        broke = own["broke"].astype(str) == "True"
        energy = own["internal_over_put_in"].where(~broke, CEILING).clip(upper=CEILING)
        panel.semilogy(
            own["time_step_factor"], energy, line, color=colour, marker=marker, ms=3.5, label=words
        )
    factor = np.linspace(0.05, 0.999, 400)
    panel.semilogy(factor, 1.0 / (1.0 - factor**2), ":", color=style.BLACK, lw=1.0)
    panel.annotate(
        "bound of theory\n1/(1 - f²)", (0.85, 1.0 / (1.0 - 0.85**2)), (0.3, 60.0),
        fontsize=8.0, arrowprops={"arrowstyle": "-", "color": style.GREY, "lw": 0.8},
    )  # fmt: skip
    _mark_limits(panel.axvline)
    panel.set(
        xlabel="time step over the limit of an element [-]",
        ylabel="largest internal energy over that put in [-]",
        ylim=(0.1, 2.0 * CEILING),
        title="a  Energy (top: blew up)",
    )


def _draw_margins(panel: Axes, table: pd.DataFrame) -> None:
    """One mark for each stable cell with a margin, by family."""
    table = table[table["margin"].notna()]
    families = list(dict.fromkeys(table["family"]))
    for mesh, offset in OFFSETS.items():
        own = table[table["mesh"] == mesh]
        rows = [families.index(family) + offset for family in own["family"]]
        colour, marker, *_ = STYLES[mesh]
        panel.semilogx(own["margin"], rows, marker, color=colour, ms=3.5, alpha=0.8)
    _mark_limits(panel.axvline)
    panel.set_yticks(range(len(families)), families)
    panel.set_ylim(len(families) - 0.4, -0.6)
    panel.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
    panel.minorticks_off()
    panel.set(
        xlabel="time step factor at which it breaks [-]",
        title="b  Margin of every cell",
    )
    panel.grid(axis="y", visible=False)


def _mark_limits(line) -> None:
    line(1.0, color=style.BLACK, lw=0.9)
    line(DEFAULT, color=style.BLACK, lw=0.9, ls="--")
