"""A study: one base case, the overrides that make its runs, what is read off them, and a figure."""

import os
import re
from collections.abc import Mapping
from itertools import product
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, PrivateAttr, model_validator

from lithofrac.config.base import Section
from lithofrac.config.case import Case, check_case
from lithofrac.config.errors import ConfigError, one_line, suggestion
from lithofrac.config.extend import beside_or_below, nested, read_draft
from lithofrac.config.suite import SEED, FileOfCases, Name

MOST = 10_000  # runs of a study
KEY_IN_NAME = re.compile(r"\{([^{}:]+)(?::([^{}]*))?\}")
WIDE = re.compile(r"[0-9]{3}")  # digits of a format that asks for a megabyte of blanks
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*\Z")  # as that of a case of a suite


class PlotSection(Section):
    """The figure of a study: points of its table, one mark a run, lines through their means."""

    x: str
    """Overridden key or quantity of the horizontal axis."""
    y: list[str] = Field(min_length=1)
    """Quantities of the vertical axis, each a line of its own."""
    series: str | None = None
    """Overridden key that tells lines apart."""
    x_scale: Literal["linear", "log"] = "linear"
    """Of the horizontal axis."""


class Study(FileOfCases):
    """Runs that differ in a few keys of one case; `grid` or `cases` says in which."""

    title: str
    """What the study is, in a few words."""
    base: str
    """Case file that all runs extend, relative to the study file."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Dotted keys of the case file that are replaced in all runs."""
    grid: dict[str, list[Any]] | None = Field(default=None, min_length=1)
    """Dotted key -> its values; every combination is run."""
    name: str | None = None
    """Name of a run of the grid, with keys in braces and formats as Python has them:
    `punch_gf{material.fracture_energy_J_m2}`, `hole_r{scene.hole_radius_mm:04.1f}`. Left out: last
    words of the keys, and values."""
    cases: dict[Name, dict[str, Any]] | None = Field(default=None, min_length=1)
    """Name of a run -> dotted keys and values, where keys change together or a grid is too much."""
    realisations: int = Field(default=1, ge=1, le=1000)
    """Meshes of equal density that are run: NAME, NAME@seed2, NAME@seed3 and so on."""
    quantities: list[str] = Field(min_length=1)
    """Columns of the table: keys of summary.json (`peak_stress_MPa`, `energy.friction_J`), or
    TABLE.COLUMN[KEYS] of a table of the suite (`strength.strength_MPa`)."""
    plot: PlotSection
    _overrides: dict[str, dict[str, Any]] = PrivateAttr(default_factory=dict)

    @model_validator(mode="after")
    def _runs_are_told_apart(self):
        if (self.grid is None) == (self.cases is None):
            raise ValueError("grid, cases: expected one of the two")
        if self.cases is not None and self.name is not None:
            raise ValueError(
                f"name = {one_line(self.name)}: expected no name beside cases, which have theirs"
            )
        own = self._combined() if self.grid is not None else self.cases
        for name, keys in own.items():
            self._overrides[name] = _leaves(nested(keys, f"{name}: "))
        if self.realisations * len(own) > MOST:
            raise ValueError(
                f"realisations = {self.realisations}: {self.realisations * len(own)} runs, "
                f"expected at most {MOST}"
            )
        if self.realisations > 1 and "mesh.seed" in self.keys:
            raise ValueError(
                f"realisations = {self.realisations}: expected 1 where mesh.seed is overridden"
            )
        return self

    @model_validator(mode="after")
    def _plot_is_of_the_table(self):
        columns = {
            "x": [*self.keys, *self.quantities],
            "series": self.keys,
            **{f"y.{i}": self.quantities for i in range(len(self.plot.y))},
        }
        asked = {"x": self.plot.x, "series": self.plot.series}
        asked |= {f"y.{i}": name for i, name in enumerate(self.plot.y)}
        for key, name in asked.items():
            if name is not None and name not in columns[key]:
                what = "quantity" if key.startswith("y") else "column"
                raise ValueError(
                    f"plot.{key} = {one_line(name)}: no such {what} of the study, "
                    f"{suggestion(name, columns[key])}"
                )
        return self

    @property
    def keys(self) -> list[str]:
        """Dotted keys that any run overrides, in the order in which they appear."""
        return list(dict.fromkeys(key for own in self._overrides.values() for key in own))

    @property
    def names(self) -> list[str]:
        """All runs, each realisation by its own name."""
        return [
            name if seed == 1 else f"{name}@seed{seed}"
            for name in self._overrides
            for seed in range(1, self.realisations + 1)
        ]

    def overrides(self, name: str) -> dict[str, Any]:
        """Dotted keys and values in which a run differs from the base."""
        return self._overrides[_split(name)[0]]

    def realisation(self, name: str) -> int:
        """Which of the meshes a run has, from 1."""
        return _split(name)[1]

    def case(self, name: str) -> Case:
        """The checked case of a run.

        Raises
        ------
        ConfigError
            When the base is missing, or the case is wrong.
        """
        base, folder = beside_or_below(self.base, self._file.parent), self._file.parent
        if not os.path.exists(base):
            key, there = f"base = {one_line(self.base)}", one_line(base, 200)
            raise ConfigError(f"{self._file}: {key}: no such file, expected {there}")
        where = "grid" if self.grid is not None else f"cases.{_split(name)[0]}"
        draft = read_draft(base)
        draft.put(nested(self.set, f"{self._file}: set."), f"{self._file}: set", folder)
        if self.realisation(name) > 1:
            draft.put({"mesh": {"seed": self.realisation(name)}}, f"{self._file}: realisations")
        draft.put(nested(self.overrides(name)), f"{self._file}: {where}", folder)
        return check_case(draft)

    def _combined(self) -> dict[str, dict[str, Any]]:
        """Name -> overrides, for every combination of the grid."""
        for key, values in self.grid.items():
            if not values or not all(isinstance(v, bool | int | float | str) for v in values):
                raise ValueError(
                    f"grid.{key}: expected a list of numbers, texts or switches; "
                    "mappings and lists of values belong under cases"
                )
        found: dict[str, dict[str, Any]] = {}
        for values in product(*self.grid.values()):
            own = dict(zip(self.grid, values, strict=True))
            name = self._name_of(own)
            if name in found:
                raise ValueError(
                    f"name: two runs of the grid are called {one_line(name)}, expected a name with "
                    f"all keys and no value twice: {', '.join(self.grid)}"
                )
            found[name] = own
            if len(found) > MOST:
                raise ValueError(f"grid: more than {MOST} runs, expected at most that many")
        return found

    def _name_of(self, own: Mapping[str, Any]) -> str:
        pattern = self.name or "_".join(f"{key.split('.')[-1]}_{{{key}}}" for key in own)
        said = f"name = {one_line(pattern)}"

        def filled(found: re.Match) -> str:
            key, form = found[1], found[2] or ""
            if key not in own:
                known = suggestion(key, list(own))
                raise ValueError(f"{said}: {{{one_line(key)}}} is no key of the grid, {known}")
            if WIDE.search(form):
                raise ValueError(f"{said}: {one_line(found[0])}: expected a width below 100")
            try:
                return format(own[key], form)
            except (ValueError, OverflowError) as error:
                raise ValueError(f"{said}: {one_line(found[0])}: {error}") from None

        name = KEY_IN_NAME.sub(filled, pattern)
        if self.name is None:  # made up here, so made fit for a folder too
            name = re.sub(r"[^A-Za-z0-9_.-]+", "-", name)
        if not NAME.match(name):
            raise ValueError(
                f"{said}: gives {one_line(name)!r}, expected letters, digits and any of _ . -"
            )
        return name


def load_study(path: Path | str) -> Study:
    """Read a study file; its cases are checked when they are asked for.

    Raises
    ------
    ConfigError
        With one sentence per mistake, one per line.
    """
    return Study.read(path)


def _split(name: str) -> tuple[str, int]:
    """Name of the overrides, and number of the realisation."""
    found = SEED.match(name)
    return (found["name"], int(found["seed"])) if found else (name, 1)


def _leaves(values: Mapping, above: str = "") -> dict[str, Any]:
    """Dotted key -> value, for nested keys; the inverse of `nested`."""
    found = {}
    for key, value in values.items():
        if isinstance(value, Mapping) and value:
            found |= _leaves(value, f"{above}{key}.")
        else:
            found[f"{above}{key}"] = value
    return found
