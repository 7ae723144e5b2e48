"""Fonts, colours, sizes: the one place that sets how figures look.

Colours are those of Okabe & Ito and matplotlib's `viridis`: told apart by eyes of any colour vision
and, by lightness and marker, in grey.
"""

import matplotlib

matplotlib.use("Agg")  # before pyplot: no display is needed

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap
from matplotlib.figure import Figure

WIDTH = 7.2  # inches, a page's text width
BLACK, GREY, LIGHT = "#000000", "#6b6b6b", "#d9d9d9"
BLUE, ORANGE, GREEN, RED = "#0072b2", "#e69f00", "#009e73", "#d55e00"
PURPLE, SKY = "#cc79a7", "#56b4e9"
LIGHT_END = 0.82  # of `viridis`, still visible on white

SETTINGS = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 9.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.4,
    "lines.markersize": 5.0,
    "savefig.dpi": 150,
    "figure.dpi": 150,
    "svg.hashsalt": "lithofrac",  # same figure, same file
}


def new_figure(
    rows: int = 1, columns: int = 1, height: float = 3.2, width: float = WIDTH, **kwargs
) -> tuple:
    """Figure and its axes (always a 2-D array); sizes in inches."""
    plt.rcParams.update(SETTINGS)
    return plt.subplots(
        rows, columns, figsize=(width, height), squeeze=False, layout="constrained", **kwargs
    )


def dark_to_light() -> Colormap:
    """`viridis` without its light end, which would be lost on white."""
    return ListedColormap(plt.get_cmap("viridis")(np.linspace(0.0, LIGHT_END, 256)))


def confinement_colours(confinements: list[float]) -> dict[float, tuple]:
    """Dark to light with rising confinement; the light end stays visible on white."""
    levels = sorted(set(confinements))
    shades = plt.get_cmap("viridis")(np.linspace(0.0, LIGHT_END, max(len(levels), 1)))
    return {level: tuple(shade) for level, shade in zip(levels, shades, strict=False)}


def flat(colour: str) -> ListedColormap:
    """A colour map of one colour."""
    return ListedColormap([colour])


def badge(axes: Axes, text: str, corner: str = "lower right") -> None:
    """A note inside the axes, or "above" them, that cannot be overlooked."""
    vertical, horizontal = corner.split()
    axes.text(
        {"left": 0.03, "right": 0.97}[horizontal],
        {"lower": 0.04, "center": 0.5, "upper": 0.96, "above": 1.03}[vertical],
        text,
        transform=axes.transAxes,
        ha=horizontal,
        va={"lower": "bottom", "center": "center", "upper": "top", "above": "bottom"}[vertical],
        fontsize=8.0,
        color=BLACK,
        zorder=10,
        bbox={"boxstyle": "round,pad=0.35", "facecolor": "#fff3d6", "edgecolor": ORANGE},
    )


def save(figure: Figure, out: Path) -> None:
    """Write the figure, whole or not at all; the suffix says the format."""
    out.parent.mkdir(parents=True, exist_ok=True)
    part = out.with_name(f".{out.name}.part")
    kind = out.suffix.removeprefix(".")
    metadata = {"Date": None} if kind == "svg" else {}
    figure.savefig(part, format=kind, metadata=metadata)
    part.replace(out)
    plt.close(figure)
