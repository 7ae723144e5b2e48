"""Block with a hole: gauges and crack patterns at initiation (Klerck 2004, Figs 14 and 15)."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from lithofrac.analysis.hole import ZONES, Event, HoleRun, is_hole
from lithofrac.analysis.runs import find_runs
from lithofrac.analysis.tables import NOT_DIGITISED
from lithofrac.config.contact import ROCK
from lithofrac.data import load_curves
from lithofrac.data.axes import load_axes
from lithofrac.data.digitised import AXES
from lithofrac.plots import style
from lithofrac.plots.fractures import MODES
from lithofrac.plots.fractures import ROCK as TINT
from lithofrac.problem import Mesh

COLOURS = {"primary": style.BLUE, "remote": style.GREEN, "sidewall": style.RED}
MARKS = {"curvature": "o", "exhaustion": "s", "crack": "^"}
SERIES = ("v", "x", "+", "1", "2")  # markers of digitised series
MICRO, MM = 1e6, 1e3
RADII = (25.0, 16.3, 6.4)  # mm, of Fig. 14 in the paper's order of Fig. 13
AROUND = 2.2  # radii shown beside and above the hole
CLOSE = 3.0  # strain shown about the kinks over the largest strain at one


def gauges(inputs: list[Path], data: Path) -> Figure:
    """Fig. 15 of the first run: on the printed axes, and close to the kinks."""
    run = HoleRun(next(run for run in find_runs(inputs) if is_hole(run)))
    events = list(run.events())
    printed = load_axes(data / AXES)["15"]
    drawn, axes = style.new_figure(1, 2, height=4.6)
    whole, close = axes[0]
    chosen = {zone: _shown(zone, events, run) for zone in ZONES}
    loading = int(np.argmax(run.stress)) + 1  # what follows is the collapse of the block
    _printed_axes(whole, printed, run)
    _close_to(close, events, run)
    for panel in axes[0]:
        for zone, name in chosen.items():
            if name is None:
                continue
            strain = MICRO * run.gauges[name].strain
            panel.plot(strain[:loading], run.stress[:loading], color=COLOURS[zone], lw=1.1)
            for event in events:
                if event.zone == zone:
                    draw_event(panel, event, strain, run)
        panel.axvline(0.0, color=style.GREY, lw=0.6)
        panel.set(xlabel="principal strain [microstrain]", ylabel="axial stress [MPa]")
    _name_what_is_beyond(whole, events, chosen, run)
    whole.set_title("axes of Fig. 15")
    for marker, curve in zip(SERIES, load_curves(data, "15"), strict=False):
        whole.plot(curve.x, curve.y, marker, ms=4, color=style.BLACK, zorder=4,
                   label=f"{curve.sheet.origin}: {curve.sheet.series}")  # fmt: skip
    if not any(curve.sheet.origin == "experiment" for curve in load_curves(data, "15")):
        style.badge(whole, NOT_DIGITISED, "upper left")
    for zone, name in chosen.items():
        words = f"{zone}: {name}" if name else f"{zone}: no gauge"
        whole.plot([], [], color=COLOURS[zone], label=words)
    for criterion, mark in MARKS.items():
        whole.plot([], [], mark, mfc="white", mec=style.BLACK, label=criterion)
    drawn.legend(
        *whole.get_legend_handles_labels(), loc="outside upper center", ncols=3,
        title=f"{run.run.name}: gauge of the first event in each zone, initiation by criterion",
    )  # fmt: skip
    return drawn


def _shown(zone: str, events: list[Event], run: HoleRun) -> str | None:
    """Gauge of a zone to draw: that of the first event by curvature, else the first one."""
    named = [e.probe for e in events if e.zone == zone and e.criterion == "curvature" and e.probe]
    names = [gauge.name for gauge in run.zone(zone)]
    return named[0] if named else (names[0] if names else None)


def draw_event(axes: Axes, event: Event, strain: np.ndarray, run: HoleRun) -> None:
    """Mark an event within the axes on the curve of its zone, with its interval of stress."""
    at = float(np.interp(event.time_s, run.times, strain))
    low, high = axes.get_xlim()
    if not low <= at <= high or not event.stress <= axes.get_ylim()[1]:
        return
    away = [[max(event.stress - event.low, 0.0)], [max(event.high - event.stress, 0.0)]]
    axes.errorbar(
        at, event.stress, yerr=away, fmt=MARKS[event.criterion], ms=5, mfc="white",
        mec=COLOURS[event.zone], ecolor=COLOURS[event.zone], elinewidth=1.0, capsize=2.5, zorder=3,
        clip_on=False,
    )  # fmt: skip


def _printed_axes(axes: Axes, printed: dict, run: HoleRun) -> None:
    """The printed range, framed where the stress goes beyond it; strains beyond it are named."""
    low, high = printed["x"].printed_min, printed["x"].printed_max
    top = printed["y"].printed_max
    axes.set_xlim(low, high)
    axes.set_ylim(0.0, max(top, 1.12 * float(run.stress.max())))
    axes.set_xticks(np.arange(low, high + 1.0, 2000.0))
    axes.tick_params(axis="x", rotation=30)
    if axes.get_ylim()[1] > top:
        axes.add_patch(
            Rectangle((low, 0.0), high - low, top, fill=False, ec=style.GREY, ls="--", lw=0.9)
        )
        axes.annotate(
            f"printed up to {top:g} MPa", (high, top), xytext=(-3, 3), textcoords="offset points",
            ha="right", fontsize=7, color=style.GREY,
        )  # fmt: skip


def _name_what_is_beyond(axes: Axes, events: list[Event], chosen: dict, run: HoleRun) -> None:
    """Events of the drawn gauges whose strain lies outside of the axis, in words."""
    low, high = axes.get_xlim()
    words = []
    for event in events:
        if np.isnan(event.stress) or chosen[event.zone] is None:
            continue
        strain = MICRO * run.gauges[chosen[event.zone]].strain
        at = float(np.interp(event.time_s, run.times, strain))
        if not low <= at <= high:
            words.append(f"{event.zone} {event.criterion}:\n{event.stress:.1f} MPa, {at:.0f}")
    if words:
        axes.text(0.98, 0.02, "\n".join(["beyond the axis:", *words]), transform=axes.transAxes,
                  ha="right", va="bottom", fontsize=7, color=style.BLACK)  # fmt: skip


def _close_to(axes: Axes, events: list[Event], run: HoleRun) -> None:
    """Window of the changes of curvature."""
    found = [event for event in events if event.criterion == "curvature" and event.probe]
    axes.set_title("close to the changes of curvature")
    if not found:
        style.badge(axes, "no change of curvature")
        return
    at = {
        event.zone: MICRO * np.interp(event.time_s, run.times, run.gauges[event.probe].strain)
        for event in found
    }
    wide = CLOSE * max(abs(value) for zone, value in at.items() if zone != "sidewall") \
        if set(at) - {"sidewall"} else 0.0  # fmt: skip
    axes.set_xlim(min(1.6 * at.get("sidewall", 0.0), -0.3 * wide), max(wide, 100.0))
    axes.set_ylim(0.0, 1.5 * max(event.high for event in found))


def patterns(inputs: list[Path], data: Path) -> Figure:
    """Fig. 14: cracks right after primary, remote and sidewall initiation, a row a radius."""
    runs = [HoleRun(run) for run in find_runs(inputs) if is_hole(run)]
    rows = [run for radius in RADII for run in runs
            if run.radius_mm == radius and run.series == "similar" and run.seed == 1]  # fmt: skip
    rows = rows or runs[:1]
    shape = 0.62 * style.WIDTH / 3.0
    drawn, axes = style.new_figure(len(rows), len(ZONES), height=0.8 + len(rows) * (shape + 0.3))
    for panels, run in zip(axes, rows, strict=True):
        events = {e.zone: e for e in run.events() if e.criterion == "crack"}
        for panel, zone in zip(panels, ZONES, strict=True):
            draw_stage(panel, run, events[zone])
        panels[0].set_ylabel(f"R = {run.radius_mm:g} mm\ny [mm]")
    for panel in axes[-1]:
        panel.set_xlabel("x [mm]")
    for words, colour in MODES.values():
        axes[0, 0].plot([], [], color=colour, lw=2.0, label=words)
    drawn.legend(
        *axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2,
        title="cracks right after initiation in each zone (first crack in it), upper half",
    )  # fmt: skip
    return drawn


def draw_stage(axes: Axes, run: HoleRun, event: Event) -> None:
    """Draw the rock about the hole and all cracks up to one record after an event.

    Without a crack in its zone the stage is that of the largest axial stress, and says so.
    """
    mesh = Mesh.load(run.run.folder / "mesh.npz")
    rock = mesh.triangles[mesh.body == mesh.body_names.index(ROCK)]
    axes.add_collection(
        PolyCollection(
            MM * mesh.nodes[rock],
            facecolors=TINT,
            edgecolors=TINT,
            linewidths=0.3,
            antialiaseds=False,
            rasterized=True,
            zorder=1,
        )
    )
    edges = np.sort(np.concatenate([rock[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    outline = MM * mesh.nodes[edges[count == 1]]
    axes.add_collection(LineCollection(outline, colors=style.GREY, linewidths=0.8, zorder=2))
    if np.isnan(event.time_s):
        row = int(np.argmax(run.stress))
        axes.set_title(f"no {event.zone} crack;\nat {run.stress[row]:.1f} MPa, the largest",
                       fontweight="normal", fontsize=8)  # fmt: skip
    else:
        row = min(int(np.searchsorted(run.times, event.time_s)) + 1, len(run.times) - 1)
        late = f", {event.note}" if event.note else ""
        axes.set_title(f"{event.zone}\n{event.stress:.1f} MPa{late}", fontsize=8)
    cracks = run.run.cracks
    cracks = cracks[cracks["time_s"] <= run.times[row]]
    for mode, (_, colour) in MODES.items():
        own = cracks.loc[cracks["mode"] == mode, ["x1_mm", "y1_mm", "x2_mm", "y2_mm"]]
        axes.add_collection(
            LineCollection(
                own.to_numpy(dtype=float).reshape(-1, 2, 2),
                colors=colour,
                linewidths=1.6,
                capstyle="round",
                zorder=3,
            )
        )
    if len(cracks):
        style.badge(axes, f"crack edges: {len(cracks)}", "upper right")
    reach = AROUND * run.radius_mm
    axes.set_aspect("equal")
    axes.set_xlim(-reach, reach)
    axes.set_ylim(0.0, 1.15 * reach)
    axes.grid(visible=False)
