"""Fracture pattern on the deformed mesh, by mode and by time (Klerck 2004, Figs 7 and 11)."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from lithofrac.analysis.crack_faces import Faces, find_faces
from lithofrac.analysis.frames import Frame
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.plots import style

ROCK, OTHER = "#f2ead9", "#c9ccd0"
MODES = {
    "tensile": ("tensile", style.BLUE),
    "compressive_dilation": ("compressive dilation", style.ORANGE),
}  # value in cracks.parquet -> words, colour
VISIBLE, LARGEST = 0.005, 0.02  # displacement over extent: magnified below the one, up to the other
ROUND = np.array([1, 2, 5, 10, 20, 50, 100, 200, 500, 1000])
BESIDE, ABOVE = 1.2, 1.7  # inches for labels and the bar, for labels and the legend
TWO_LINES = 0.3  # inches for titles of two lines
TALLEST, NARROWEST = 5.0, 5.2  # inches, of a panel and of the figure
CLOSER = 0.4  # extent of the cracks over that of the bodies, below which they are shown alone
METRES = 1e4  # mm: bodies of a larger extent are drawn in metres
AROUND = 0.06  # of the extent, shown beside the bodies; what flies further is cut off


def figure(inputs: list[Path], data: Path) -> Figure:
    """Pattern of one run at its end: by mode on the left, by time of insertion on the right.

    A run without cracks shows its bodies alone.
    """
    run = find_runs(inputs)[0]
    frame = run.last_frame
    if run.cracks.empty:
        return _without_cracks(run, frame)
    faces = find_faces(frame, run.cracks)
    times = 1e3 * run.cracks["time_s"].to_numpy()[faces.crack]
    factor = magnification(frame)
    drawn, axes = style.new_figure(1, 2, **_size(frame, 2), sharey=True)
    by_mode, by_time = axes[0]
    draw_bodies(by_mode, run, frame, faces, factor)
    draw_modes(by_mode, run, frame, faces, factor)
    draw_bodies(by_time, run, frame, faces, factor)
    lines = draw_times(by_time, frame, faces, times, factor)
    by_mode.set_title("crack edges by mode")
    by_time.set_title("by time of insertion")
    for panel in axes[0]:
        _look_closer(panel, frame, faces)
        _name_axes(panel, frame)
    by_time.set_ylabel("")
    bar = drawn.colorbar(lines, ax=list(axes[0]), shrink=0.8, aspect=30)
    bar.set_label("time of insertion [ms]")
    drawn.legend(
        *by_mode.get_legend_handles_labels(),
        loc="outside upper center",
        ncols=2,
        title=_title(run, frame, factor),
    )
    return drawn


def _without_cracks(run: Run, frame: Frame) -> Figure:
    factor = magnification(frame)
    drawn, axes = style.new_figure(1, 1, **_size(frame, 1))
    draw_bodies(axes[0, 0], run, frame, find_faces(frame, run.cracks), factor)
    _name_axes(axes[0, 0], frame)
    title = _title(run, frame, factor).replace(" at ", "\nat ")
    axes[0, 0].set_title(title, loc="center", fontweight="normal")
    return drawn


def _title(run: Run, frame: Frame, factor: float) -> str:
    return f"{run.name} at {_shown(1e3 * frame.time_s)} ms, displacements {scale(factor)}"


def series(inputs: list[Path], data: Path) -> Figure:
    """Patterns of several runs at their ends, by mode, side by side."""
    runs = find_runs(inputs)
    frames = [run.last_frame for run in runs]
    size = _size(frames[0], len(runs))
    size["height"] += TWO_LINES
    drawn, axes = style.new_figure(1, len(runs), **size, sharey=True)
    for panel, run, frame in zip(axes[0], runs, frames, strict=True):
        faces, factor = find_faces(frame, run.cracks), magnification(frame)
        draw_bodies(panel, run, frame, faces, factor)
        draw_modes(panel, run, frame, faces, factor, counted=False)
        panel.set_xlabel("x [mm]")
        title = f"{run.confinement_MPa:g} MPa,\n{scale(factor)}"
        panel.set_title(title, loc="center", fontweight="normal")
    axes[0, 0].set_ylabel("y [mm]")
    drawn.legend(
        *axes[0, 0].get_legend_handles_labels(),
        loc="outside upper center",
        ncols=2,
        title=f"{runs[0].family}: confinement, and how displacements are drawn",
    )
    return drawn


def magnification(frame: Frame) -> float:
    """Round factor that makes displacements visible; 1 where they are visible as they are.

    Magnified displacements no longer show contact rightly, so they are the exception.
    """
    largest = np.quantile(np.abs(frame.displacement), 0.99) / np.ptp(frame.nodes, axis=0).max()
    if largest == 0.0 or largest >= VISIBLE:
        return 1.0
    fitting = ROUND[ROUND * largest <= LARGEST]
    return float(fitting[-1])


def scale(factor: float) -> str:
    """Words for a magnification."""
    return "to scale" if factor == 1.0 else f"magnified {factor:g} times"


def draw_bodies(axes: Axes, run: Run, frame: Frame, faces: Faces, factor: float) -> None:
    """Draw the deformed bodies, rock tinted and all others neutral, with their outline."""
    moved = frame.moved(factor)
    rock = run.is_rock(frame)
    for chosen, colour in ((rock, ROCK), (~rock, OTHER)):
        axes.add_collection(
            PolyCollection(
                moved[frame.triangles[chosen]], facecolors=colour, edgecolors=colour,
                linewidths=0.3, antialiaseds=False, rasterized=True, zorder=1,
            )
        )  # fmt: skip
    axes.add_collection(
        LineCollection(
            moved[faces.other], colors=style.GREY, linewidths=0.5, capstyle="round", zorder=2
        )
    )
    _set_window(axes, frame)
    if len(run.cracks) == 0:
        style.badge(axes, "no cracks")
    elif len(faces.lost):
        style.badge(axes, f"{len(faces.lost)} of {len(run.cracks)} crack edges have no face")


def draw_modes(
    axes: Axes, run: Run, frame: Frame, faces: Faces, factor: float, counted: bool = True
) -> None:
    """Draw both faces of each crack edge in the colour of its mode; `counted` says how many."""
    moved, table = frame.moved(factor), run.cracks["mode"].to_numpy()
    for mode, (words, colour) in MODES.items():
        chosen = faces.edges[table[faces.crack] == mode]
        label = f"{words}: {np.count_nonzero(table == mode)}" if counted else words
        axes.add_collection(
            LineCollection(
                moved[chosen],
                colors=colour,
                linewidths=0.9,
                capstyle="round",
                label=label,
                zorder=3,
            )
        )


def draw_times(
    axes: Axes, frame: Frame, faces: Faces, times: np.ndarray, factor: float
) -> LineCollection:
    """Draw both faces of each crack by `times` (k,), one an edge [ms]; dark is early."""
    lines = LineCollection(
        frame.moved(factor)[faces.edges], cmap=style.dark_to_light(), linewidths=0.9,
        capstyle="round", zorder=3,
    )  # fmt: skip
    lines.set_array(times)
    axes.add_collection(lines)
    return lines


def _set_window(axes: Axes, frame: Frame) -> None:
    """Show the reference extent and a little around it, to scale."""
    low, high = frame.nodes.min(axis=0), frame.nodes.max(axis=0)
    around = AROUND * (high - low).max()
    axes.set_aspect("equal")
    axes.set_xlim(low[0] - around, high[0] + around)
    axes.set_ylim(low[1] - around, high[1] + around)
    axes.grid(visible=False)


def _look_closer(axes: Axes, frame: Frame, faces: Faces) -> None:
    """Show the cracks alone where they are far smaller than the bodies, as about a stope."""
    if len(faces.edges) == 0:
        return
    places = frame.nodes[faces.edges].reshape(-1, 2)
    low, high = places.min(axis=0), places.max(axis=0)
    if (high - low).max() > CLOSER * np.ptp(frame.nodes, axis=0).max():
        return
    middle, reach = (low + high) / 2, 0.8 * (high - low).max()
    axes.set_xlim(middle[0] - reach, middle[0] + reach)
    axes.set_ylim(middle[1] - reach, middle[1] + reach)


def _name_axes(axes: Axes, frame: Frame) -> None:
    """Millimetres, or metres where there are many of them."""
    large = np.ptp(frame.nodes, axis=0).max() > METRES
    axes.set(xlabel="x [m]" if large else "x [mm]", ylabel="y [m]" if large else "y [mm]")
    if large:
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter(lambda value, _: f"{value / 1e3:g}".replace("-", "\u2212"))


def _shown(number: float) -> str:
    return f"{number:.3g}" if number < 1e3 else f"{number:.0f}"


def _size(frame: Frame, columns: int) -> dict[str, float]:
    """Width and height [inches] of a figure whose panels fill it at the frame's shape."""
    wide, high = np.ptp(frame.nodes, axis=0)
    around = 2 * AROUND * max(wide, high)
    shape = (high + around) / (wide + around)
    panel = min((style.WIDTH - BESIDE) / columns, TALLEST / shape)
    return {"width": max(columns * panel + BESIDE, NARROWEST), "height": panel * shape + ABOVE}
