"""The material point of one rock: stress, dilation, and what becomes of its strength."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.bench import Bench, find_bench
from lithofrac.plots import style

PANELS = (
    ("axial_stress_MPa", "axial stress [MPa]"),
    ("volumetric_percent", "volumetric strain [%]\n(dilation positive)"),
    ("tensile_strength_lateral_MPa", "lateral tensile\nstrength [MPa]"),
    ("cohesion_MPa", "cohesion [MPa]"),
    ("friction_angle_deg", "friction angle [°]"),
    ("dilation_angle_deg", "dilation angle [°]"),
)


def figure(inputs: list[Path], data: Path) -> Figure:
    """Six panels against axial strain, one curve a confinement; `inputs` are of one rock."""
    curves = find_bench(inputs)
    drawn, axes = style.new_figure(2, 3, height=4.9, sharex=True)
    colours = style.confinement_colours([curve.confinement_MPa for curve in curves])
    for panel, (column, label) in zip(axes.flat, PANELS, strict=True):
        for curve in curves:
            draw_column(panel, curve, column, colours[curve.confinement_MPa])
        panel.set_ylabel(label)
    for panel in axes[1]:
        panel.set_xlabel("axial strain [%]")
    for curve in curves:
        if curve.peak:
            axes[0, 0].plot(
                100 * curve.peak.strain, curve.peak.stress, "o", ms=3, color=style.BLACK, zorder=3
            )
    handles = [
        axes[0, 0].plot([], [], color=colour, label=f"{level:g}")[0]
        for level, colour in colours.items()
    ]
    peak = axes[0, 0].plot([], [], "o", ms=3, color=style.BLACK, label="peak")[0]
    drawn.legend(
        handles=[*handles, peak],
        loc="outside upper center",
        ncols=len(handles) + 1,
        title=f"{curves[0].rock.replace('_', ' ')}, {curves[0].test}; confinement [MPa]",
        columnspacing=1.2,
        handlelength=1.2,
    )
    return drawn


def draw_column(axes: Axes, curve: Bench, column: str, colour) -> None:
    """Draw one quantity of one curve against axial strain [%]."""
    table = curve.curve.assign(volumetric_percent=100.0 * curve.curve["volumetric_strain"])
    axes.plot(100.0 * table["axial_strain"], table[column], color=colour)
