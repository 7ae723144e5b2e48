"""Axes of the paper's figures: quantity, unit and printed range (`figure_axes.csv`)."""

import math
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from lithofrac.config.errors import one_line
from lithofrac.data.csv_file import read_columns
from lithofrac.data.errors import DataError

FACTORS = {
    "1": {"1": 1.0, "percent": 1e-2, "millistrain": 1e-3, "microstrain": 1e-6},
    "microstrain": {"1": 1e6, "percent": 1e4, "millistrain": 1e3, "microstrain": 1.0},
    "MPa": {"Pa": 1e-6, "kPa": 1e-3, "MPa": 1.0, "GPa": 1e3},
    "mm": {"mm": 1.0, "cm": 10.0, "m": 1e3},
}  # unit of an axis -> unit of a file -> factor
COLUMNS = ("figure", "axis", "quantity", "unit", "printed_min", "printed_max")


@dataclass(frozen=True)
class Axis:
    """One axis of a figure; the printed range is None where only the image shows it."""

    quantity: str
    unit: str
    printed_min: float | None
    printed_max: float | None


def load_axes(path: Path) -> dict[str, dict[str, Axis]]:
    """Read the axes of all figures: figure -> "x" and "y" -> `Axis`.

    Raises
    ------
    DataError
        One sentence on the first thing that is wrong.
    """
    rows = read_columns(path, COLUMNS, "the axes of the figures", dtype=str)
    axes: dict[str, dict[str, Axis]] = {}
    for line, row in enumerate(rows.itertuples(), start=2):
        where = f"{path}: line {line}"
        if row.axis not in ("x", "y"):
            raise DataError(f"{where}: axis {one_line(row.axis)!r}, expected x or y")
        if row.unit not in FACTORS:
            raise DataError(
                f"{where}: unit {one_line(row.unit)!r}, expected one of {', '.join(FACTORS)}"
            )
        low, high = (_number(value, where) for value in (row.printed_min, row.printed_max))
        axis = Axis(str(row.quantity), row.unit, low, high)
        axes.setdefault(str(row.figure), {})[row.axis] = axis
    for figure, pair in axes.items():
        if set(pair) != {"x", "y"}:
            raise DataError(f"{path}: figure {one_line(figure)!r} has one axis, expected x and y")
    return axes


def _number(text: str, where: str) -> float | None:
    """A number, or None where the cell is empty."""
    if pd.isna(text):
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise DataError(f"{where}: {one_line(text)!r}, expected a finite number or nothing")
    return value
