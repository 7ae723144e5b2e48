"""Strip punch: stress against strain at several fracture energies (Klerck 2004, Fig. 6).

Stages A to D are marked on one curve of each panel: that of the discrete run, if there is one.
"""

from itertools import cycle
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.punch import note
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.analysis.stages import find_stages
from lithofrac.analysis.tables import NOT_DIGITISED
from lithofrac.data import load_curves
from lithofrac.plots import style
from lithofrac.plots.sandstone import SERIES, draw_curve, draw_points

DASHES = ("-", "--", ":")  # continuum by rising fracture energy, told apart in grey as well
DISCRETE = (
    (style.RED, "-"), (style.PURPLE, "--"), (style.BLACK, ":"), (style.SKY, "-."),
)  # in the order of the suite: the run itself, then its variants  # fmt: skip


def figure(inputs: list[Path], data: Path) -> Figure:
    """Fig. 6a, the continuum and the discrete run; Fig. 6b, tension alone, where it was run."""
    runs = find_runs(inputs)
    panels = [
        ("6a", "with compression", [run for run in runs if run.rock.compression]),
        ("6b", "tension alone", [run for run in runs if not run.rock.compression]),
    ]
    panels = [panel for panel in panels if panel[2]]
    drawn, axes = style.new_figure(1, len(panels), height=4.2)
    for panel, (number, title, own) in zip(axes[0], panels, strict=True):
        draw_runs(panel, own)
        mark_stages(panel, next((run for run in own if run.discrete), own[0]))
        curves = load_curves(data, number)
        for marker, curve in zip(SERIES, curves, strict=False):
            draw_points(panel, curve, marker)
        panel.set(title=title, xlabel="axial strain [%]", ylabel="punch stress [MPa]")
        panel.set_xlim(0, None)
        panel.set_ylim(0, 1.5 * panel.get_ylim()[1])  # room for the legend
        panel.legend(loc="upper left", title="run, Gf: first peak", alignment="left")
        if not any(curve.sheet.origin == "experiment" for curve in curves):
            style.badge(panel, NOT_DIGITISED, "above right")
    return drawn


def draw_runs(axes: Axes, runs: list[Run]) -> None:
    """Draw the curves and their first peaks: continuum by fracture energy, discrete in red.

    Of several discrete runs each has its name; the first is the one that the others vary.
    """
    continuum = sorted(
        (run for run in runs if not run.discrete), key=lambda run: run.rock.fracture_energy
    )
    shades = style.confinement_colours([run.rock.fracture_energy for run in continuum])
    for run, dash in zip(continuum, cycle(DASHES), strict=False):
        _draw(axes, run, shades[run.rock.fracture_energy], dash, "continuum")
    discrete = [run for run in runs if run.discrete]
    for run, (colour, dash) in zip(discrete, cycle(DISCRETE), strict=False):
        kind = "discrete" if run is discrete[0] else run.name.removeprefix("punch_")
        _draw(axes, run, colour, dash, kind)


def mark_stages(axes: Axes, run: Run) -> None:
    """Write the letters of the stages beside a curve, one for those that coincide."""
    strain, stress = run.history["axial_strain"], run.history["axial_stress_MPa"]
    stages = find_stages(strain, stress)
    letters: dict[int, str] = {}
    for letter in "abcd":
        row = getattr(stages, letter)
        if row is not None:
            letters[row] = ", ".join(filter(None, [letters.get(row), letter.upper()]))
    for row, text in letters.items():
        at = (100.0 * strain[row], stress[row])
        axes.plot(*at, "o", ms=4, color=style.BLACK, zorder=5)
        axes.annotate(text, at, (5, 5), textcoords="offset points", weight="bold", zorder=6)
    if note(stages):
        style.badge(axes, f"{run.name}: {note(stages)}", "lower right")


def _draw(axes: Axes, run: Run, colour, dash: str, kind: str) -> None:
    draw_curve(axes, run, colour, dash)
    peak = f"{run.peak.stress:.0f} MPa" if run.peak else "no peak"
    words = f"{kind}, {run.rock.fracture_energy:g} J/m²: {peak}"
    axes.plot([], [], dash, color=colour, label=words)
