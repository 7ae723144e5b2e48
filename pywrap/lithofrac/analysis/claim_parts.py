"""What a check of a claim is given and what it gives back."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.analysis.curves import compare
from lithofrac.analysis.runs import Run
from lithofrac.analysis.tables import NOT_DIGITISED
from lithofrac.data import Curve, load_curves


class CannotCheckError(Exception):
    """Why a claim cannot be checked, in words."""


@dataclass(frozen=True)
class Value:
    """A computed measure in the unit of its band, and where it is from."""

    value: float
    note: str = ""


@dataclass(frozen=True)
class Source:
    """Runs by name, tables of other parts of the pipeline by name, and the folder `data/`."""

    runs: dict[str, Run]
    tables: dict[str, pd.DataFrame]
    data: Path

    def run(self, name: str) -> Run:
        """A run, or the word that it is missing."""
        if name not in self.runs:
            raise CannotCheckError(f"no run {name}")
        return self.runs[name]

    def table(self, name: str) -> pd.DataFrame:
        """A table with rows, or the word that it is missing."""
        if name not in self.tables or self.tables[name].empty:
            raise CannotCheckError(f"no table {name}")
        return self.tables[name]

    def series(self, prefix: str, needed: int = 1) -> list[Run]:
        """Runs `PREFIX_pNN` by rising confinement; at least `needed` of them.

        Realisations and variants, whose names go on, are left out.
        """
        wanted = re.compile(rf"{prefix}_p\d+")
        runs = [run for name, run in self.runs.items() if wanted.fullmatch(name)]
        if len(runs) < needed:
            found = f"{len(runs)} of {needed} runs" if runs else "no run"
            raise CannotCheckError(f"{found} {prefix}_p*")
        return sorted(runs, key=lambda run: run.confinement_MPa)

    def experiments(self, figure: str) -> list[Curve]:
        """Digitised experiments of a figure, or the word that there are none."""
        curves = [one for one in load_curves(self.data, figure) if one.sheet.origin == "experiment"]
        if not curves:
            raise CannotCheckError(NOT_DIGITISED.replace(": ", " of the figure "))
        return curves


@dataclass(frozen=True)
class Check:
    """How a claim is computed, and the figure that shows it.

    measures : source -> measure of `claims_bands.csv` -> value; raises `CannotCheckError`
    drawn : file in the folder of figures
    """

    measures: Callable[[Source], dict[str, Value]]
    drawn: str


def smallest(values: dict[str, float], words: str = "") -> Value:
    """The smallest of several values, noted with the name it belongs to; NaN counts as smallest."""
    name = min(values, key=lambda key: (not np.isnan(values[key]), values[key]))
    return Value(values[name], f"{words}{name}")


def largest(values: dict[str, float], words: str = "") -> Value:
    """The largest of several values, noted with the name it belongs to; NaN counts as largest."""
    name = max(values, key=lambda key: (np.isnan(values[key]), values[key]))
    return Value(values[name], f"{words}{name}")


def distance(curves: list[Curve], x: dict[str, np.ndarray], y: dict[str, np.ndarray]) -> Value:
    """Largest rms distance of digitised curves from what they are compared with [%].

    Parameters
    ----------
    curves : their `compare_with` is a key of `x` and `y`
    x, y : computed curves by name, in the units of the figure
    """
    known = [curve for curve in curves if curve.sheet.compare_with in x]
    if not known:
        raise CannotCheckError("no run to compare the digitised curves with")
    far = {}
    for curve in known:
        name = curve.sheet.compare_with
        far[curve.sheet.series] = 100.0 * compare(x[name], y[name], curve.x, curve.y).rms_relative
    return largest(far)
