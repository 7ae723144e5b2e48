"""Figure of a study: one mark a run, lines through the means of realisations."""

import re
from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lithofrac.analysis.study import study_of, study_table
from lithofrac.data import DataError
from lithofrac.plots import style

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
    groups = list(table.groupby(asked.series, sort=True)) if asked.series else [(None, table)]
    lines = [(y, value, rows) for y in asked.y for value, rows in groups]
    for i, (y, value, rows) in enumerate(lines):
        words = [words_of(y)[0]] if len(asked.y) > 1 else []
        words += [_setting(asked.series, value)] if asked.series else []
        _draw(panel, rows, asked.x, y, i, ", ".join(words))
    units = dict.fromkeys(words_of(y)[1] for y in asked.y)
    name = words_of(asked.y[0])[0] if len(asked.y) == 1 else "value"
    unit = next(iter(units)) if len(units) == 1 else ""
    panel.set(xlabel=_label(*words_of(asked.x)), ylabel=_label(name, unit), title=study.title)
    panel.set_xscale(asked.x_scale)
    panel.set_ylim(*((0, None) if table[asked.y].min(axis=None) >= 0.0 else (None, None)))
    if any(line.get_label()[0] != "_" for line in panel.get_lines()):
        drawn.legend(loc="outside lower center", ncols=min(3, len(lines)))
    return drawn


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
    label = words or "_one"
    panel.plot(means.index, means, f"{marker}-", color=colour, label=label)


def words_of(key: str) -> tuple[str, str]:
    """A key or quantity in words, and its unit, which is empty where the name has none."""
    keys = re.search(r"\[(.*)\]\Z", key)
    name = key[: keys.start()] if keys else key
    unit = next((end for end in UNITS if name.endswith(end)), "")
    own = name.split(".")[-1:] if unit else name.split(".")[-2:]  # `mode` alone says too little
    words = " ".join(own).removesuffix(unit).replace("_", " ")
    more = f" ({keys[1].replace(',', ', ')})" if keys else ""
    return words + more, UNITS.get(unit, "")


def _setting(key: str, value: object) -> str:
    words, unit = words_of(key)
    shown = f"{value:g}" if isinstance(value, int | float) and value is not True else f"{value}"
    return f"{words} {shown} {unit}".strip()


def _label(words: str, unit: str) -> str:
    return f"{words} [{unit}]" if unit else words
