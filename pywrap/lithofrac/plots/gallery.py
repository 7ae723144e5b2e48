"""The picture at the top of the README: where specimens failed, beside their curves."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from lithofrac.analysis.frames import Frame
from lithofrac.analysis.runs import find_runs
from lithofrac.plots import style
from lithofrac.plots.sandstone import TITLES, draw_curve, kind


def figure(inputs: list[Path], data: Path) -> Figure:
    """Axial stress against strain on the left, plastic strain at the end on the right."""
    runs = find_runs(inputs)
    widths = [1.2 * max(len(runs), 3)] + len(runs) * [1]
    drawn, axes = style.new_figure(
        1, 1 + len(runs), height=3.6, gridspec_kw={"width_ratios": widths}
    )
    colours = style.confinement_colours([run.confinement_MPa for run in runs])
    curves, *specimens = axes[0]
    for run in runs:
        draw_curve(curves, run, colours[run.confinement_MPa])
        curves.plot(
            [], [], color=colours[run.confinement_MPa], label=f"{run.confinement_MPa:g} MPa"
        )
    curves.set(xlabel="axial strain [%]", ylabel="axial stress [MPa]", xlim=(0, None))
    curves.set_title(f"sandstone, {TITLES[kind(runs[0])]}")
    curves.set_ylim(0, None)
    curves.legend(loc="upper left", title="confinement", handlelength=1.2)
    rocks = [run.last_frame.part(run.is_rock(run.last_frame)) for run in runs]
    top = max(float(np.quantile(rock.plastic_strain, 0.99)) for rock in rocks)
    for panel, run, rock in zip(specimens, runs, rocks, strict=True):
        drawn_field = draw_plastic_strain(panel, rock, max(top, 1e-6))
        panel.set_title(f"{run.confinement_MPa:g} MPa", loc="center", fontweight="normal")
    bar = drawn.colorbar(
        drawn_field, ax=specimens, orientation="horizontal", shrink=0.8, pad=0.04, aspect=30
    )
    bar.set_label("effective plastic strain at the end [-]")
    return drawn


def draw_plastic_strain(axes: Axes, frame: Frame, top: float) -> PolyCollection:
    """Draw plastic strain from 0 to `top` on the deformed mesh, with its outline and cracks."""
    moved = frame.moved()
    drawn = axes.tripcolor(
        *moved.T, frame.plastic_strain, triangles=frame.triangles, cmap="magma_r",
        vmin=0.0, vmax=top, rasterized=True,
    )  # fmt: skip
    lines = moved[frame.boundary()]
    axes.add_collection(LineCollection(lines, colors=style.GREY, linewidths=0.4))
    axes.set_aspect("equal")
    axes.set_axis_off()
    return drawn
