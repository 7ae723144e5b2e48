"""Read one YAML file into plain Python, or say in one sentence why not.

The loader builds no objects (safe), refuses a key that stands twice in one mapping, and takes for
numbers what the core schema of YAML 1.2 does (section 10.3.2), in decimal: `1e-3` and `1.e3` are
numbers and `010` is ten. In YAML 1.1 these are a text, a text and eight, and `1:30` is ninety.
Aliases are refused: a few lines of them unfold to more than any machine holds.
"""

import re
from pathlib import Path
from typing import Any

import yaml

from lithofrac.config.errors import ConfigError, one_line

MOST_BYTES = 1_000_000  # of a file; cases and materials have some thousands
MOST_DIGITS = 1000  # of a whole number; beyond 309 it is above every float
INT, FLOAT = "tag:yaml.org,2002:int", "tag:yaml.org,2002:float"
NUMBERS = {
    INT: re.compile(r"[-+]?[0-9]+\Z"),
    FLOAT: re.compile(
        r"(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"
        r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))\Z"
    ),
}  # in the order in which they are tried
# What PyYAML raises: at tags with the wrong content, such as `!!bool maybe`, or at deep nesting.
MISREAD = (
    yaml.YAMLError, ValueError, RecursionError, LookupError, AttributeError, TypeError,
    ArithmeticError,
)  # fmt: skip


def _resolvers() -> dict:
    """First letter -> tags and their patterns: those of PyYAML with other numbers."""
    found = {
        first: [(tag, pattern) for tag, pattern in pairs if tag not in NUMBERS]
        for first, pairs in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }
    for first in "-+.0123456789":
        found[first] = [*found.get(first, []), *NUMBERS.items()]
    return found


class _Loader(yaml.SafeLoader):
    """The safe loader with unique keys, numbers as in YAML 1.2 and no aliases."""

    yaml_implicit_resolvers = _resolvers()

    def compose_node(self, parent, index):
        if self.check_event(yaml.events.AliasEvent):
            mark = self.peek_event().start_mark
            raise yaml.composer.ComposerError(None, None, "aliases are not taken", mark)
        return super().compose_node(parent, index)


class _Dumper(yaml.SafeDumper):
    """Quotes the texts that `_Loader` would take for numbers, and writes no aliases."""

    yaml_implicit_resolvers = _resolvers()

    def ignore_aliases(self, data) -> bool:
        return True


def _decimal(loader: _Loader, node: yaml.ScalarNode) -> int:
    text = loader.construct_scalar(node)
    if len(text) > MOST_DIGITS:
        problem = f"a whole number of {len(text)} digits, expected at most {MOST_DIGITS}"
        raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)
    return int(text)


def _unique_mapping(loader: _Loader, node: yaml.MappingNode, deep: bool = False) -> dict:
    seen = set()
    for key_node, _ in node.value:
        key = loader.construct_object(key_node, deep=True)
        if not isinstance(key, str):
            problem = f"key {key!r}: expected a text as key"
            raise yaml.constructor.ConstructorError(None, None, problem, key_node.start_mark)
        if key in seen:
            problem = f"key {key!r} stands twice in one mapping"
            raise yaml.constructor.ConstructorError(None, None, problem, key_node.start_mark)
        seen.add(key)
    return yaml.SafeLoader.construct_mapping(loader, node, deep)


_Loader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _unique_mapping)
_Loader.add_constructor(INT, _decimal)


def text_of(values: dict) -> str:
    """YAML that `parsed` reads back as the same values; keys keep their order."""
    return yaml.dump(values, Dumper=_Dumper, sort_keys=False, allow_unicode=True)


def read_yaml(path: Path) -> dict:
    """Read the mapping that a YAML file holds.

    Raises
    ------
    ConfigError
        When there is no such file, it is not a file, too large, not UTF-8, not YAML, empty, no
        mapping, or holds a key twice.
    """
    try:
        text = _content(Path(path)).decode("utf-8")
    except UnicodeDecodeError as error:
        raise ConfigError(
            f"{path}: byte {error.start} is not UTF-8, expected a YAML file in UTF-8"
        ) from None
    values = parsed(text, str(path))
    if values is None:
        raise ConfigError(f"{path}: file is empty, expected a YAML mapping")
    if not isinstance(values, dict):
        raise ConfigError(
            f"{path}: holds a {type(values).__name__}, expected a YAML mapping of keys"
        )
    return values


def _content(path: Path) -> bytes:
    """All bytes of a regular file; a device or pipe might never end."""
    try:
        if path.is_dir():
            raise ConfigError(f"{path}: is a directory, expected a YAML file")
        if not path.exists():
            why = "is a link that leads to no file" if path.is_symlink() else "no such file"
            raise ConfigError(f"{path}: {why}")
        if not path.is_file():
            raise ConfigError(f"{path}: is no regular file, expected a YAML file")
        with open(path, "rb") as file:
            content = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror})") from None
    if len(content) > MOST_BYTES:
        raise ConfigError(f"{path}: is larger than {MOST_BYTES} bytes, expected a YAML file")
    return content


def parsed(text: str, file: str) -> Any:
    """Value of a YAML text; `file` is named in messages.

    Raises
    ------
    ConfigError
        When the text is not YAML, or holds a key twice.
    """
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f" line {mark.line + 1}, column {mark.column + 1}:" if mark else ""
        raise ConfigError(f"{file}:{where} {one_line(error.problem, 200)}") from None
    except MISREAD as error:
        reason = one_line(str(error), 200) or type(error).__name__
        raise ConfigError(f"{file}: not valid YAML ({reason})") from None
