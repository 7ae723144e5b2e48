"""One clear sentence per mistake: file, key, value, and what was expected there.

pydantic finds the mistakes; this module puts them into words, all at once, one per line.
"""

import difflib
from collections.abc import Callable
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

MOST_SENTENCES = 50  # of one file; nobody reads more
MOST_KNOWN = 1400  # characters of a list of what there is; quantities of a study take most


class ConfigError(ValueError):
    """Bad input; the message holds one sentence per mistake, one per line."""


def one_line(text: object, most: int = 60) -> str:
    """A text of anybody's as part of a sentence: on one line, not endless, nothing unprintable."""
    line = printable(" ".join(str(text).split())[: 2 * most])
    return line if len(line) <= most else f"{line[: most - 3]}..."


def printable(text: str) -> str:
    """The text with codes for what a terminal does not show, or obeys."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def sentences(
    error: ValidationError, model: type[BaseModel], file_of: Callable[[tuple], str]
) -> ConfigError:
    """Put a pydantic error into words.

    Parameters
    ----------
    error : what validation raised
    model : the model that was validated
    file_of : gives the file a key was read from, by the key's path
    """
    lines = []
    found = error.errors(include_url=False)
    for item in found[:MOST_SENTENCES]:
        keys, section = _path(model, item["loc"])
        said = _sentence(".".join(map(one_line, keys)), item, section)
        for line in said.split("\n"):
            named = keys or tuple(line.split(" ")[0].rstrip(":").split("."))
            lines.append(f"{file_of(named)}: {line}")
    if len(found) > MOST_SENTENCES:
        lines.append(f"{file_of(())}: and {len(found) - MOST_SENTENCES} more mistakes")
    return ConfigError("\n".join(dict.fromkeys(lines)))


def suggestion(word: str, known: list[str]) -> str:
    """What to use instead of an unknown word: the nearest one, or the whole list."""
    near = difflib.get_close_matches(str(word)[:100], known, n=1, cutoff=0.6)
    if near:
        return f"did you mean '{one_line(near[0])}'?"
    words = ", ".join(one_line(one) for one in sorted(known))
    return f"expected one of: {one_line(words, MOST_KNOWN)}"


def _sentence(key: str, item: dict, section: type[BaseModel] | None) -> str:
    kind, context = item["type"], item.get("ctx", {})
    if kind == "extra_forbidden":
        known = list(section.model_fields) if section else []
        return f"{key}: unknown key, {suggestion(item['loc'][-1], known)}"
    if kind == "missing":
        return f"{key}: missing key, expected {_expected_type(section, item['loc'][-1])}"
    if kind == "union_tag_not_found":
        return f"{key}.kind: missing key, expected a text"
    if kind == "union_tag_invalid":
        known = [word.strip().strip("'") for word in context["expected_tags"].split(",")]
        tag = context["tag"]
        return f"{key}.kind = {one_line(tag)}: unknown kind, {suggestion(tag, known)}"
    if kind == "value_error":
        return f"{key}: {context['error']}" if key else str(context["error"])
    value = item["input"]
    shown = f"{key} = {one_line(value)}" if isinstance(value, (bool, int, float, str)) else key
    if kind == "literal_error" and isinstance(value, str):
        return f"{shown}: unknown word, {suggestion(value, _words(context['expected']))}"
    field = section.model_fields.get(item["loc"][-1]) if section and item["loc"] else None
    span = _range(field.annotation, field.metadata) if field and kind in BOUNDS else ""
    return f"{shown}: expected {span or _expected(kind, context)}"


BOUNDS = {
    "greater_than": ("above", "gt"),
    "greater_than_equal": ("not below", "ge"),
    "less_than": ("below", "lt"),
    "less_than_equal": ("not above", "le"),
}  # pydantic's kind of error -> words, name of the bound


def _range(annotation: Any, metadata: list) -> str:
    """Words for the range of a number, from the bounds of its field; empty when it has none."""
    if get_origin(annotation) in (Union, UnionType):
        inner = [part for part in get_args(annotation) if part is not type(None)]
        return _range(inner[0], metadata)
    if get_origin(annotation) is Annotated:
        annotation, *more = get_args(annotation)
        metadata = [*metadata, *more]
    flat = [item for entry in metadata for item in getattr(entry, "metadata", [entry])]
    bounds = {
        name: getattr(item, name)
        for item in flat for _, name in BOUNDS.values() if hasattr(item, name)
    }  # fmt: skip
    what = "a whole number" if annotation is int else "a number"
    if set(bounds) == {"ge", "le"}:
        return f"{what} from {_shown(bounds['ge'])} to {_shown(bounds['le'])}"
    words = [f"{word} {_shown(bounds[name])}" for word, name in BOUNDS.values() if name in bounds]
    return f"{what} {' and '.join(words)}" if words else ""


def _shown(bound: Any) -> str:
    return f"{bound:g}" if isinstance(bound, float) else str(bound)


def _words(expected: str) -> list[str]:
    return [word.strip().strip("'") for word in expected.replace(" or ", ",").split(",")]


def _expected(kind: str, context: dict) -> str:
    """What a value had to be, from pydantic's kind of error."""
    plain = {
        "finite_number": "a finite number",
        "float_type": "a number",
        "int_type": "a whole number",
        "int_from_float": "a whole number",
        "string_type": "a text",
        "bool_type": "true or false",
        "date_type": "a date, as in 2026-01-31",
        "tuple_type": "a list",
        "list_type": "a list",
        "dict_type": "a mapping of keys",
        "model_type": "a mapping of keys",
        "model_attributes_type": "a mapping of keys",
        "string_pattern_mismatch": "a name of letters, digits and any of _ . -",
    }
    if kind in plain:
        return plain[kind]
    bounds = {
        **{kind: (f"a number {words}", name) for kind, (words, name) in BOUNDS.items()},
        "too_short": ("at least this many items:", "min_length"),
        "too_long": ("at most this many items:", "max_length"),
        "string_too_short": ("a text of at least this many letters:", "min_length"),
        "literal_error": ("one of", "expected"),
    }
    if kind in bounds:
        words, name = bounds[kind]
        return f"{words} {_shown(context[name])}"
    return kind.replace("_", " ")


def _expected_type(section: type[BaseModel] | None, name: Any) -> str:
    field = section.model_fields.get(name) if section else None
    if field is None:
        return "a value"
    return _type_words(field.annotation)


def _type_words(annotation: Any) -> str:
    words = {float: "a number", int: "a whole number", str: "a text", bool: "true or false"}
    if annotation in words:
        return words[annotation]
    origin = get_origin(annotation)
    if origin is Literal:
        return "one of: " + ", ".join(map(str, get_args(annotation)))
    if origin is tuple:
        return "a list"
    if origin in (Union, UnionType):
        options = {_type_words(part) for part in get_args(annotation) if part is not type(None)}
        return " or ".join(sorted(options))
    if origin is Annotated:
        return _type_words(get_args(annotation)[0])
    return getattr(annotation, "expected", "a mapping of keys")


def _path(model: type[BaseModel], location: tuple) -> tuple[tuple, type[BaseModel] | None]:
    """Path of keys as written in the file, and the section that holds the last key.

    pydantic puts the name of the chosen member of a union into the location; it is left out.
    """
    keys: list = []
    here: type[BaseModel] | None = model  # section that the next step is a key of
    holder = here  # section that holds the last key
    choices: dict[str, type[BaseModel]] = {}  # members of the union just entered
    inside = False  # the last key was that of a mapping or list of sections
    for step in location:
        if step in choices and not inside:
            here, choices = choices[step], {}
            continue
        keys.append(step)
        holder = here
        if inside:
            here, inside = next(iter(choices.values()), None), False
            continue
        field = here.model_fields.get(step) if here is not None else None
        choices = _members(field.annotation) if field else {}
        inside = field is not None and get_origin(field.annotation) in (dict, tuple)
        here = next(iter(choices.values())) if len(choices) == 1 and not inside else None
    return tuple(keys), holder


def _members(annotation: Any) -> dict[str, type[BaseModel]]:
    """Models that an annotation names, by their `kind` or class name."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        kind = annotation.model_fields.get("kind")
        tag = get_args(kind.annotation)[0] if kind else annotation.__name__
        return {tag: annotation}
    found: dict[str, type[BaseModel]] = {}
    if get_origin(annotation) in (Union, UnionType, Annotated, dict, tuple):
        for part in get_args(annotation):
            found.update(_members(part))
    return found
