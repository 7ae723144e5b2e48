"""The table of what is tested where (reports/reliability.md) says the truth."""

import re
from pathlib import Path

import pytest
from named_tests import marks_of, missing

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[2]
ROW = re.compile(r"^\| ([A-Z]\d+) \| (.+?) \|(?: (.+?))? \| (.+) \|$", re.MULTILINE)
ROWS = ROW.findall((ROOT / "reports" / "reliability.md").read_text())
NAMED = re.compile(r"`([^`]+)`( \(slow\))?")
COUNTS = {"E": 8, "M": 7, "C": 13, "F": 9, "Q": 4, "I": 8, "K": 6, "D": 3, "G": 2, "P": 1}


def test_every_item_of_the_suite_has_one_row():
    ids = [row[0] for row in ROWS]
    assert ids == [f"{letter}{i}" for letter, n in COUNTS.items() for i in range(1, n + 1)]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_tests_of_an_item_exist_and_are_run_when_the_table_says(row):
    named = NAMED.findall(row[3])
    assert named
    assert NAMED.sub("", row[3]).strip() == "", "nothing but tests stands in the column"
    for name, slow in named:
        assert not missing(f"tests/{name}", ROOT)
        file, _, test = name.partition("::")
        if not test:
            assert bool(slow) == all(marks_of(ROOT / "tests" / file).values()), f"{name}: slow?"
        if test:
            assert marks_of(ROOT / "tests" / file)[test] == bool(slow), f"{name}: slow or not?"


@pytest.mark.parametrize(
    ("named", "words"),
    [
        ("tests/test_nowhere.py", "no such file"),
        ("tests/conftest.py", "has no tests"),
        ("tests/test_lint.py::test_nothing", "no such test"),
        ("tests/test_lint.py::test_there_is_fortran_to_look_at", ""),
        ("tests/test_lint.py", ""),
    ],
)
def test_a_test_that_is_gone_is_told(named, words):
    assert words in missing(named, ROOT)
    assert bool(words) == bool(missing(named, ROOT))
