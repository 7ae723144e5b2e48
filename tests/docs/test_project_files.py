"""Version, licence and citation say the same wherever they stand."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

import lithofrac

pytestmark = pytest.mark.no_core

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text())


def test_one_version():
    changes = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    meson = re.search(r"version: '([^']+)'", (ROOT / "meson.build").read_text())
    versions = {PROJECT["version"], CITATION["version"], changes[1], meson[1]}
    assert versions == {lithofrac.__version__}


def test_one_licence():
    assert (ROOT / "LICENSE").read_text().startswith("BSD 3-Clause License\n")
    meson = re.search(r"license: '([^']+)'", (ROOT / "meson.build").read_text())
    assert {PROJECT["license"], CITATION["license"], meson[1]} == {"BSD-3-Clause"}


def test_citation_has_what_the_format_asks_for():
    """Citation File Format 1.2.0: required keys, and those of the paper as it is cited."""
    assert {"cff-version", "message", "title", "authors"} <= CITATION.keys()
    assert CITATION["cff-version"] == "1.2.0"
    (paper,) = CITATION["references"]
    assert {"type", "title", "authors", "journal", "volume", "start", "end", "year"} <= paper.keys()


def test_citation_is_dated_by_the_release_alone():
    """Unreleased: no date, no DOI. A release adds both dates at once."""
    released = re.search(r"^## \S+ - (\S+)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[1]
    assert str(CITATION.get("date-released", "unreleased")) == released
    assert "doi" not in CITATION or released != "unreleased"


def test_changes_have_the_headings_of_their_format():
    text = (ROOT / "CHANGELOG.md").read_text()
    known = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    assert set(re.findall(r"^### (.+)$", text, re.MULTILINE)) <= known
    assert all(re.match(r"\d+\.\d+\.\d+ - (unreleased|\d{4}-\d{2}-\d{2})$", head)
               for head in re.findall(r"^## (.+)$", text, re.MULTILINE))  # fmt: skip
