"""What the open choices change: each variant's stress-strain curve over that of its twin."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.runs import Run
from lithofrac.analysis.variants import changed_keys, families
from lithofrac.data import DataError
from lithofrac.plots import style
from lithofrac.plots.sandstone import draw_curve

COLUMNS = 3
PANEL_HEIGHT = 1.5  # inches
LEGEND_HEIGHT = 0.45  # inches


def figure(inputs: list[Path], data: Path) -> Figure:
    """One panel a variant, in the order of the suite; `inputs` as those of the table.

    Raises
    ------
    DataError
        When no variant has been run beside its twin.
    """
    pairs = [(twin, run) for twin, own in families(inputs) for run in own]
    if not pairs:
        raise DataError("variants: no run of a variant and its twin, expected at least one pair")
    columns = min(COLUMNS, len(pairs))
    rows = -(-len(pairs) // columns)
    drawn, axes = style.new_figure(rows, columns, height=rows * PANEL_HEIGHT + LEGEND_HEIGHT)
    for panel, (twin, run) in zip(axes.flat, pairs, strict=False):
        draw_pair(panel, twin, run)
    for panel in axes.flat[len(pairs) :]:
        panel.set_axis_off()
    for column in range(columns):
        lowest = axes[rows - 1 if column < len(pairs) - (rows - 1) * columns else rows - 2, column]
        lowest.set_xlabel("axial strain [%]")
    for row in axes:
        row[0].set_ylabel("axial stress [MPa]")
    handles = [
        axes[0, 0].plot([], [], color=style.GREY, lw=2.2, label="twin")[0],
        axes[0, 0].plot([], [], color=style.RED, label="variant")[0],
        axes[0, 0].plot([], [], "o", ms=4, mfc="white", mec=style.BLACK, label="first peak")[0],
    ]
    drawn.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return drawn


def draw_pair(axes: Axes, twin: Run, run: Run) -> None:
    """Draw a variant over its twin; the title names the twin and the keys that differ."""
    draw_curve(axes, twin, style.GREY)
    axes.lines[0].set_linewidth(2.2)
    draw_curve(axes, run, style.RED)
    choice = "\n".join(changed_keys(run, twin))
    axes.set_title(f"{twin.name}\n{choice}", fontsize=7.0)
    axes.set(xlim=(0, None), ylim=(0, None))
