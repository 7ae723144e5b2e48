"""A suite: names of cases, the file each one extends, and the keys in which it differs."""

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, PrivateAttr, StringConstraints, ValidationError, model_validator

from lithofrac.config.base import Section
from lithofrac.config.case import Case, check_case
from lithofrac.config.errors import ConfigError, one_line, sentences, suggestion
from lithofrac.config.extend import beside_or_below, nested, read_draft
from lithofrac.config.material import PACKAGED
from lithofrac.config.yaml_file import read_yaml

Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")]
SEED = re.compile(r"^(?P<name>.+)@seed(?P<seed>[0-9]+)$")


class FileOfCases(Section):
    """A file that names cases, and where it was read from."""

    _file: Path = PrivateAttr(default=Path())

    @classmethod
    def read(cls, path: Path | str) -> Self:
        """Read a file; its cases are checked when they are asked for.

        Raises
        ------
        ConfigError
            With one sentence per mistake, one per line.
        """
        path = Path(path)
        try:
            found = cls.model_validate(read_yaml(path))
        except ValidationError as error:
            raise sentences(error, cls, lambda keys: str(path)) from None
        found._file = path
        return found


class Entry(Section):
    """One case of a suite."""

    extends: str
    """Case file, relative to the suite file."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Dotted keys of the case file and the values that replace theirs."""
    realisations: int = Field(default=1, ge=1, le=1000)
    """Meshes of equal density that are run: NAME, NAME@seed2, NAME@seed3 and so on."""
    twin: Name | None = None
    """Case of the suite that this one is a variant of: held against it in the table `variants`, and
    left out of the figures of its family."""


class Suite(FileOfCases):
    """Cases that are run together."""

    title: str
    """What the suite is, in a few words."""
    cases: dict[Name, Entry] = Field(min_length=1)
    """Name of a case, which is also the name of its results folder -> what it is."""

    @model_validator(mode="after")
    def _twins_are_cases(self):
        for name, entry in self.cases.items():
            if entry.twin is not None and (entry.twin not in self.cases or entry.twin == name):
                others = [known for known in self.cases if known != name]
                raise ValueError(
                    f"cases.{name}.twin = {entry.twin}: expected another case of the suite, "
                    f"{suggestion(entry.twin, others) if others else 'it has none'}"
                )
        return self

    @property
    def names(self) -> list[str]:
        """All runs of the suite in the order of its cases, each realisation by its own name."""
        return [
            name if seed == 1 else f"{name}@seed{seed}"
            for name, entry in self.cases.items()
            for seed in range(1, entry.realisations + 1)
        ]

    @property
    def variants(self) -> dict[str, str]:
        """Name of each variant -> name of its twin."""
        return {name: entry.twin for name, entry in self.cases.items() if entry.twin}

    def case(self, name: str, overrides: Mapping | None = None) -> Case:
        """The checked case of that name; `NAME@seed2` is another mesh of case NAME.

        Raises
        ------
        ConfigError
            When the suite has no such case, or the case is wrong.
        """
        found = SEED.match(name)
        base = found["name"] if found else name
        if base not in self.cases:
            known = suggestion(base, list(self.cases))
            raise ConfigError(f"{self._file}: cases.{one_line(base)}: no such case, {known}")
        entry = self.cases[base]
        here = f"{self._file}: cases.{one_line(base)}"
        path = beside_or_below(entry.extends, self._file.parent)
        if not os.path.exists(path):
            key, where = f"extends = {one_line(entry.extends)}", one_line(path, 200)
            raise ConfigError(f"{here}.{key}: no such file, expected {where}")
        draft = read_draft(path)
        draft.put(nested(entry.set, f"{here}.set."), f"{here}.set", self._file.parent)
        seed = {"mesh": {"seed": int(found["seed"])}} if found else {}
        draft.put({**seed, **nested(overrides or {})}, "command line", Path())
        return check_case(draft)


def load_suite(path: Path | str) -> Suite:
    """Read a suite file; its cases are checked when they are asked for.

    Raises
    ------
    ConfigError
        With one sentence per mistake, one per line.
    """
    return Suite.read(path)


def default_suite() -> Path:
    """`configs/suite.yaml` of the working folder, else the installed one."""
    here = Path("configs/suite.yaml")
    return here if here.is_file() else PACKAGED / "suite.yaml"


def find_case(name: str, suite: Path | None = None, overrides: Mapping | None = None) -> Case:
    """The case that a user names.

    Parameters
    ----------
    name : path of a case file (ending in `.yaml`), or name of a case of the suite
    suite : suite file to look in, default `default_suite()`
    overrides : keys that replace those of the case, nested or dotted

    Raises
    ------
    ConfigError
        When there is no such case, or it is wrong.
    """
    if name.endswith((".yaml", ".yml")) or os.path.exists(name):
        draft = read_draft(Path(name))
        draft.put(nested(overrides or {}), "command line", Path())
        return check_case(draft)
    return load_suite(suite or default_suite()).case(name, overrides)
