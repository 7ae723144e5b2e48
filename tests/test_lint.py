"""House rules that no linter knows."""

import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.no_core

ROOT = Path(__file__).parents[1]
CORE = sorted((ROOT / "fortran").glob("*/*.f90"))
FACE = sorted((ROOT / "pywrap" / "face").glob("*.f90"))

# Statements of a program that a library has no right to: it says what is wrong by a code and
# words, and reads nothing that it was not handed. `write` to a character variable is allowed.
FORBIDDEN = re.compile(
    r"^(if\s*\(.*\)\s*)?("
    r"print\b(?!\s*=)|stop\b|error\s+stop\b|pause\b|call\s+(exit|abort)\b"
    r"|open\s*\(|read\s*\(\s*\*|write\s*\(\s*(\*|\d|unit\s*=|output_unit|error_unit)"
    r")"
)


def statements(path):
    """(line number, statement) without comments and without the text of strings, lower case."""
    for number, line in enumerate(path.read_text().splitlines(), start=1):
        code = re.sub(r"\"[^\"]*\"|'[^']*'", "''", line).split("!")[0].strip().lower()
        if code:
            yield number, code


def name_of(path):
    return str(path.relative_to(ROOT))


def test_there_is_fortran_to_look_at():
    assert CORE
    assert FACE


@pytest.mark.parametrize("path", CORE + FACE, ids=name_of)
def test_fortran_neither_prints_nor_stops_nor_opens_files(path):
    found = [f"line {n}: {code}" for n, code in statements(path) if FORBIDDEN.match(code)]
    assert not found


@pytest.mark.parametrize(
    ("statement", "forbidden"),
    [
        ("print *, x", True),
        ("stop", True),
        ("if (n < 0) error stop ''", True),
        ("if (any(x(2:) <= 0)) stop 1", True),
        ("open (newunit=unit, file=name)", True),
        ("write (*, *) x", True),
        ("write (error_unit, '(a)') text", True),
        ("write (text, '(i0)') step", False),
        ("stopped = .true.", False),
        ("printed = 3", False),
        ("opening = u(2) - u(1)", False),
    ],
)
def test_the_rule_itself_tells_statements_from_names(statement, forbidden):
    assert bool(FORBIDDEN.match(statement)) == forbidden


@pytest.mark.parametrize("path", CORE, ids=name_of)
def test_module_is_named_after_its_folder_and_file(path):
    modules = [code for _, code in statements(path) if re.match(r"module\s+(?!procedure)", code)]
    assert modules == [f"module lithofrac_{path.parent.name}_{path.stem}"]


@pytest.mark.parametrize("path", CORE + FACE, ids=name_of)
def test_module_opens_with_a_sentence_and_hides_what_it_does_not_offer(path):
    assert path.read_text().startswith("!> ")
    codes = [code for _, code in statements(path)]
    assert codes.count("implicit none") == 1
    assert "private" in codes
