"""The theory page (reports/guide/theory.md): each equation has its place in the code."""

import re
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

pytestmark = pytest.mark.no_core

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "reports" / "guide" / "theory.md"
TEXT = PAGE.read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", TEXT, re.MULTILINE | re.DOTALL))
# [file.f90](path): `name`, `name`
PLACE = re.compile(r"\]\((?P<path>[^)]+\.(?:f90|py))\):\s+(?P<names>`\w+`(?:,\s+`\w+`)*)")
DEFINED = {
    ".f90": r"^\s*(?!end\b)[\w ()]*\b(?:subroutine|function)\s+{name}\b",
    ".py": r"^\s*def {name}\(",
}


def places(text):
    """(file, name of a procedure) that a text points at."""
    for found in PLACE.finditer(text):
        for name in re.findall(r"\w+", found["names"]):
            yield (PAGE.parent / found["path"]).resolve(), name


def formulas(text):
    """Displayed and inline formulas."""
    for token in MarkdownIt().parse(text):
        if token.type == "fence" and token.info.strip() == "math":
            yield token.content
        for child in token.children or ():
            if child.type == "text":
                yield from re.findall(r"\$(.+?)\$", child.content)


def test_every_named_procedure_is_in_its_file():
    found = list(places(TEXT))
    assert len(found) > 80
    for file, name in found:
        assert file.is_file(), file
        pattern = DEFINED[file.suffix].format(name=name)
        assert re.search(pattern, file.read_text(encoding="utf-8"), re.MULTILINE), f"{file}: {name}"


def test_no_source_file_is_named_without_a_procedure():
    named = re.findall(r"\]\([^)]+\.(?:f90|py)\)", TEXT)
    assert len(named) == len(list(PLACE.finditer(TEXT)))


@pytest.mark.parametrize("section", [name for name, text in SECTIONS.items() if "```math" in text])
def test_a_section_with_equations_says_where_they_are(section):
    assert "In the code:" in SECTIONS[section]
    assert list(places(SECTIONS[section]))


def test_every_equation_of_the_paper_has_its_section():
    rows = re.findall(r"^\| ([\d, ]+) \| \[(.+?)\]", TEXT, re.MULTILINE)
    listed = {int(number): section for numbers, section in rows for number in numbers.split(",")}
    assert sorted(listed) == list(range(1, 23))
    for number, section in listed.items():
        text = SECTIONS[section]
        ranges = re.findall(r"eqs?\.? (\d+)(?: and (\d+))?", text)
        numbers = {int(n) for found in ranges for n in found if n}
        assert number in numbers, f"eq. {number} is not in section {section}"


def test_formulas_are_whole_and_of_what_a_forge_renders():
    assert len(list(formulas(TEXT))) > 80
    for formula in formulas(TEXT):
        assert r"\operatorname" not in formula, formula  # GitHub refuses it
        bare = re.sub(r"\\[{}|]", "", formula)
        assert bare.count("{") == bare.count("}"), formula
        assert len(re.findall(r"\\left\b", formula)) == len(re.findall(r"\\right\b", formula))
        assert formula.count(r"\begin") == formula.count(r"\end"), formula


@pytest.mark.parametrize("page", sorted(PAGE.parent.glob("*.md")), ids=lambda page: page.name)
def test_inline_formulas_survive_markdown(page):
    """Markdown takes the backslash from punctuation and pairs of underscores for emphasis."""
    prose = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert all(line.count("$") % 2 == 0 for line in prose.splitlines())
    for formula in re.findall(r"\$(.+?)\$", prose):
        assert not re.search(r"\\[!-/:-@\[-`{-~]", formula), formula
