"""The page of all keys (pywrap/lithofrac/config/reference.py)."""

import re
from pathlib import Path

import pytest

from lithofrac.config.reference import FILES, page

pytestmark = pytest.mark.no_core

WRITTEN = Path("reports/guide/reference.md")
ROW = re.compile(r"^\| `(\w+)` \| (.*) \| (.*) \| (.*) \|$", re.MULTILINE)


def test_the_page_is_that_of_the_models():
    command = f"python -m lithofrac.config.reference {WRITTEN}"
    assert WRITTEN.read_text(encoding="utf-8") == page(), command


def test_every_key_is_on_the_page():
    rows = {found[1] for found in ROW.finditer(page())}
    for _, model, _ in FILES:
        schema = model.model_json_schema()
        for part in (schema, *schema.get("$defs", {}).values()):
            assert set(part["properties"]) - {"kind"} <= rows


def test_every_key_says_what_it_is():
    for key, value, default, meaning in ROW.findall(page()):
        assert value and default, key
        assert meaning, f"{key} has no docstring in its model"


@pytest.mark.parametrize(
    "row",
    [
        "| `poisson_ratio` | number, 0 or more and below 0.5 | *needed* |",
        "| `hardening` | `compressive`, `total` | `compressive` |",
        "| `confinement_MPa` | number, 0 to 1e6 | `0.0` |",
        "| `structured` | `true`, `false` | `false` |",
        "| `plastic_strain` | list of: number, 0 to 1000 | left out |",
        "| `material` | [material](#material-file) | *needed* |",
    ],
)
def test_rows_say_value_and_default(row):
    assert row in page()
