"""Where a run has yielded and cracked: plastic strain on the deformed mesh, cracks by mode."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lithofrac.analysis.crack_faces import find_faces
from lithofrac.analysis.frames import Frame, frame_times
from lithofrac.analysis.runs import Run, only_run
from lithofrac.data import DataError
from lithofrac.plots import style
from lithofrac.plots.evolution import BRIGHT, draw_strain
from lithofrac.plots.fractures import MODES, draw_modes


def figure(inputs: list[Path], data: Path) -> Figure:
    """Pattern of one run at its last frame, to scale; of any scene, cracked or not."""
    run = only_run(inputs, "pattern")
    frame = Frame.load(*reversed(moments(run)[-1]))
    wide, high = np.ptp(frame.part(run.is_rock(frame)).nodes, axis=0)
    height = min(max(5.4 * high / wide, 1.2), 5.4) + 1.2
    drawn, axes = style.new_figure(height=height)
    shade = draw_pattern(axes[0, 0], run, frame, brightest(run, frame))
    name_parts(drawn, axes[0, 0], run, shade)
    title = f"{run.name} at {1e3 * frame.time_s:.3g} ms, displacements to scale"
    drawn.suptitle(title, fontsize="medium", fontweight="bold")
    return drawn


def moments(run: Run) -> list[tuple[float, Path]]:
    """Times [s] and files of the frames of a run.

    Raises
    ------
    DataError
        When the run has written none.
    """
    try:
        return frame_times(run.folder)
    except FileNotFoundError:
        raise DataError(
            f"{run.folder}: holds no fields.pvd, expected a run with output.fields above 0"
        ) from None


def brightest(run: Run, frame: Frame) -> float:
    """Plastic strain at which the shade ends, from that of the rock in a frame."""
    strain = frame.plastic_strain[run.is_rock(frame)]
    return float(np.quantile(strain, BRIGHT)) or float(strain.max()) or 1.0


def draw_pattern(axes: Axes, run: Run, frame: Frame, top: float) -> PolyCollection:
    """Draw one frame and its outline, plastic strain shaded up to `top`, both faces of cracks."""
    shade = draw_strain(axes, run, frame, top)
    outline = frame.boundary()
    if run.discrete:
        faces = find_faces(frame, run.cracks)
        outline = faces.other
        draw_modes(axes, run, frame, faces, 1.0, counted=False)
    axes.add_collection(
        LineCollection(frame.moved()[outline], colors=style.GREY, linewidths=0.6, zorder=2)
    )
    radial = run.axisymmetric
    axes.set(xlabel="radius [mm]" if radial else "x [mm]", ylabel="z [mm]" if radial else "y [mm]")
    return shade


def name_parts(drawn: Figure, axes: Axes, run: Run, shade: PolyCollection) -> None:
    """Bar for the shade; a legend of the modes where the run may crack."""
    if shade.get_array().any():
        bar = drawn.colorbar(shade, ax=axes, shrink=0.8, aspect=30, extend="max")
        bar.set_label("effective plastic strain [-]")
    else:
        style.badge(axes, "no plastic strain")
    if run.discrete:
        lines = [Line2D([], [], color=colour, label=words) for words, colour in MODES.values()]
        drawn.legend(handles=lines, loc="outside lower center", ncols=2, title="crack edges")
