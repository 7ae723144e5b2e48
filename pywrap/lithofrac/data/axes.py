"""Axes of the paper's figures: quantity, unit and printed range (`figure_axes.csv`)."""

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from lithofrac.data.errors import DataError

FACTORS = {
    "1": {"1": 1.0, "percent": 1e-2, "millistrain": 1e-3, "microstrain": 1e-6},
    "microstrain": {"1": 1e6, "percent": 1e4, "millistrain": 1e3, "microstrain": 1.0},
    "MPa": {"Pa": 1e-6, "kPa": 1e-3, "MPa": 1.0, "GPa": 1e3},
    "mm": {"mm": 1.0, "cm": 10.0, "m": 1e3},
}  # unit of an axis -> unit of a file -> factor


@dataclass(frozen=True)
class Axis:
    """One axis of a figure; the printed range is None where only the image shows it."""

    quantity: str
    unit: str
    printed_min: float | None
    printed_max: float | None


def load_axes(path: Path) -> dict[str, dict[str, Axis]]:
    """Read the axes of all figures: figure -> "x" or "y" -> `Axis`."""
    try:
        rows = pd.read_csv(path, dtype={"figure": str, "unit": str})
    except FileNotFoundError:
        raise DataError(f"{path}: no such file, expected the axes of the figures") from None
    axes: dict[str, dict[str, Axis]] = {}
    for row in rows.itertuples():
        low, high = (None if pd.isna(v) else float(v) for v in (row.printed_min, row.printed_max))
        axes.setdefault(row.figure, {})[row.axis] = Axis(row.quantity, row.unit, low, high)
    return axes
