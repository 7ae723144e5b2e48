"""Files that extend others: merge them, and remember which file each key came from.

Mappings merge key by key, anything else is replaced. A mapping of another `kind` replaces the old
one as a whole, because the keys of two kinds have nothing to do with each other.
"""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from lithofrac.config.errors import ConfigError, one_line
from lithofrac.config.yaml_file import read_yaml

ANY = "*"  # stands for every key of a mapping
# Keys that may hold the name of a material, and the one that holds a file.
MATERIALS = (("material",), ("platens", "material"), ("scene", "materials", ANY))
GEOMETRY = ("scene", "file")
DEEPEST = 20  # dots of a key; `scene.materials.NAME.KEY` has three


@dataclass
class Draft:
    """Keys of a config before they are checked.

    Attributes
    ----------
    values : the merged keys, without `extends`
    file : the file that was asked for, named where no better one is known
    origin : path of a key -> file it was read from
    beside : key of a material or file -> folder of the file that names it; relative paths start
        there
    """

    values: dict
    file: str
    origin: dict[tuple, str] = field(default_factory=dict)
    beside: dict[tuple, Path] = field(default_factory=dict)

    @property
    def materials(self) -> list[tuple]:
        """Keys that are there and hold a material, or the name of one."""
        return [at for pattern in MATERIALS for at in _matching(pattern, self.values)]

    def folder_of(self, at: tuple) -> Path:
        """Folder where relative paths of this key start."""
        return self.beside.get(at, Path())

    def holder(self, at: tuple) -> dict:
        """Mapping that holds, or would hold, the key of this path; empty where there is none."""
        here = self.values
        for key in at[:-1]:
            here = here.get(key) if isinstance(here, Mapping) else None
        return here if isinstance(here, dict) else {}

    def file_of(self, keys: tuple) -> str:
        """File that a key, or the nearest one above it, was read from."""
        for end in range(len(keys), 0, -1):
            if keys[:end] in self.origin:
                return self.origin[keys[:end]]
        return self.file

    def put(self, values: Mapping, file: str, beside: Path | None = None, at: tuple = ()) -> None:
        """Merge keys of another file, which stands in the folder `beside`, over those here."""
        here = self.values
        for key in at:
            here = here[key]
        for key, value in values.items():
            path = (*at, key)
            old = here.get(key)
            named = isinstance(old, str) and any(_matches(path, way) for way in MATERIALS)
            if named and isinstance(value, Mapping):
                old = here[key] = {"extends": old}
                self.origin[(*path, "extends")] = self.file_of(path)
            if isinstance(value, Mapping) and isinstance(old, Mapping) and _same_kind(old, value):
                self.put(value, file, beside, path)
                continue
            if beside is not None:
                ways = [way for way in (*MATERIALS, GEOMETRY) if _matches(path, way[: len(path)])]
                inside = (at for way in ways for at in _matching(way[len(path) :], value))
                self.beside |= {(*path, *at): beside for at in inside}
            self._forget(path)
            here[key] = _copied(value)
            self.origin[path] = file

    def _forget(self, path: tuple) -> None:
        for known in [known for known in self.origin if known[: len(path)] == path]:
            del self.origin[known]


def read_draft(path: Path, chain: tuple[Path, ...] = ()) -> Draft:
    """Read a file and, below it, those that it extends.

    `extends` holds a path relative to the file, or the name of a file beside it.

    Raises
    ------
    ConfigError
        When a file cannot be read, or extends itself.
    """
    values = read_yaml(path)
    parent = values.pop("extends", None)
    draft = Draft({}, str(path))
    if parent is not None:
        if not isinstance(parent, str) or not parent:
            raise ConfigError(f"{path}: extends: expected a text, the file that is extended")
        chain = (*chain, path.resolve())
        target, key = beside_or_below(parent, path.parent), f"extends = {one_line(parent)}"
        if not os.path.exists(target):  # unlike pathlib, it takes any text
            where = one_line(target, 200)
            raise ConfigError(f"{path}: {key}: no such file, looked for {where}")
        if target.resolve() in chain:
            raise ConfigError(f"{path}: {key}: the file extends itself")
        draft = read_draft(target, chain)
        draft.file = str(path)
    draft.put(values, str(path), path.parent)
    return draft


def beside_or_below(name: str, folder: Path) -> Path:
    """Path that a config names: relative to `folder`; `.yaml` may be left out."""
    path = folder / name
    return path if path.suffix in (".yaml", ".yml") else Path(f"{path}.yaml")


def nested(values: Mapping, where: str = "--set ") -> dict:
    """Turn dotted keys, `loading.confinement_MPa`, into nested mappings.

    Parameters
    ----------
    where : what stands before a key in messages

    Raises
    ------
    ConfigError
        At a key of more levels than any config has.
    """
    draft = Draft({}, "")
    for key, value in values.items():
        *above, last = str(key).split(".")
        if len(above) >= DEEPEST:
            raise ConfigError(
                f"{where}{one_line(key)}: {len(above)} dots, expected at most {DEEPEST}"
            )
        inner: dict = {last: nested(value, where) if isinstance(value, Mapping) else value}
        for name in reversed(above):
            inner = {name: inner}
        draft.put(inner, "")
    return draft.values


def _matches(path: tuple, pattern: tuple) -> bool:
    return len(path) == len(pattern) and all(
        way in (ANY, key) for key, way in zip(path, pattern, strict=True)
    )


def _matching(pattern: tuple, value) -> list[tuple]:
    """Keys within a value that a pattern names and that are there; `()` is the value itself."""
    if not pattern:
        return [()]
    if not isinstance(value, Mapping):
        return []
    first, rest = pattern[0], pattern[1:]
    keys = list(value) if first == ANY else [key for key in (first,) if key in value]
    return [(key, *more) for key in keys for more in _matching(rest, value[key])]


def _same_kind(old: Mapping, new: Mapping) -> bool:
    return "kind" not in new or "kind" not in old or old["kind"] == new["kind"]


def _copied(value):
    if isinstance(value, Mapping):
        return {key: _copied(item) for key, item in value.items()}
    return value
