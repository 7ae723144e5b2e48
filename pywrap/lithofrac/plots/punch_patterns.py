"""What forms beneath the strip punch, side by side (Klerck 2004, Fig. 7a, b, c and e)."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lithofrac.analysis.crack_faces import find_faces
from lithofrac.analysis.frames import Frame
from lithofrac.analysis.inelastic import Inelastic, first_damage, frame_at
from lithofrac.analysis.localisation import localised
from lithofrac.analysis.punch_pattern import Strip, pattern, pattern_time
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.data import DataError
from lithofrac.plots import style
from lithofrac.plots.fractures import MODES, ROCK, draw_bodies, draw_modes

TENSILE, COMPRESSIVE = "#cfe6f5", "#fae3bd"  # elements damaged in tension alone, in compression
LOCALISED = "#f2b95c"  # those among the latter in which failure has localised
CLOSE, WIDE = (0.9, 1.35), (2.4, 4.0)  # strip widths shown to each side of the axis and below
LONGEST = 0.25  # strip widths: length of a bar at the typical largest strain
TYPICAL, LEAST = 0.95, 0.04  # quantile of strain that has that length; shorter share is left out


def figure(inputs: list[Path], data: Path) -> Figure:
    """Damage and inelastic strain of the continuum, cracks of the discrete and tensile-only runs.

    Of several continuum runs the one of the lowest fracture energy is drawn. All but the first
    damage are drawn at complete failure, stage D, or at the end. Letters are those of the paper,
    whose (d) is a photograph.
    """
    runs = find_runs(inputs)
    panels = []
    continuum = [run for run in runs if not run.discrete]
    if continuum:
        run = min(continuum, key=lambda one: one.rock.fracture_energy)
        panels += [("a", draw_first_damage, run), ("b", draw_vectors, run)]
    for letter, compression in (("c", True), ("e", False)):
        own = [run for run in runs if run.discrete and run.rock.compression == compression]
        panels += [(letter, draw_cracks, run) for run in own[:1]]
    if not panels:
        raise DataError("plot punch_patterns: no run of the strip punch among the inputs")
    rows = (len(panels) + 1) // 2
    drawn, axes = style.new_figure(rows, min(len(panels), 2), height=0.6 + 3.7 * rows)
    for panel, (letter, draw, run) in zip(axes.flat, panels, strict=False):
        panel.set_title(f"({letter}) {draw(panel, run)}")
        panel.set(xlabel="x [mm]", ylabel="y [mm]")
    for panel in axes.flat[len(panels) :]:
        panel.set_axis_off()
    drawn.legend(handles=_legend(), loc="outside upper center", ncols=3)
    return drawn


def draw_first_damage(axes: Axes, run: Run) -> str:
    """Elements damaged in the earliest frame with damage; returns the title."""
    strip, state = Strip.of(run), first_damage(run)
    if state is None:
        style.badge(axes, "no damage")
        return f"{run.name}: first damage"
    _draw_mesh(axes, state, np.zeros(len(state.damaged), dtype=bool), lines=True)
    _window(axes, strip, *CLOSE)
    return f"{run.name}: first damage\nat {_stress(run, state.frame):.0f} MPa"


def draw_vectors(axes: Axes, run: Run) -> str:
    """Principal inelastic strains in the plane as bars at the centroids; returns the title."""
    strip, state = Strip.of(run), pattern(run)
    _draw_mesh(axes, state, localised(state.frame), lines=False)
    values, axes_of = state.principal
    size = np.abs(values).max(axis=1)
    centre = state.frame.moved()[state.frame.triangles].mean(axis=1)
    shown = state.damaged & (np.abs(centre[:, 0] - strip.axis) < WIDE[0] * strip.width)
    if shown.any():
        typical = float(np.quantile(size[shown], TYPICAL))
        for column, colour in ((0, style.RED), (1, style.BLUE)):
            sign = -1.0 if column == 0 else 1.0
            strain = np.clip(sign * values[:, column] / typical, 0.0, 1.0)
            chosen = shown & (strain > LEAST)
            half = 0.5 * LONGEST * strip.width * strain[chosen, None] * axes_of[chosen, :, column]
            bars = np.stack([centre[chosen] - half, centre[chosen] + half], axis=1)
            axes.add_collection(LineCollection(bars, colors=colour, linewidths=0.7, zorder=3))
        _draw_scale(axes, strip, typical)
    _window(axes, strip, *WIDE)
    return f"{run.name}: inelastic strain\nat {_stress(run, state.frame):.0f} MPa"


def draw_cracks(axes: Axes, run: Run) -> str:
    """Cracks by mode on the deformed block; returns the title."""
    time_s, path = frame_at(run, pattern_time(run))
    frame = Frame.load(path, time_s)
    faces = find_faces(frame, run.cracks)
    draw_bodies(axes, run, frame, faces, 1.0)
    draw_modes(axes, run, frame, faces, 1.0, counted=False)
    opened = int((run.cracks["time_s"] <= time_s).sum())
    kind = "cracks" if run.rock.compression else "tension alone"
    return f"{run.name}: {kind}\nat {_stress(run, frame):.0f} MPa, {opened} crack edges"


def _draw_mesh(axes: Axes, state: Inelastic, failed: np.ndarray, lines: bool) -> None:
    """Draw the elements, tinted where they are damaged, more where they have `failed`, (m,)."""
    moved, plastic = state.frame.moved(), state.frame.plastic_strain > 0.0
    kinds = (
        (~state.damaged, ROCK, style.LIGHT),
        (state.damaged & ~plastic, TENSILE, style.BLUE),
        (plastic & ~failed, COMPRESSIVE, style.RED),
        (failed, LOCALISED, style.RED),
    )
    for chosen, colour, edge in kinds:
        axes.add_collection(
            PolyCollection(
                moved[state.frame.triangles[chosen]], facecolors=colour,
                edgecolors=edge if lines else colour, linewidths=0.4,
                antialiaseds=lines, rasterized=True, zorder=1,
            )
        )  # fmt: skip
    outline = LineCollection(moved[state.frame.boundary()], colors=style.GREY, linewidths=0.6)
    axes.add_collection(outline)


def _draw_scale(axes: Axes, strip: Strip, typical: float) -> None:
    """A bar of the full length, with the strain that has it."""
    length = LONGEST * strip.width
    x, y = strip.axis - 0.92 * WIDE[0] * strip.width, strip.top - 0.94 * WIDE[1] * strip.width
    axes.plot([x, x + length], [y, y], color=style.BLACK, lw=1.5, zorder=5)
    words = f"≥ {100.0 * typical:.2g} %"
    axes.text(
        x + 1.3 * length, y, words, va="center", fontsize=8.0, zorder=5,
        bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none"},
    )  # fmt: skip


def _window(axes: Axes, strip: Strip, aside: float, below: float) -> None:
    axes.set_aspect("equal")
    axes.set_xlim(strip.axis - aside * strip.width, strip.axis + aside * strip.width)
    axes.set_ylim(strip.top - below * strip.width, strip.top + 0.25 * strip.width)
    axes.grid(visible=False)


def _stress(run: Run, frame: Frame) -> float:
    """Punch stress at the moment of a frame [MPa]."""
    history = run.history
    return float(np.interp(frame.time_s, history["time_s"], history["axial_stress_MPa"]))


def _legend() -> list:
    modes = [
        Line2D([], [], color=colour, label=f"crack, {words}") for words, colour in MODES.values()
    ]
    return [
        Patch(color=COMPRESSIVE, label="damaged in compression"),
        Patch(color=LOCALISED, label="failure localised"),
        Patch(color=TENSILE, label="damaged in tension alone"),
        Line2D([], [], color=style.RED, label="compressive strain"),
        Line2D([], [], color=style.BLUE, label="extensional strain"),
        *modes,
    ]
