"""The keys of all config files as a Markdown page, generated from the models for the user guide.

`python -m lithofrac.config.reference reports/guide/reference.md` writes it; a test fails when it is
stale.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from lithofrac.config.case import Case
from lithofrac.config.material import Material
from lithofrac.config.study import Study
from lithofrac.config.suite import Suite

HEAD = """\
# Reference

Every key of every file, made from the program by `python -m lithofrac.config.reference`; do not
edit this page.

Units stand at the end of a key: `_mm`, `_MPa`, `_GPa`, `_m_s`, `_kg_m3`, `_J_m2`, `_deg`, `_1_s`;
a key without one is a number without a unit. *Needed* keys have no default; a file that extends
another one may take them from there. Keys of a block stand in it, or on the command line with
dots: `--set loading.end_strain=0.01`.
"""
FILES = (
    ("Case file", Case, "Any case may begin with `extends:`, the file that gives all other keys."),
    ("Material file", Material, "Also the block `material:` of a case."),
    ("Suite file", Suite, "As `configs/suite.yaml`."),
    ("Study file", Study, "Read by `lithofrac study`."),
)
LIMITS = {
    "minimum": "{} or more",
    "exclusiveMinimum": "above {}",
    "maximum": "up to {}",
    "exclusiveMaximum": "below {}",
}
OWN_PAGES = {"Material": "[material](#material-file)"}  # described once


def page() -> str:
    """The whole page."""
    parts = [HEAD]
    for title, model, more in FILES:
        schema = model.model_json_schema()
        walk = _Sections(schema.get("$defs", {}))
        parts += [f"## {title}\n", f"{_flat(schema['description'])} {more}\n", walk.table(schema)]
        parts += walk.below(schema, ())
    return "\n".join(parts)


class _Sections:
    """Sections of one file, each a heading and a table."""

    def __init__(self, models: dict) -> None:
        self.models = models

    def below(self, schema: dict, path: tuple[str, ...]) -> Iterator[str]:
        """Headings, texts and tables of all that stands under a section, in the order of keys."""
        for key, prop in schema["properties"].items():
            for names, model in self._models(prop):
                here = (*path, key, *names)
                if model in OWN_PAGES:
                    continue
                inner = self.models[model]
                kind = inner["properties"].get("kind", {}).get("const")
                if kind is None or self._is_first(prop, model):
                    yield f"### {'.'.join(here)}\n"
                if kind is not None and self._is_first(prop, model):
                    yield "A block of one of these kinds.\n"
                if kind is not None:
                    yield f"#### {'.'.join(here)}, kind: {kind}\n"
                yield f"{_flat(inner['description'])}\n"
                yield self.table(inner)
                yield from self.below(inner, here)

    def table(self, schema: dict) -> str:
        """Rows of the keys of one section."""
        rows = ["| key | value | default | meaning |", "|---|---|---|---|"]
        needed = schema.get("required", ())
        for key, prop in schema["properties"].items():
            if "const" in prop:
                continue
            said = [self._value(prop), _default(prop, key in needed), self._meaning(prop)]
            rows.append(f"| `{key}` | {' | '.join(_cell(words) for words in said)} |")
        return "\n".join(rows) + "\n"

    def _value(self, prop: dict) -> str:
        """What may stand behind a key."""
        if "$ref" in prop:
            model = _model_of(prop)
            return OWN_PAGES.get(model, "block")
        if "oneOf" in prop:
            return "block of one kind"
        if "anyOf" in prop:
            told = [self._value(one) for one in prop["anyOf"] if one.get("type") != "null"]
            return " or ".join(dict.fromkeys(told))
        if "enum" in prop or "const" in prop:
            return ", ".join(f"`{value}`" for value in prop.get("enum", [prop.get("const")]))
        return self._of_type(prop)

    def _of_type(self, prop: dict) -> str:
        kind = prop.get("type")
        if kind == "array":
            return f"list of: {self._value(prop['items'])}" if prop.get("items") else "list"
        if kind == "object":
            inside = _inside(prop)
            return f"names, each with: {self._value(inside)}" if inside else "keys and values"
        words = {"number": "number", "integer": "whole number", "string": "text"}
        if kind in ("number", "integer"):
            return f"{words[kind]}{_range(prop)}"
        return words.get(kind, "`true`, `false`" if kind == "boolean" else "any")

    def _meaning(self, prop: dict) -> str:
        """Sentence about a key, or the first one about what stands below it."""
        if "description" in prop:
            return _flat(prop["description"])
        models = [model for _, model in self._models(prop) if model not in OWN_PAGES]
        if len(models) == 1:
            return _flat(self.models[models[0]]["description"].split("\n\n")[0])
        return ""

    def _models(self, prop: dict) -> Iterator[tuple[tuple[str, ...], str]]:
        """Models under a key, with the names that stand between: ("NAME",) in a mapping."""
        if not prop:
            return
        if "$ref" in prop:
            yield (), _model_of(prop)
        for one in (*prop.get("oneOf", ()), *prop.get("anyOf", ())):
            yield from self._models(one)
        for names, model in self._models(_inside(prop)):
            yield ("NAME", *names), model

    def _is_first(self, prop: dict, model: str) -> bool:
        return next(self._models(prop))[1] == model


def _inside(prop: dict) -> dict:
    """Schema of what stands behind any name of a mapping; empty where that is open."""
    named = [prop.get("additionalProperties"), *prop.get("patternProperties", {}).values()]
    return next((one for one in named if isinstance(one, dict)), {})


def _model_of(prop: dict) -> str:
    return prop["$ref"].rsplit("/", 1)[-1]


def _range(prop: dict) -> str:
    """Limits of a number in words."""
    said = {key: _number(prop[key]) for key in LIMITS if key in prop}
    if "minimum" in said and "maximum" in said:
        return f", {said['minimum']} to {said['maximum']}"
    told = [LIMITS[key].format(number) for key, number in said.items()]
    return f", {' and '.join(told)}" if told else ""


def _number(value: float) -> str:
    """Shortest form; whole numbers of the schema in all their digits."""
    return str(value) if isinstance(value, int) else re.sub(r"e([+-])0*", _power, f"{value:g}")


def _power(found: re.Match) -> str:
    return "e" + found[1].replace("+", "")


def _default(prop: dict, needed: bool) -> str:
    value = prop.get("default")
    if needed:
        return "*needed*"
    if value is None:
        return "left out"
    if isinstance(value, (dict, list)) and value:
        return "as below"
    if value in ("", {}, []):
        return "none"
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


def _flat(text: str) -> str:
    """A docstring as one line."""
    return " ".join(text.split())


def _cell(words: str) -> str:
    return words.replace("|", "\\|")


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page(), encoding="utf-8")
