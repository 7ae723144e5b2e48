"""What `snakemake --lint` says of our rules, and why it is left so; anything else is a mistake."""

import json
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]

# Start of a warning -> why it stays, and the rules or files that it may name (None: all).
LEFT = {
    "Specify a conda environment or container": (
        "one environment serves all rules, that of requirements.txt or of whoever called pip",
        None,
    ),
    "Shell command directly uses variable": (
        "OUT and the suites are words of the whole workflow, which also stand in each path; as "
        "params of a rule they would say nothing that its files do not",
        None,
    ),
    "No log directive defined": (
        "asked for by name by somebody who reads what they say; they write to the tree",
        {"pages", "portable", "regression", "update_references", "stability", "speed", "accuracy"},
    ),
    "Mixed rules and functions": (
        "a function of a few lines stands in the file of the rules that it serves",
        {"Snakefile", "regression.smk", "study.smk"},
    ),
}


def lints(*words):
    """Warnings of the linter: title -> names of the rules or files that it names."""
    done = subprocess.run(
        [sys.executable, "-m", "snakemake", *words, "--lint"],
        cwd=ROOT, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    found, where = defaultdict(set), None
    for line in (done.stdout + done.stderr).splitlines():
        head = re.match(r"Lints for (?:rule (\w+) |snakefile (\S+):)", line)
        where = (head[1] or Path(head[2]).name) if head else where
        if line.startswith("    * "):
            found[line.removeprefix("    * ")].add(where)
    assert found, done.stderr
    return found


def unknown(found):
    """Warnings that `LEFT` has no reason for."""
    wrong = []
    for title, places in found.items():
        known = next((LEFT[start][1] for start in LEFT if title.startswith(start)), set())
        wrong += [
            f"{place}: {title}" for place in places if known is not None and place not in known
        ]
    return wrong


def test_suite_has_no_warning_beyond_those_with_a_reason():
    found = lints()
    assert unknown(found) == []
    used = {start for start in LEFT for title in found if title.startswith(start)}
    assert used == set(LEFT), "a reason without a warning"


def test_study_has_no_warning_beyond_those_with_a_reason(tmp_path):
    jobs = {"cases": [], "core": "", "costs": {}}
    (tmp_path / "jobs.json").write_text(json.dumps(jobs))
    rules = ROOT / "pywrap" / "rules" / "study.smk"
    assert unknown(lints("--snakefile", str(rules), "--directory", str(tmp_path))) == []


def test_a_new_warning_is_found():
    assert unknown({"Absolute path": {"Snakefile"}, "No log directive defined:": {"simulate"}}) == [
        "Snakefile: Absolute path",
        "simulate: No log directive defined:",
    ]
