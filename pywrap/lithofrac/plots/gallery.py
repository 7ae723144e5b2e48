"""The picture at the top of the README: where specimens failed, beside their curves."""

from pathlib import Path

import meshio
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from lithofrac.analysis.runs import Run, find_runs
from lithofrac.plots import style
from lithofrac.plots.sandstone import TITLES, draw_curve


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
    curves.set_title(f"sandstone, {TITLES.get(runs[0].test, runs[0].test)}")
    curves.set_ylim(0, None)
    curves.legend(loc="upper left", title="confinement", handlelength=1.2)
    fields = [last_frame(run) for run in runs]
    top = max(float(np.quantile(field.cell_data["plastic_strain"][0], 0.99)) for field in fields)
    for panel, run, field in zip(specimens, runs, fields, strict=True):
        drawn_field = draw_plastic_strain(panel, field, max(top, 1e-6))
        panel.set_title(f"{run.confinement_MPa:g} MPa", loc="center", fontweight="normal")
    bar = drawn.colorbar(
        drawn_field, ax=specimens, orientation="horizontal", shrink=0.8, pad=0.04, aspect=30
    )
    bar.set_label("effective plastic strain at the end [-]")
    return drawn


def last_frame(run: Run) -> meshio.Mesh:
    """Fields at the end of a run."""
    return meshio.read(sorted((run.folder / "fields").glob("frame_*.vtu"))[-1])


def draw_plastic_strain(axes: Axes, field: meshio.Mesh, top: float) -> PolyCollection:
    """Draw plastic strain from 0 to `top` on the deformed mesh."""
    moved = 1e3 * (field.points + field.point_data["displacement_m"])
    drawn = axes.tripcolor(
        moved[:, 0], moved[:, 1], np.ravel(field.cell_data["plastic_strain"][0]),
        triangles=field.cells[0].data, cmap="magma_r", vmin=0.0, vmax=top, rasterized=True,
    )  # fmt: skip
    axes.set_aspect("equal")
    axes.set_axis_off()
    return drawn
