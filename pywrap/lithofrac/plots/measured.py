"""Measured strengths: Table 1 beside TauTona quartzite, a fitted line beside Zigong sandstone."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.mohr_coulomb import peak_line, residual_strength
from lithofrac.analysis.tables import zigong_line
from lithofrac.config.material import Material
from lithofrac.data import measured_strength
from lithofrac.plots import style


def figure(inputs: list[Path], data: Path) -> Figure:
    """Two panels; `inputs` holds one file, the quartzite of Table 1."""
    drawn, axes = style.new_figure(1, 2, height=3.6)
    draw_tautona(axes[0, 0], Material.load(inputs[0]), data)
    draw_zigong(axes[0, 1], data)
    for panel in axes.flat:
        panel.set(xlabel="confinement [MPa]", ylabel="strength [MPa]", xlim=(0, None))
        panel.set_ylim(0, None)
    return drawn


def draw_tautona(axes: Axes, quartzite: Material, data: Path) -> None:
    """Line of a hardening table beside measured means and their ranges."""
    table = measured_strength(data, "tautona")
    mean = table["strength_MPa"]
    ends = [mean - table["strength_min_MPa"], table["strength_max_MPa"] - mean]
    confinement = np.linspace(0.0, 1.05 * table["confinement_MPa"].max(), 106)
    peak = peak_line(quartzite.table, 1e6 * confinement) / 1e6
    residual = [residual_strength(quartzite.table, 1e6 * p) / 1e6 for p in confinement]
    axes.plot(confinement, peak, color=style.BLUE, label="Table 1, peak (predicted)")
    axes.plot(confinement, residual, "--", color=style.BLUE, label="Table 1, residual")
    axes.errorbar(
        table["confinement_MPa"],
        mean,
        yerr=ends,
        fmt="s",
        color=style.BLACK,
        capsize=3,
        elinewidth=1.0,
        label="TauTona, mean and range",
    )
    for row in table.itertuples():
        axes.annotate(
            f"n = {row.tests:g}",
            (row.confinement_MPa, row.strength_min_MPa),
            xytext=(0, -5),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=7,
        )
    axes.set_title("quartzite: Table 1 and TauTona")
    axes.legend(loc="upper left")


def draw_zigong(axes: Axes, data: Path) -> None:
    """Fitted line with its confidence beside the measured means."""
    table, line = measured_strength(data, "zigong"), zigong_line(data)
    confinement = np.linspace(0.0, 1.05 * table["confinement_MPa"].max(), 106)
    fitted, half = line.at(confinement), line.half_width(confinement)
    axes.fill_between(
        confinement, fitted - half, fitted + half, color=style.ORANGE, alpha=0.3, lw=0,
        label=f"{100 * line.confidence:g} % confidence of the line",
    )  # fmt: skip
    axes.plot(confinement, fitted, color=style.ORANGE, label="fitted line")
    axes.plot(
        table["confinement_MPa"], table["strength_MPa"], "s", color=style.BLACK,
        label="Zigong, mean",
    )  # fmt: skip
    axes.set_title("sandstone: Zigong and its line")
    axes.text(
        0.97,
        0.05,
        f"σ₁ = q + N σ₃\nq = {line.q:.0f} ± {line.q_half:.0f} MPa\n"
        f"N = {line.n:.2f} ± {line.n_half:.2f}\n"
        f"c = {line.cohesion:.1f} MPa, φ = {line.friction_deg:.1f}°\n"
        f"error of a point left out: {100 * line.left_out_rms:.1f} %",
        transform=axes.transAxes,
        ha="right",
        va="bottom",
        fontsize=8,
    )
    axes.legend(loc="upper left")
