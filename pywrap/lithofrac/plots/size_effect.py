"""Initiation stress against hole radius, beside theory (Klerck 2004, Fig. 16)."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.hole import CRITERIA, ZONES
from lithofrac.analysis.hole_tables import hole_initiation, predicted, rock_of, size_effect_of
from lithofrac.analysis.size_law import fit_size_law
from lithofrac.analysis.tables import NOT_DIGITISED
from lithofrac.config.material import Material
from lithofrac.data import load_curves
from lithofrac.data.axes import load_axes
from lithofrac.data.digitised import AXES
from lithofrac.plots import style

PANELS = {"primary": "16a", "remote": "16b", "sidewall": "16c"}  # zone -> figure
LOOK = {
    "curvature": ("o", style.BLUE, -0.25),
    "exhaustion": ("s", style.ORANGE, 0.0),
    "crack": ("^", style.RED, 0.25),
}  # criterion -> marker, colour, shift along the radius so that ranges do not overlap [mm]
OTHERS = {"mesh1mm": ("P", "wall elements of 1 mm"), "block150": ("D", "blocks of 150 mm")}
THEORY = (
    ("kirsch", ":", {"primary": "Kirsch: hoop stress is ft", "sidewall": "Kirsch: first yield"}),
    ("average", "-.", {"primary": "average stress"}),
    ("coupled", (0, (6, 1.5)), {"primary": "finite fracture mechanics"}),
    ("cohesive", "-", {"primary": "cohesive crack, mouth open"}),
)  # field of `Theory`, dash, words by zone
SERIES = ("v", "x", "+", "1", "2")  # markers of digitised series


def figure(inputs: list[Path], data: Path) -> Figure:
    """Fig. 16 a to c, on the printed axes or, where values lie beyond them, a frame of these."""
    initiation, rock = hole_initiation(inputs, data), rock_of(inputs)
    table = size_effect_of(initiation, rock)
    similar = initiation[initiation["series"] == "similar"]
    largest = similar.groupby("radius_mm")["largest_stress_MPa"].mean()
    drawn, axes = style.new_figure(2, 2, height=6.6)
    for panel, (zone, number) in zip(axes.flat, PANELS.items(), strict=False):
        own = table[table["zone"] == zone]
        printed = load_axes(data / AXES)[number]
        panel.set_xlim(0.0, printed["x"].printed_max)
        panel.plot(largest, color=style.LIGHT, lw=4.0, zorder=1)
        draw_runs(panel, own)
        draw_theory(panel, zone, rock, printed["x"].printed_max)
        curves = load_curves(data, number)
        for marker, curve in zip(SERIES, curves, strict=False):
            panel.errorbar(
                curve.x, curve.y, xerr=curve.x_error, yerr=curve.y_error, fmt=marker, ms=4,
                color=style.BLACK, label=f"{curve.sheet.origin}: {curve.sheet.series}",
            )  # fmt: skip
        _set_top(panel, own, printed["y"].printed_max)
        panel.set(xlabel="hole radius [mm]", ylabel="axial stress [MPa]")
        panel.set_title(f"({number[-1]}) {zone}")
        if not any(curve.sheet.origin == "experiment" for curve in curves):
            style.badge(panel, NOT_DIGITISED, "upper right")
    _legend(axes[1, 1], axes.flat, table)
    return drawn


def draw_runs(axes: Axes, table: pd.DataFrame) -> None:
    """Means and ranges by criterion, their size law, and the other series as hollow marks."""
    for criterion, (mark, colour, shift) in LOOK.items():
        own = table[table["criterion"] == criterion].dropna(subset="mean_MPa")
        similar = own[own["series"] == "similar"]
        if not similar.empty:
            mean = similar["mean_MPa"]
            axes.errorbar(
                similar["radius_mm"] + shift, mean,
                yerr=[mean - similar["min_MPa"], similar["max_MPa"] - mean],
                fmt=mark, color=colour, ms=4.5, elinewidth=1.0, capsize=2.5, zorder=4,
            )  # fmt: skip
            whole = similar[similar["found"] == similar["runs"]]
            law = fit_size_law(whole["radius_mm"], whole["mean_MPa"])
            if law is not None:
                radius = np.linspace(whole["radius_mm"].min(), axes.get_xlim()[1], 200)
                axes.plot(radius, law.at(radius), "--", color=colour, lw=0.9, zorder=3)
        for series, (other, _) in OTHERS.items():
            rest = own[own["series"] == series]
            axes.plot(
                rest["radius_mm"] + shift, rest["mean_MPa"], other, ms=6, mfc="none", mec=colour,
                zorder=5,
            )  # fmt: skip


def draw_theory(axes: Axes, zone: str, rock: Material | None, end: float) -> None:
    """Lines of the theories that say something of a zone."""
    if rock is None:
        return
    radius = np.geomspace(0.5, end, 60)
    said = [predicted(zone, rock, value) for value in radius]
    for field, dash, words in THEORY:
        if zone in words:
            axes.plot(radius, [getattr(one, field) for one in said], ls=dash, color=style.BLACK,
                      lw=1.1, zorder=2)  # fmt: skip


def _set_top(axes: Axes, table: pd.DataFrame, printed: float) -> None:
    """The printed top, or above what was found where that is higher; then a line says so."""
    top = max(printed, 1.08 * float(table["max_MPa"].max(skipna=True) or 0.0))
    top = printed if np.isnan(top) else top
    axes.set_ylim(0.0, top if top == printed else 1.25 * top)
    if top > printed:
        axes.axhline(printed, color=style.GREY, ls=(0, (6, 3)), lw=0.8)
        axes.annotate(
            f"printed axis ends at {printed:g} MPa", (axes.get_xlim()[1], printed),
            xytext=(-3, 3), textcoords="offset points", ha="right", fontsize=7, color=style.GREY,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5}, zorder=6,
        )  # fmt: skip


def _legend(axes: Axes, panels, table: pd.DataFrame) -> None:
    """All entries in the empty fourth panel."""
    axes.axis("off")
    for criterion in CRITERIA:
        mark, colour, _ = LOOK[criterion]
        axes.errorbar([], [], yerr=[], fmt=mark, color=colour, capsize=2.5,
                      label=f"{criterion}: mean and range")  # fmt: skip
    axes.plot([], [], "--", color=style.GREY, lw=0.9, label="size law fitted to the means")
    for series, (mark, words) in OTHERS.items():
        if (table["series"] == series).any():
            axes.plot([], [], mark, mfc="none", mec=style.GREY, label=words)
    axes.plot([], [], color=style.LIGHT, lw=4.0, label="largest stress that the block bears")
    for _, dash, words in THEORY:
        axes.plot([], [], ls=dash, color=style.BLACK, lw=1.1, label="; ".join(words.values()))
    handles, labels = axes.get_legend_handles_labels()
    for panel in list(panels)[: len(ZONES)]:
        more = panel.get_legend_handles_labels()
        handles, labels = handles + more[0], labels + more[1]
    axes.legend(handles, labels, loc="center", fontsize=8)
