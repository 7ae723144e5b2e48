"""Speed: what a step costs, what leaving out saves, how cost grows and how it is predicted."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.speed import BESIDE, read_benchmark
from lithofrac.data import DataError
from lithofrac.data.csv_file import read_columns
from lithofrac.plots import style

MARKS = {5_000: (style.BLUE, "o"), 50_000: (style.ORANGE, "s"), 200_000: (style.GREEN, "^")}
SERIES = {
    "elements": (style.BLUE, "o", "a step, over elements"),
    "test": (style.ORANGE, "s", "a test, over elements"),
    "steps": (style.GREEN, "^", "5,000 elements, over steps"),
    "cracks": (style.RED, "D", "more in a step, over cut edges"),
    "threads": (style.PURPLE, "v", "a step on the wall, over threads"),
}
INPUTS = ("benchmark.json", *BESIDE)


def figure(inputs: list[Path], data: Path) -> Figure:
    """Four panels; inputs are `benchmark.json`, `leave_out.csv` and `growth.csv`, in any order."""
    by_name = {Path(path).name: Path(path) for path in inputs}
    if set(by_name) != set(INPUTS):
        raise DataError(f"plot speed: expected {', '.join(INPUTS)}")
    rows = read_benchmark(by_name["benchmark.json"])["rows"]
    leave_out, growth = (
        read_columns(by_name[name], (), "a table of the benchmark") for name in BESIDE
    )
    drawn, axes = style.new_figure(2, 2, height=8.4)
    _draw_rows(axes[0, 0], pd.DataFrame(rows))
    _draw_leave_out(axes[0, 1], leave_out)
    _draw_growth(axes[1, 0], growth)
    _draw_prediction(axes[1, 1], leave_out)
    return drawn


def _draw_rows(panel: Axes, rows: pd.DataFrame) -> None:
    """Speed of one thread by kind of step and number of elements."""
    rows = rows[rows["threads"] == 1].drop_duplicates(["name", "elements"])
    names = list(dict.fromkeys(rows["name"]))
    speed = "million_element_steps_per_core_second"
    for near, (colour, marker) in MARKS.items():
        own = rows[(rows["elements"] / near - 1.0).abs() < 0.02]
        places = [names.index(name) for name in own["name"]]
        spread = [own[speed] - own["lowest"], own["highest"] - own[speed]]
        panel.errorbar(
            own[speed], places, xerr=spread, fmt=marker, color=colour, ms=4, lw=0.8,
            label=f"{near:,} elements",
        )  # fmt: skip
    panel.set_xscale("log")
    panel.set_yticks(range(len(names)), [name.replace("_", " ") for name in names], fontsize=6)
    panel.invert_yaxis()
    panel.legend(loc="upper center", bbox_to_anchor=(0.4, -0.16), fontsize=7)
    panel.set(xlabel="10⁶ element-steps per core-second", title="a  One thread")


def _draw_leave_out(panel: Axes, table: pd.DataFrame) -> None:
    """Time with everything on over time with what is needed, by case."""
    places = np.arange(len(table))
    panel.barh(places, table["forced_over_needed"], color=style.SKY, height=0.7)
    panel.axvline(1.0, color=style.BLACK, lw=0.9)
    panel.set_yticks(places, table["case"], fontsize=6)
    panel.invert_yaxis()
    panel.grid(axis="y", visible=False)
    panel.set(xlabel="time, forced over needed [-]", title="b  Leaving out")


def _draw_growth(panel: Axes, table: pd.DataFrame) -> None:
    """Each series over its first point, with its exponent."""
    for name, (colour, marker, words) in SERIES.items():
        own = table[table["series"] == name]
        if own.empty:
            continue
        x, y = own["x"] / own["x"].iloc[0], own["seconds"] / own["seconds"].iloc[0]
        fitted = f"{own['exponent'].iloc[0]:.2f}"
        if own["exponent_low"].notna().all():
            half = 0.5 * (own["exponent_high"].iloc[0] - own["exponent_low"].iloc[0])
            fitted += f" ± {half:.2f}"
        panel.loglog(x, y, marker=marker, ms=4, color=colour, label=f"{words}: {fitted}")
    panel.legend(loc="upper center", bbox_to_anchor=(0.4, -0.16), fontsize=7)
    panel.set(
        xlabel="over the first point [-]",
        ylabel="time over that of the first point [-]",
        title="c  Growth",
    )


def _draw_prediction(panel: Axes, table: pd.DataFrame) -> None:
    """Predicted over measured time, with a factor of two on either side."""
    marks = ((True, style.BLUE, "o", "continuum"), (False, style.RED, "^", "cracks"))
    for continuum, colour, marker, words in marks:
        own = table[table["continuum"].astype(bool) == continuum]
        panel.loglog(
            own["run_seconds"], own["check_seconds"], marker, ms=4, color=colour, label=words
        )
    ends = np.array([table["run_seconds"].min(), table["run_seconds"].max()])
    for factor, line in ((1.0, "-"), (0.5, "--"), (2.0, "--")):
        panel.loglog(ends, factor * ends, line, color=style.BLACK, lw=0.9)
    panel.legend(loc="upper left", fontsize=7)
    panel.set(
        xlabel="measured [core-seconds]",
        ylabel="predicted by check [core-seconds]",
        title="d  Prediction",
    )
