"""Mutants: the list fits the code, the report the list, and nothing passes by accident."""

import re
import subprocess
from pathlib import Path

import mutation
import pytest
from mutation import Edit, Mutant, MutationError, Outcome

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[2]
LINE = Mutant("one", "a sign", (Edit("a.f90", "x = y", "x = -y"),), ("test_a.py",))


@pytest.fixture
def tree(tmp_path):
    (tmp_path / "a.f90").write_text("x = y\nz = 1\n")
    (tmp_path / "test_a.py").write_text("def test_it():\n    pass\n")
    return tmp_path


def test_every_mutant_fits_the_code_and_names_tests_that_exist():
    assert mutation.misfits(mutation.load()) == []


def test_there_are_enough_mutants_in_every_part_of_the_core():
    files = [edit.file for mutant in mutation.load() for edit in mutant.edits]
    for part in ("contact", "fracture", "material", "mechanics", "mesh", "run"):
        assert sum(file.startswith(f"fortran/{part}/") for file in files) >= 2, part
    assert sum(file.startswith("pywrap/lithofrac/") for file in files) >= 2
    assert len(mutation.load()) >= 18


def test_the_report_is_of_this_list_and_all_were_caught():
    text = mutation.TABLE.read_text()
    rows = re.findall(r"^\| ([\w-]+) \| .* \| (.+) \| \d+ \|$", text, re.MULTILINE)
    names = [mutant.name for mutant in mutation.load()]
    assert [name for name, _ in rows] == names, "run python3 tasks.py mutants again"
    assert not [name for name, by in rows if not by.startswith("`")], "one was not caught"


@pytest.mark.parametrize(
    ("text", "count"), [("x = 2*y\n", 0), ("x = y\nx = y\n", 2)], ids=["gone", "twice"]
)
def test_old_text_that_does_not_stand_once_is_refused_in_words(tree, text, count):
    assert mutation.misfits([LINE], tree) == []
    (tree / "a.f90").write_text(text)
    assert mutation.misfits([LINE], tree) == [
        f"mutant one: its old text stands {count} times in a.f90, expected once: 'x = y'"
    ]


def test_mutants_without_tests_or_without_a_change_are_refused(tree):
    same = Mutant("same", "", (Edit("a.f90", "x = y", "x = y"),), ("test_a.py::test_gone",))
    assert mutation.misfits([same], tree) == [
        "mutant same: it changes nothing",
        "mutant same: test_a.py::test_gone: the file has no such test",
    ]
    assert mutation.misfits([Mutant("bare", "", LINE.edits, ())], tree) == [
        "mutant bare: no test is named"
    ]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("- {name: a, breaks: b, edits: []}", "expected just name, breaks, edits and tests"),
        ("[{name: control, breaks: b, edits: [], tests: []}]", "another one of this name"),
    ],
)
def test_a_list_that_makes_no_sense_is_refused(tmp_path, text, words):
    (tmp_path / "list.yaml").write_text(text)
    with pytest.raises(MutationError, match=words):
        mutation.load(tmp_path / "list.yaml")


def test_edits_are_made_and_taken_back(tree):
    before = (tree / "a.f90").read_text()
    two = Mutant("two", "", (*LINE.edits, Edit("a.f90", "z = 1", "z = 2")), ())
    take_back = mutation.mutate(two, tree)
    assert (tree / "a.f90").read_text() == "x = -y\nz = 2\n"
    take_back()
    assert (tree / "a.f90").read_text() == before


@pytest.mark.parametrize(
    ("code", "words", "caught", "by"),
    [
        (0, "1 passed", False, "survives"),
        (1, "FAILED tests/a.py::test_b[c] - assert 1 < 0\n", True, "tests/a.py::test_b[c]"),
        (1, "ERROR tests/a.py::test_b - RuntimeError\n", True, "tests/a.py::test_b"),
        (-11, "", True, "the process ends with signal 11"),
        (2, "ERROR tests/a.py\n", False, "its tests do not run"),
        (4, "not found: tests/a.py", False, "its tests do not run"),
        (5, "no tests ran", False, "its tests do not run"),
    ],
)
def test_only_a_test_that_fails_counts_as_caught(code, words, caught, by):
    found, said = mutation.verdict(code, words)
    assert found == caught
    assert said.startswith(by)


def test_a_copy_follows_the_tree_and_leaves_equal_files_alone(tree, tmp_path_factory):
    subprocess.run(["git", "init", "-q"], cwd=tree, check=True)
    lane = mutation.Lane(tmp_path_factory.mktemp("lane"))
    lane.prepare(tree)
    times = {path.name: path.stat().st_mtime_ns for path in lane.tree.iterdir()}
    assert set(times) == {"a.f90", "test_a.py"}
    (tree / "test_a.py").unlink()
    (tree / "b.f90").write_text("new\n")
    lane.prepare(tree)
    assert {path.name for path in lane.tree.iterdir()} == {"a.f90", "b.f90"}
    assert (lane.tree / "a.f90").stat().st_mtime_ns == times["a.f90"]


def test_the_report_says_who_was_caught_by_what_and_who_was_not():
    control = Outcome(Mutant("control", "", (), ()), False, "9 passed in 1.0s", 1.0)
    outcomes = [
        control,
        Outcome(LINE, True, "tests/test_a.py::test_it", 2.0),
        Outcome(LINE, False, "survives", 3.0),
    ]
    text = mutation.table(outcomes, "abc1234", 90.0, 120.0, 2)
    assert "- Commit: abc1234" in text
    assert "- Caught: 1 of 2" in text
    assert "1.5 minutes, 2 at a time; of processors 2.0 minutes" in text
    assert "9 passed in 1.0s" in text
    assert "| one | `a.f90` | a sign | `test_a.py::test_it` | 2 |" in text
    assert "| one | `a.f90` | a sign | **nothing: survives** | 3 |" in text


def test_an_unknown_mutant_is_refused_before_anything_is_built(capsys):
    assert mutation.main(["no-such"]) == 2
    assert "mutant no-such: no such one" in capsys.readouterr().err
