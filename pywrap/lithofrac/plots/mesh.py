"""Mesh of a scene and what acts on its boundary."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from lithofrac.analysis.runs import find_runs
from lithofrac.config import load_case
from lithofrac.plots import style
from lithofrac.problem import Mesh, PressureLoad, Problem, VelocityLoad
from lithofrac.scenes import make_problem

BODIES = ("#f2ead9", "#dfe6ec", "#e8e2ef", "#dfebdf", "#efdfdf")
ARROWS = 12  # symbols along one boundary at most
RASTER = 1000  # triangles; more of them are lighter as pixels than as lines


def figure(inputs: list[Path], data: Path) -> Figure:
    """Mesh of one run, rebuilt boundary conditions drawn on it."""
    run = find_runs(inputs)[0]
    problem = make_problem(load_case(run.folder / "case.yaml"), Mesh.load(run.folder / "mesh.npz"))
    drawn, axes = style.new_figure(height=4.2)
    draw_problem(axes[0, 0], problem)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    single = dict(zip(labels, handles, strict=True))
    drawn.legend(single.values(), single.keys(), loc="outside right center", title=run.name)
    return drawn


def draw_problem(axes: Axes, problem: Problem) -> None:
    """Draw triangles by body, rollers, prescribed velocities and pressures; millimetres."""
    draw_mesh(axes, problem.mesh)
    size = float(np.ptp(1e3 * problem.mesh.nodes, axis=0).max())
    moved = [load for load in problem.velocity_loads if load.speed != 0.0]
    for load in moved:
        draw_velocity(axes, problem.mesh, load, size)
    for load in problem.velocity_loads:  # what moves along one axis only is guided, not held
        if load.speed == 0.0 and not any(np.array_equal(load.nodes, own.nodes) for own in moved):
            draw_rollers(axes, problem.mesh, load, size)
    for load in problem.pressure_loads:
        draw_pressure(axes, problem.mesh, load, size)
    axes.set_aspect("equal")
    axes.margins(0.06)
    axes.grid(visible=False)
    radial = problem.axisymmetric
    axes.set(xlabel="radius [mm]" if radial else "x [mm]", ylabel="z [mm]" if radial else "y [mm]")
    if radial:
        axes.axvline(0.0, color=style.GREY, ls="-.", lw=0.8, label="axis of revolution")


def draw_mesh(axes: Axes, mesh: Mesh) -> None:
    """Draw all triangles, one tint a body, the boundary sets darker."""
    nodes = 1e3 * mesh.nodes
    for index, name in enumerate(mesh.body_names):
        chosen = mesh.triangles[mesh.body == index]
        axes.tripcolor(
            nodes[:, 0], nodes[:, 1], np.full(len(chosen), 0.0), triangles=chosen,
            cmap=style.flat(BODIES[index % len(BODIES)]), edgecolors=style.GREY, linewidth=0.25,
            rasterized=len(chosen) > RASTER,
        )  # fmt: skip
        label = f"{name}, triangles: {len(chosen)}"
        axes.plot([], [], "s", color=BODIES[index % len(BODIES)], mec=style.GREY, label=label)
    for edges in mesh.edge_sets.values():
        axes.add_collection(LineCollection(nodes[edges], colors=style.BLACK, linewidths=0.9))


def draw_rollers(axes: Axes, mesh: Mesh, load: VelocityLoad, size: float) -> None:
    """Draw circles just outside nodes that cannot move in one direction."""
    points = 1e3 * _some(mesh.nodes[load.nodes])
    points[:, load.component] += 0.015 * size * _outward(mesh, load)
    axes.plot(*points.T, "o", ms=4, mfc="white", mec=style.GREEN, ls="none",
              label="roller")  # fmt: skip


def draw_velocity(axes: Axes, mesh: Mesh, load: VelocityLoad, size: float) -> None:
    """Draw arrows of a prescribed velocity outside the outermost of the nodes it acts on."""
    outward = mesh.nodes[load.nodes, load.component] * _outward(mesh, load)
    outermost = load.nodes[np.isclose(outward, outward.max(), rtol=0.0, atol=1e-9 * size)]
    tips = 1e3 * _some(mesh.nodes[outermost])
    step = np.zeros(2)
    step[load.component] = np.sign(load.speed) * 0.07 * size
    away = _outward(mesh, load) * np.sign(load.speed)
    tips[:, load.component] += 0.02 * size * _outward(mesh, load)
    if away > 0:
        tips = tips + step
    _arrows(axes, tips, np.tile(step, (len(tips), 1)), style.BLUE)
    axes.plot([], [], color=style.BLUE, marker=r"$\downarrow$", ls="none",
              label=f"velocity {abs(load.speed):g} m/s ({load.name})")  # fmt: skip


def draw_pressure(axes: Axes, mesh: Mesh, load: PressureLoad, size: float) -> None:
    """Draw arrows of a pressure onto its edges; a spring behind them is named in the legend."""
    ends = 1e3 * mesh.nodes[load.edges]
    along = ends[:, 1] - ends[:, 0]
    inward = np.column_stack([-along[:, 1], along[:, 0]])  # material is on the left
    inward /= np.linalg.norm(inward, axis=1, keepdims=True)
    chosen = _spread(len(ends))
    middle = ends.mean(axis=1)[chosen] - 0.02 * size * inward[chosen]
    _arrows(axes, middle, 0.06 * size * inward[chosen], style.RED)
    label = f"pressure {load.pressure / 1e6:.3g} MPa ({load.name})"
    if load.stiffness > 0.0:
        label += f"\nand spring {load.stiffness / 1e9:.3g} MPa/mm"
    axes.plot([], [], color=style.RED, marker=r"$\leftarrow$", ls="none", label=label)


def _arrows(axes: Axes, tips: np.ndarray, steps: np.ndarray, colour: str) -> None:
    """Draw arrows that end at `tips`; sizes in the units of the axes."""
    arrows = axes.quiver(
        *tips.T, *steps.T, pivot="tip", angles="xy", scale_units="xy", scale=1.0,
        color=colour, units="inches", width=0.018, headwidth=5, headlength=6, headaxislength=6,
        zorder=4,
    )  # fmt: skip
    arrows.set_in_layout(False)  # its extent is not known before the axes have their size
    axes.plot(*(tips - steps).T, alpha=0.0)  # so that the limits of the axes include the tails


def _outward(mesh: Mesh, load: VelocityLoad) -> float:
    """Side of the scene on which a set of nodes lies, +1 or -1, along its component."""
    along = mesh.nodes[:, load.component]
    middle = 0.5 * (along.min() + along.max())
    return 1.0 if along[load.nodes].mean() > middle else -1.0


def _some(points: np.ndarray) -> np.ndarray:
    """At most `ARROWS` of the points, spread evenly along their longer direction."""
    longer = int(np.argmax(np.ptp(points, axis=0)))
    return points[np.argsort(points[:, longer])][_spread(len(points))].copy()


def _spread(count: int) -> np.ndarray:
    """At most `ARROWS` of `count` indices, evenly apart."""
    return np.arange(0, count, max(1, -(-(count - 1) // (ARROWS - 1))))
