"""Evolution of the fracture pattern of one run in three frames (Klerck 2004, Fig. 11a)."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from lithofrac.analysis.crack_faces import find_faces
from lithofrac.analysis.frames import Frame, frame_times
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.plots import style
from lithofrac.plots.fractures import OTHER, draw_modes
from lithofrac.plots.sandstone import draw_curve

SHARES = (0.1, 0.5, 1.0)  # of the final crack length: a frame shows the first that reaches each
BRIGHT = 0.99  # quantile of the last frame's strain at which the colour ends
AROUND_MM = 1.0  # shown beside the specimen


def figure(inputs: list[Path], data: Path) -> Figure:
    """Three moments of one run after its failure has localised, and where its curve is then.

    Plastic strain is shaded, cracks are drawn by mode with both faces, displacements to scale.
    """
    run = find_runs(inputs)[0]
    frames = moments(run)
    last = frames[-1]
    top = float(np.quantile(last.plastic_strain[run.is_rock(last)], BRIGHT)) or 1.0
    drawn, axes = style.new_figure(
        1, 1 + len(frames), height=4.6, width_ratios=[1.5] + [1.0] * len(frames)
    )
    curve, panels = axes[0, 0], axes[0, 1:]
    draw_curve(curve, run, style.BLACK)
    curve.set(xlabel="axial strain [%]", ylabel="axial stress [MPa]", xlim=(0, None))
    curve.set_ylim(0, 1.1 * curve.get_ylim()[1])
    for number, panel, frame in zip("123", panels, frames, strict=False):
        strain, stress = _loading(run, frame)
        curve.plot(100.0 * strain, stress, "o", ms=5, color=style.RED, zorder=4)
        curve.annotate(
            number, (100.0 * strain, stress), (-9, 5), textcoords="offset points", weight="bold"
        )
        shade = draw_strain(panel, run, frame, top)
        draw_modes(panel, run, frame, find_faces(frame, run.cracks), 1.0, counted=False)
        length = run.cracks.loc[run.cracks["time_s"] <= frame.time_s, "length_mm"].sum()
        panel.set_title(f"{number}  {100.0 * strain:.2f} %")
        panel.set_xlabel(f"x [mm]\n{length:.0f} mm of cracks")
    panels[0].set_ylabel("y [mm]")
    for panel in panels[1:]:
        panel.tick_params(labelleft=False)
    bar = drawn.colorbar(shade, ax=list(panels), shrink=0.7, aspect=30, extend="max")
    bar.set_label("effective plastic strain [-]")
    drawn.legend(
        *panels[0].get_legend_handles_labels(),
        loc="outside upper center",
        ncols=2,
        title=f"{run.name}, displacements to scale",
    )
    return drawn


def moments(run: Run) -> list[Frame]:
    """Frames at which the cracks first have a tenth, half and all of their final length.

    Each frame once; the last one alone where nothing cracks.
    """
    listed = frame_times(run.folder)
    cracks = run.cracks
    whole = cracks["length_mm"].sum()
    if not whole > 0.0:
        return [run.last_frame]
    grown = [cracks.loc[cracks["time_s"] <= t * (1 + 1e-9), "length_mm"].sum() for t, _ in listed]
    rows = {
        next((i for i, length in enumerate(grown) if length >= share * whole * (1 - 1e-9)), -1)
        for share in SHARES[:-1]
    } | {len(listed) - 1}
    return [Frame.load(listed[row][1], listed[row][0]) for row in sorted(rows) if row >= 0]


def draw_strain(axes: Axes, run: Run, frame: Frame, top: float) -> PolyCollection:
    """Draw the deformed specimen shaded by plastic strain up to `top`, other bodies in grey."""
    moved, rock = frame.moved(), run.is_rock(frame)
    keys = {"antialiaseds": False, "linewidths": 0.3, "rasterized": True, "zorder": 1}
    axes.add_collection(
        PolyCollection(moved[frame.triangles[~rock]], facecolors=OTHER, edgecolors=OTHER, **keys)
    )
    shade = PolyCollection(moved[frame.triangles[rock]], cmap="Greys", edgecolors="face", **keys)
    shade.set_array(frame.plastic_strain[rock])
    shade.set_clim(0.0, top)
    axes.add_collection(shade)
    own = frame.part(rock).nodes
    low, high = own.min(axis=0) - AROUND_MM, own.max(axis=0) + AROUND_MM
    axes.set_aspect("equal")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.grid(visible=False)
    return shade


def _loading(run: Run, frame: Frame) -> tuple[float, float]:
    """Axial strain and stress [MPa] at the moment of a frame."""
    history = run.history
    return tuple(
        float(np.interp(frame.time_s, history["time_s"], history[name]))
        for name in ("axial_strain", "axial_stress_MPa")
    )
