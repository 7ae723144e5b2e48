"""A rock fitted to triaxial tests: strengths, curves, and its table with confidence intervals."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.mohr_coulomb import peak_line
from lithofrac.analysis.rock_fit import CONFIDENCE, RockFit
from lithofrac.plots import style

MPA = 1e6
MARKERS = {
    "fitted": {"marker": "s", "mfc": style.BLACK},
    "predicted": {"marker": "o", "mfc": "none"},
}
COLUMNS = (
    ("cohesion_MPa", "cohesion [MPa]"),
    ("friction_angle_deg", "friction angle [°]"),
    ("dilation_angle_deg", "dilation angle [°]"),
)


def rock_fit(fit: RockFit) -> Figure:
    """Strengths and their differences; with curves also these and the table."""
    if fit.points.empty:
        drawn, axes = style.new_figure(1, 2, height=3.2)
        draw_strengths(axes[0, 0], fit)
        draw_differences(axes[0, 1], fit)
        return drawn
    drawn, axes = style.new_figure(2, 3, height=5.2)
    colours = style.confinement_colours(list(fit.points["confinement_MPa"]))
    draw_curves(axes[0, 0], fit, "axial_stress_MPa", colours)
    axes[0, 0].set_ylabel("axial stress [MPa]")
    if (fit.points["quantity"] == "lateral_strain").any():
        draw_curves(axes[0, 1], fit, "lateral_strain", colours)
        axes[0, 1].set_ylabel("lateral strain [%]")
    else:
        draw_differences(axes[0, 1], fit)
    draw_strengths(axes[0, 2], fit)
    for panel, (key, label) in zip(axes[1], COLUMNS, strict=True):
        draw_column(panel, fit, key)
        panel.set_ylabel(label)
    handles = [axes[0, 0].plot([], [], color=colour, label=f"{level:g}")[0]
               for level, colour in colours.items()]  # fmt: skip
    handles.append(axes[0, 0].plot([], [], "o", ms=2.5, color=style.GREY, label="measured")[0])
    drawn.legend(
        handles=handles,
        loc="outside upper center",
        ncols=len(handles),
        title=f"confinement [MPa]; bars of the table: {100 * CONFIDENCE:g} % confidence",
        columnspacing=1.2,
        handlelength=1.2,
    )
    return drawn


def draw_strengths(axes: Axes, fit: RockFit) -> None:
    """Strength of the fitted rock against confinement beside the measured ones."""
    table = fit.strengths
    confinement = np.linspace(0.0, 1.05 * max(table["confinement_MPa"].max(), 1.0), 106)
    line = peak_line(fit.rock.table, MPA * confinement) / MPA
    axes.plot(confinement, line, color=style.ORANGE, label="fitted rock")
    for role, rows in table.groupby("role"):
        axes.plot(
            rows["confinement_MPa"], rows["strength_MPa"], ls="none", mec=style.BLACK,
            clip_on=False, label=f"measured, {role}", **MARKERS[role],
        )  # fmt: skip
    axes.set(xlabel="confinement [MPa]", ylabel="strength [MPa]", xlim=(0, None))
    axes.set_ylim(0, 1.3 * table["strength_MPa"].max())  # room for the legend
    axes.legend(loc="upper left")


def draw_differences(axes: Axes, fit: RockFit) -> None:
    """How far the strength of the fitted rock lies above the measured one."""
    axes.axhline(0.0, color=style.GREY, lw=1.0)
    for role, rows in fit.strengths.groupby("role"):
        rms, _, _ = fit.error_percent(role)
        axes.plot(
            rows["confinement_MPa"], rows["difference_percent"], ls="none", mec=style.BLACK,
            clip_on=False, label=f"{role}: rms {rms:.1f} %", **MARKERS[role],
        )  # fmt: skip
    reach = 1.5 * max(fit.strengths["difference_percent"].abs().max(), 0.1)
    axes.set(xlabel="confinement [MPa]", ylabel="fitted less measured\nstrength [%]")
    axes.set_xlim(0, 1.05 * max(fit.strengths["confinement_MPa"].max(), 1.0))
    axes.set_ylim(-reach, reach)
    axes.legend(loc="upper center", ncols=2)


def draw_curves(axes: Axes, fit: RockFit, quantity: str, colours: dict[float, tuple]) -> None:
    """Measured points and fitted lines of one quantity against axial strain [%]."""
    factor = 100.0 if quantity == "lateral_strain" else 1.0
    points = fit.points[fit.points["quantity"] == quantity]
    for _, rows in points.groupby("test"):
        colour = colours[rows["confinement_MPa"].iloc[0]]
        strain = 100.0 * rows["axial_strain"]
        shown = slice(None, None, max(1, len(rows) // 20))
        axes.plot(strain, factor * rows["computed"], color=colour)
        axes.plot(strain[shown], factor * rows["measured"][shown], "o", ms=2.5, color=colour)
    axes.set_xlabel("axial strain [%]")


def draw_column(axes: Axes, fit: RockFit, key: str) -> None:
    """One column of the table with its intervals, drawn no further than the bounds."""
    strain, values = np.array(fit.rock.plastic_strain), np.array(getattr(fit.rock, key))
    axes.plot(100.0 * strain, values, "-", color=style.BLUE)
    own = fit.parameters[fit.parameters["quantity"] == key]
    if own.empty:
        style.badge(axes, "given, not fitted")
    else:
        half = own["plus_minus"].fillna(0.0)
        ends = [
            np.minimum(half, own["value"] - own["lower_bound"]),
            np.minimum(half, own["upper_bound"] - own["value"]),
        ]
        axes.errorbar(
            100.0 * own["plastic_strain"], own["value"], yerr=ends, fmt="o", ms=3.5,
            color=style.BLUE, capsize=2.5, elinewidth=1.0,
        )  # fmt: skip
    axes.set(xlabel="plastic strain [%]", ylim=(0, None))
