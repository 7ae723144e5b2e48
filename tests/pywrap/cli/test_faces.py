"""Help, version, start-up time and exit codes of the words themselves (pywrap/lithofrac/cli.py)."""

import os
import re
import subprocess
import sys

import pytest

import lithofrac
from lithofrac._build import NATIVE
from lithofrac.arguments import KINDS
from lithofrac.cli import COMMANDS, main
from lithofrac.plots.draw import FIGURES, MOVIES, TABLES

pytestmark = pytest.mark.no_core
KIND_COLUMN = 15  # of the help of plot; before it stands what a kind is drawn of


def words(*arguments) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "lithofrac", *arguments], capture_output=True, text=True
    )


def test_help_fits_a_screen():
    said = words("--help").stdout.splitlines()
    assert len(said) <= 24
    assert max(map(len, said)) <= 80
    assert any(line.startswith("example: lithofrac run") for line in said)
    listed = [line.split()[0] for line in said if line.startswith("  ")]
    assert listed == list(COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_shows_an_example_in_lines_that_fit(command, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit) as left:
        main([command, "--help"])
    assert left.value.code == 0
    said = capsys.readouterr().out
    assert f"example: lithofrac {command}" in said
    assert max(map(len, said.splitlines())) <= 80


def test_help_of_plot_lists_each_kind_where_it_belongs():
    groups = re.split(r"(?m)^\w+ \(.*\)\n", KINDS)[1:]
    for group, known in zip(groups, (FIGURES, TABLES, MOVIES), strict=True):
        listed = " ".join(line[KIND_COLUMN:] for line in group.splitlines()).split()
        assert sorted(listed) == sorted(known)


def test_version_says_how_the_core_was_built():
    done = words("--version")
    native = str(NATIVE).lower()
    said = f"lithofrac {lithofrac.__version__}, native: {native}\n"
    assert (done.returncode, done.stdout) == (0, said)


@pytest.mark.parametrize("arguments", [[], ["rum"], ["run"], ["run", "kirsch", "--threads", "0"]])
def test_wrong_words_exit_with_2_and_no_traceback(arguments):
    done = words(*arguments)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("lithofrac")
    assert "Traceback" not in done.stderr


def test_the_package_and_its_words_are_imported_quickly():
    # least of three: a busy machine is not what is measured
    script = (
        "import time; t = time.perf_counter(); import lithofrac.cli;print(time.perf_counter() - t)"
    )
    times = [
        float(subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout)
        for _ in range(3)
    ]
    assert min(times) < 0.3


@pytest.mark.parametrize(
    "arguments", [["--help"], ["check", "--suite", "configs/suite_quick.yaml"]]
)
def test_a_reader_that_has_gone_is_no_error(arguments):
    """As of `lithofrac check | head -1`; output is buffered, as it is in a pipe by default."""
    read, write = os.pipe()
    os.close(read)
    buffered = {key: value for key, value in os.environ.items() if key != "PYTHONUNBUFFERED"}
    done = subprocess.run(
        [sys.executable, "-m", "lithofrac", *arguments],
        stdout=write, stderr=subprocess.PIPE, text=True, env=buffered,
    )  # fmt: skip
    os.close(write)
    assert (done.returncode, done.stderr) == (0, "")


def test_check_of_the_suite_names_every_case(capsys):
    assert main(["check", "--suite", "configs/suite_quick.yaml"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("single_element_quartzite: ")
    assert said[-1] == f"{len(said) - 1} cases are right"


def test_a_mesh_is_saved_where_it_is_wanted(tmp_path, capsys):
    from lithofrac.problem import Mesh

    out = tmp_path / "new" / "mesh.npz"
    assert main(["mesh", "kirsch", "--out", str(out), "--seed", "2"]) == 0
    made = Mesh.load(out)
    assert capsys.readouterr().out == (
        f"{out}: {len(made.triangles)} elements, {len(made.nodes)} nodes\n"
    )
