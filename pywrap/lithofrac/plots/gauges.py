"""Gauges of any run: principal stress and strain, damage and strength left, at its probes."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.runs import only_run
from lithofrac.data import DataError
from lithofrac.plots import style
from lithofrac.plots.curves import COLOURS, Axis

SHOWN = len(COLOURS)  # gauges in one figure, the first of the run
STRENGTHS = [f"tensile_strength_{i}_MPa" for i in (1, 2, 3)]


def figure(inputs: list[Path], data: Path) -> Figure:
    """A panel a quantity, a colour a gauge; against axial strain, else time.

    Of two principal values in the plane the larger is drawn through, the smaller in dashes,
    tension positive. Damage and strength are left out where nothing can break.
    """
    run = only_run(inputs, "gauges")
    if not (run.folder / "probes.parquet").is_file():
        raise DataError(f"{run.folder}: holds no probes.parquet, expected a run with probes")
    table, axis = run.probes, Axis(run)
    names = list(table["probe"].unique())
    panels = [draw_stress, draw_strain]
    panels += [] if run.case["material"].get("elastic") else [draw_plastic, draw_strength]
    drawn, axes = style.new_figure(
        len(panels) // 2, 2, height=0.9 + 1.9 * (len(panels) // 2), sharex=True
    )
    for name, colour in zip(names, COLOURS, strict=False):
        own = table[table["probe"] == name]
        x = axis.at(own["time_s"].to_numpy())
        for panel, draw in zip(axes.flat, panels, strict=True):
            draw(panel, x, own, colour)
        axes[0, 0].plot([], [], color=colour, label=name)
    for panel in axes[-1]:
        panel.set_xlabel(axis.label)
    count = f"{min(len(names), SHOWN)} of {len(names)} gauges" if len(names) > SHOWN else "gauges"
    drawn.legend(
        *axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4,
        title=f"{run.name}, {count}; of principal values in the plane the smaller in dashes",
    )  # fmt: skip
    return drawn


def principal(xx: np.ndarray, yy: np.ndarray, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Larger and smaller principal value in the plane of a tensor with shear component `xy`."""
    middle, radius = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    return middle + radius, middle - radius


def draw_stress(axes: Axes, x: np.ndarray, own: pd.DataFrame, colour: str) -> None:
    """Draw the principal stresses in the plane."""
    parts = (own[f"stress_{part}_MPa"].to_numpy() for part in ("xx", "yy", "xy"))
    _draw_two(axes, x, principal(*parts), colour)
    axes.set_ylabel("principal stress [MPa]")


def draw_strain(axes: Axes, x: np.ndarray, own: pd.DataFrame, colour: str) -> None:
    """Draw the principal strains in the plane; the shear of the table is the engineering one."""
    xx, yy, shear = (own[f"strain_{part}"].to_numpy() for part in ("xx", "yy", "xy"))
    _draw_two(axes, x, [100.0 * part for part in principal(xx, yy, 0.5 * shear)], colour)
    axes.set_ylabel("principal strain [%]")


def draw_plastic(axes: Axes, x: np.ndarray, own: pd.DataFrame, colour: str) -> None:
    """Draw the effective plastic strain."""
    axes.plot(x, 100.0 * own["plastic_strain"], color=colour)
    axes.set_ylabel("effective plastic strain [%]")


def draw_strength(axes: Axes, x: np.ndarray, own: pd.DataFrame, colour: str) -> None:
    """Draw the least of the three tensile strengths."""
    axes.plot(x, own[STRENGTHS].min(axis=1), color=colour)
    axes.set_ylabel("least tensile strength [MPa]")
    axes.set_ylim(0.0, None)


def _draw_two(axes: Axes, x: np.ndarray, values, colour: str) -> None:
    for value, dash in zip(values, ("-", "--"), strict=True):
        axes.plot(x, value, dash, color=colour, lw=1.1)
