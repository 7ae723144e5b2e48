"""Intake of curves digitised from the paper's figures.

A curve is two files with one name: `NAME.csv` as WebPlotDigitizer exports it (x and y, no header)
and `NAME.yaml` (`Sheet`). Both are checked against the printed axes of the figure.
"""

import datetime
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field, ValidationError, field_validator

from lithofrac.config.base import NonNegative, Section
from lithofrac.config.errors import ConfigError, one_line, sentences
from lithofrac.config.yaml_file import read_yaml
from lithofrac.data.axes import FACTORS, Axis, load_axes
from lithofrac.data.errors import DataError
from lithofrac.errors import FileError
from lithofrac.plain_file import text_of

FOLDER = Path("klerck2004", "digitised")
AXES = Path("klerck2004", "figure_axes.csv")


class AxisSheet(Section):
    """Unit of a column and the range printed on that axis."""

    unit: str
    printed_min: float | None = None
    printed_max: float | None = None


class Uncertainty(Section):
    """Uncertainty of one point, in the units of its column."""

    x: NonNegative
    y: NonNegative


class Sheet(Section):
    """What a digitised series is: the YAML file beside its CSV."""

    figure: str
    series: str = Field(min_length=1)
    origin: Literal["experiment", "model"]
    compare_with: str = Field(min_length=1)
    x: AxisSheet
    y: AxisSheet
    uncertainty: Uncertainty
    digitised_by: str = Field(min_length=1)
    date: datetime.date
    source: str = Field(min_length=1)

    @field_validator("figure", mode="before")
    @classmethod
    def _as_text(cls, value):
        """Take `figure: 9` for "9"."""
        return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


@dataclass(frozen=True)
class Curve:
    """A digitised series in the units of its figure's axes (`figure_axes.csv`).

    x, y : (n,) values; x_error, y_error : uncertainty of one point, same units
    """

    sheet: Sheet
    x: np.ndarray
    y: np.ndarray
    x_error: float
    y_error: float


def load_curves(data: Path, figure: str) -> list[Curve]:
    """All digitised series of a figure, sorted by file name; empty when there are none.

    Every file of the intake is checked, also those of other figures: a bad file must not wait
    until its own plot is drawn.

    Raises
    ------
    DataError
        One sentence on the first file that is wrong.
    """
    folder = data / FOLDER
    if not folder.is_dir():
        return []
    for path in sorted(folder.glob("*.csv")):
        if not path.with_suffix(".yaml").is_file():
            raise DataError(
                f"{path}: has no {path.stem}.yaml beside it, expected one that says what it is"
            )
    sheets = sorted(folder.glob("*.yaml"))
    axes = load_axes(data / AXES) if sheets else {}
    curves = [_load(path, axes) for path in sheets]
    return [curve for curve in curves if curve.sheet.figure == figure]


def _load(path: Path, axes: dict[str, dict[str, Axis]]) -> Curve:
    """Read one series and bring it to the units of the figure."""
    sheet = _read_sheet(path)
    if sheet.figure not in axes:
        raise DataError(
            f"{path}: figure: {one_line(sheet.figure)!r}, expected one of {', '.join(sorted(axes))}"
        )
    points = _read_points(path.with_suffix(".csv"))
    columns, errors = [], []
    for index, name in enumerate("xy"):
        factor = _factor(path, name, getattr(sheet, name), axes[sheet.figure][name])
        _check_range(path, name, points[:, index], getattr(sheet, name), axes[sheet.figure][name])
        columns.append(factor * points[:, index])
        errors.append(factor * getattr(sheet.uncertainty, name))
    return Curve(sheet, *columns, *errors)


def _read_sheet(path: Path) -> Sheet:
    try:
        return Sheet.model_validate(read_yaml(path))
    except ConfigError as error:
        raise DataError(str(error)) from None
    except ValidationError as error:
        raise DataError(str(sentences(error, Sheet, lambda keys: str(path)))) from None


def _read_points(path: Path) -> np.ndarray:
    """Points of a curve, (n, 2), n >= 1."""
    try:
        lines = text_of(path, "the points of the curve").splitlines()
    except FileError as error:
        raise DataError(str(error)) from None
    points = []
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        try:
            x, y = (float(word) for word in line.split(","))
        except ValueError:
            raise DataError(
                f"{path}: line {number}: {one_line(line)!r}, expected two numbers parted by a comma"
            ) from None
        if not np.isfinite([x, y]).all():
            raise DataError(f"{path}: line {number}: {one_line(line)!r}, expected finite numbers")
        points.append((x, y))
    if not points:
        raise DataError(f"{path}: holds no points, expected two numbers a line")
    return np.array(points)


def _factor(path: Path, name: str, given: AxisSheet, axis: Axis) -> float:
    """Factor from the unit of the file to the unit of the figure's axis."""
    known = FACTORS[axis.unit]
    if given.unit not in known:
        raise DataError(
            f"{path}: {name}.unit: {one_line(given.unit)!r}, expected one of {', '.join(known)}"
            f" ({axis.quantity})"
        )
    return known[given.unit]


def _check_range(path: Path, name: str, values: np.ndarray, given: AxisSheet, axis: Axis) -> None:
    """Refuse a printed range that is unknown or contradicts the figure, and points outside it."""
    factor = FACTORS[axis.unit][given.unit]
    limits = {}
    for end in ("printed_min", "printed_max"):
        stated, known = getattr(given, end), getattr(axis, end)
        if stated is None and known is None:
            raise DataError(
                f"{path}: {name}.{end}: missing key, expected the end of the printed axis, which"
                " figure_axes.csv does not know for this figure"
            )
        limit = known if stated is None else factor * stated
        if known is not None and not np.isclose(limit, known, rtol=1e-6, atol=0.0):
            raise DataError(
                f"{path}: {name}.{end}: {stated:g} {given.unit}, expected {known:g} {axis.unit},"
                " the printed axis in figure_axes.csv"
            )
        limits[end] = limit
    low, high = limits["printed_min"], limits["printed_max"]
    if not (low < high and np.isfinite([low, high]).all()):
        raise DataError(
            f"{path}: {name}.printed_max: {high:g} {axis.unit}, expected more than"
            f" {name}.printed_min, {low:g} {axis.unit}"
        )
    outside = (factor * values < low) | (factor * values > high)
    if outside.any():
        worst = factor * values[np.argmax(outside)]
        raise DataError(
            f"{path.with_suffix('.csv')}: {name} value {worst:g} {axis.unit}, expected"
            f" {low:g} to {high:g} {axis.unit}, the printed axis of {axis.quantity}"
        )
