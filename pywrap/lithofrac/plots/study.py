"""Figure of a study: one mark a run, lines through the means of realisations."""

import re
from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.study import study_of, study_table
from lithofrac.data import DataError
from lithofrac.plots import style
from lithofrac.results.columns import WORDS

MOST_TICKS = 8
MARKERS = "osD^vPX"
COLOURS = (style.BLUE, style.RED, style.GREEN, style.PURPLE, style.ORANGE, style.SKY, style.BLACK)
# End of a key -> unit as it is printed; the longest end that fits counts.
UNITS = {
    "_J_m2": "J/m²",
    "_kg_m3": "kg/m³",
    "_m_s": "m/s",
    "_GPa": "GPa",
    "_MPa": "MPa",
    "_mm": "mm",
    "_deg": "°",
    "_percent": "%",
    "_J": "J",
    "_s": "s",
}


def figure(inputs: list[Path], data: Path) -> Figure:
    """What the `plot` of a study asks for; inputs as in `study_table`.

    Raises
    ------
    DataError
        As `study_table`; also when nothing can be drawn because no run has the quantity.
    """
    file, study = study_of(inputs)
    table, asked = study_table(inputs, data), study.plot
    if not table[asked.y].notna().any(axis=None):
        raise DataError(
            f"{file}: plot.y: no run has a value of {', '.join(asked.y)}, expected at least one"
        )
    drawn, axes = style.new_figure(height=3.8)
    panel = axes[0, 0]
    name, unit, words = _shared(asked.y)
    groups = list(table.groupby(asked.series, sort=True)) if asked.series else [(None, table)]
    lines = [(y, value, rows) for y in asked.y for value, rows in groups]
    for i, (y, value, rows) in enumerate(lines):
        setting = _setting(asked.series, value) if asked.series else ""
        _draw(panel, rows, asked.x, y, i, ", ".join(filter(None, (words[y], setting))))
    panel.set(xlabel=_label(*words_of(asked.x)), ylabel=_label(name, unit), title=study.title)
    lowest, largest = table[asked.y].min(axis=None), table[asked.y].max(axis=None)
    if lowest >= 0.0 and largest > 0.0:
        panel.set_ylim(0.0, 1.05 * largest)
    if asked.x_scale == "log":
        _log_axis(panel, file, table, asked.x)
    if len(lines) > 1:
        drawn.legend(loc="outside lower center", ncols=min(3, len(lines)))
    return drawn


def _log_axis(panel: Axes, file: Path, table: pd.DataFrame, x: str) -> None:
    """A logarithmic axis with a tick at each value, or at powers of ten where these are many."""
    if not pd.api.types.is_numeric_dtype(table[x]) or not (table[x].dropna() > 0).all():
        raise DataError(f"{file}: plot.x_scale = log: expected {x} to be numbers above 0")
    panel.set_xscale("log")
    values = sorted(table[x].dropna().unique())
    if len(values) <= MOST_TICKS:
        panel.set_xticks(values, labels=[f"{value:g}" for value in values])
        panel.set_xticks([], minor=True)


def _shared(quantities: list[str]) -> tuple[str, str, dict[str, str]]:
    """Name and unit that quantities share, and for each what is left to tell it apart."""
    named = {y: words_of(y) for y in quantities}
    units = {unit for _, unit in named.values()}
    unit = units.pop() if len(units) == 1 else ""
    if len(named) == 1:
        return named[quantities[0]][0], unit, {quantities[0]: ""}
    plain = {words.split(" (")[0] for words, _ in named.values()}
    if len(plain) > 1:
        return (
            "",
            unit,
            {y: words if unit else _label(*named[y]) for y, (words, _) in named.items()},
        )
    name = plain.pop()
    return name, unit, {y: words.removeprefix(name).strip(" ()") for y, (words, _) in named.items()}


def _draw(panel: Axes, rows: pd.DataFrame, x: str, y: str, number: int, words: str) -> None:
    """Line through the means, and hollow marks of the runs where a mean is of several."""
    colour = COLOURS[number % len(COLOURS)]
    marker = MARKERS[number % len(MARKERS)]
    rows = rows.dropna(subset=[y])
    if not pd.api.types.is_numeric_dtype(rows[x]) or pd.api.types.is_bool_dtype(rows[x]):
        rows = rows.assign(**{x: rows[x].map(str)})  # a text or a switch: places side by side
    means = rows.groupby(x, sort=False)[y].mean()
    means = means.sort_index() if pd.api.types.is_numeric_dtype(means.index) else means
    if len(means) < len(rows):
        panel.plot(rows[x], rows[y], marker, color=colour, markerfacecolor="none", alpha=0.6)
    panel.plot(means.index, means, f"{marker}-", color=colour, label=words)


def words_of(key: str) -> tuple[str, str]:
    """A key or quantity in words, and its unit, which is empty where the name has none."""
    keys = re.search(r"\[(.*)\]\Z", key)
    name = key[: keys.start()] if keys else key
    unit = next((end for end in UNITS if name.endswith(end)), "")
    own = name.split(".")[-1:] if unit else name.split(".")[-2:]  # `mode` alone says too little
    words = " ".join(own).removesuffix(unit).replace("_", " ")
    more = f" ({keys[1].replace(',', ', ')})" if keys else ""
    return WORDS.get(words, words) + more, UNITS.get(unit, "")


def _setting(key: str, value: object) -> str:
    words, unit = words_of(key)
    shown = f"{value:g}" if isinstance(value, int | float) and value is not True else f"{value}"
    return f"{words} {shown} {unit}".strip()


def _label(words: str, unit: str) -> str:
    return f"{words} [{unit}]".strip() if unit else words
