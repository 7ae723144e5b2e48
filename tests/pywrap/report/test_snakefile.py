"""The Snakefile reruns what an edit changes, and nothing else.

It is run on a copy of the tree with a stand-in for the command line that only makes the files.
"""

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from lithofrac.config import load_case, predicted
from lithofrac.meshed_cost import meshed_cost
from lithofrac.report import category_of, load_sheets
from lithofrac.report.captions import caption

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]
PARTS = ("Snakefile", "configs", "data", "reports", "fortran", "pywrap")
SUITE = """\
title: Three cases
cases:
  sandstone_triaxial_p00: {extends: cases/sandstone_triaxial.yaml}
  sandstone_triaxial_p10:
    extends: cases/sandstone_triaxial.yaml
    set: {loading.confinement_MPa: 10}
  sandstone_plane_strain_p00: {extends: cases/sandstone_plane_strain.yaml}
"""
STAND_IN = """\
#!/bin/sh
here=$(dirname "$0")
echo "$@" >> "$here/said"
if [ -e "$here/fails" ] && echo "$@" | grep -q "$(cat "$here/fails")"; then exit 4; fi
command=$1
while [ $# -gt 1 ]; do
  if [ "$1" = --out ]; then
    if [ $command = run ]; then
      mkdir -p "$2" && date +%N > "$2/summary.json" && touch "$2/history.parquet"
    elif [ $command = point ]; then
      mkdir -p "$2"
      for test in triaxial stiff_confinement; do
        for p in 00 01 02 05 10 15 20 30 40; do touch "$2/${test}_p$p.parquet"; done
      done
    else
      touch "$2"
    fi
  fi
  shift
done
"""


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """A copy of the tree in which everything has been made once."""
    root = tmp_path_factory.mktemp("tree")
    for part in PARTS:
        source = ROOT / part
        ignored = shutil.ignore_patterns("__pycache__", "*.so")
        if source.is_dir():
            shutil.copytree(source, root / part, ignore=ignored)
        else:
            shutil.copy(source, root / part)
    (root / "configs" / "three.yaml").write_text(SUITE)
    (root / "bin").mkdir()
    (root / "bin" / "lithofrac").write_text(STAND_IN)
    (root / "bin" / "lithofrac").chmod(0o755)
    done = snakemake(root, "--cores", "2")
    assert done.returncode == 0, done.stderr
    return root


def snakemake(root, *arguments, suite="three", **config):
    environment = dict(os.environ, PATH=f"{root / 'bin'}{os.pathsep}{os.environ['PATH']}")
    settings = [f"suite=configs/{suite}.yaml", *(f"{key}={value}" for key, value in config.items())]
    return subprocess.run(
        [sys.executable, "-m", "snakemake", "--config", *settings, *arguments],
        cwd=root, env=environment, capture_output=True, text=True, timeout=300,
    )  # fmt: skip


def planned(root, *targets, suite="three"):
    """Jobs of a dry run: rule -> count."""
    done = snakemake(root, "--dry-run", "--", *targets, suite=suite)
    assert done.returncode == 0, done.stderr
    return {rule: int(n) for rule, n in re.findall(r"^(\w+) +(\d+)$", done.stdout, re.MULTILINE)}


def edited(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_second_call_has_nothing_to_do(tree):
    assert planned(tree) == {}


def said_by(root):
    """Commands of the stand-in since the last call."""
    said = root / "bin" / "said"
    lines = said.read_text().splitlines() if said.exists() else []
    said.unlink(missing_ok=True)
    return lines


def runs_in(said):
    """Cases that were run, by name."""
    return sorted(line.split()[1] for line in said if line.startswith("run "))


def test_case_that_failed_is_not_hidden_by_the_figures_of_its_older_run(tree):
    suite = tree / "configs" / "three.yaml"
    edited(suite, "confinement_MPa: 10", "confinement_MPa: 12")
    (tree / "bin" / "fails").write_text("run sandstone_triaxial_p10")
    assert snakemake(tree, "--cores", "2").returncode != 0
    (tree / "bin" / "fails").unlink()
    assert planned(tree)["simulate"] == 1
    edited(suite, "confinement_MPa: 12", "confinement_MPa: 10")
    assert snakemake(tree, "--cores", "2").returncode == 0


def test_stopped_pipeline_goes_on_where_it_was(tree):
    """Of two cases one fails: the other is kept, and the next call runs the one alone."""
    path = tree / "configs" / "cases" / "sandstone_triaxial.yaml"
    edited(path, "end_strain: 0.025", "end_strain: 0.023")
    said_by(tree)
    (tree / "bin" / "fails").write_text("run sandstone_triaxial_p10")
    assert snakemake(tree, "--cores", "2", "--keep-going").returncode != 0
    (tree / "bin" / "fails").unlink()
    assert runs_in(said_by(tree)) == ["sandstone_triaxial_p00", "sandstone_triaxial_p10"]
    assert snakemake(tree, "--cores", "2").returncode == 0
    assert runs_in(said_by(tree)) == ["sandstone_triaxial_p10"]
    assert planned(tree) == {}
    edited(path, "end_strain: 0.023", "end_strain: 0.025")
    assert snakemake(tree, "--cores", "2").returncode == 0


def test_edit_of_a_case_in_the_suite_reruns_that_case_alone(tree):
    suite = tree / "configs" / "three.yaml"
    edited(suite, "confinement_MPa: 10", "confinement_MPa: 11")
    done = snakemake(tree, "--dry-run")
    assert re.findall(r"Mesh and run (\w+)", done.stdout) == ["sandstone_triaxial_p10"]
    edited(suite, "confinement_MPa: 11", "confinement_MPa: 10")
    assert planned(tree) == {}


def test_edit_of_a_case_file_reruns_the_cases_that_extend_it(tree):
    path = tree / "configs" / "cases" / "sandstone_triaxial.yaml"
    text = path.read_text()
    edited(path, "end_strain: 0.025", "end_strain: 0.024")
    assert planned(tree)["simulate"] == 2
    path.write_text("# a comment decides nothing\n" + text)
    assert planned(tree) == {}


def test_edit_of_a_plot_draws_again_and_runs_nothing(tree):
    path = tree / "pywrap" / "lithofrac" / "plots" / "energy.py"
    text = path.read_text()
    path.write_text(text + "\n")
    jobs = planned(tree)
    assert not {"simulate", "bench", "run_quick", "table"} & set(jobs)
    assert (jobs["plot_suite"], jobs["plot_run"]) == (1, 2)  # of the two scenes
    path.write_text(text)
    assert planned(tree) == {}


def test_edit_of_a_caption_or_a_sheet_writes_pages_and_draws_nothing(tree):
    for path in ("captions/energy.rst", "sheets/6_punch.md"):
        file = tree / "reports" / path
        text = file.read_text()
        file.write_text(text + "\n")
        jobs = planned(tree)
        assert set(jobs) <= {"page", "summary", "all", "total"}
        assert jobs["page"] >= 1
        file.write_text(text)


def test_new_digitised_curve_redraws_the_figures(tree):
    folder = tree / "data" / "klerck2004" / "digitised"
    (folder / "a.csv").write_text("1, 2\n")
    jobs = planned(tree)
    assert jobs["plot_suite"] == 1
    assert "simulate" not in jobs
    (folder / "a.csv").unlink()


def test_edit_of_the_core_reruns_everything(tree):
    path = next((tree / "fortran").rglob("*.f90"))
    text = path.read_text()
    path.write_text(text + "\n")
    assert planned(tree)["simulate"] == 3
    path.write_text(text)


def test_edit_of_an_analysis_makes_its_tables_again_and_runs_nothing(tree):
    path = tree / "pywrap" / "lithofrac" / "analysis" / "tables.py"
    text = path.read_text()
    path.write_text(text + "\n")
    jobs = planned(tree)
    assert jobs["table"] > 10
    assert not {"simulate", "bench"} & set(jobs)
    path.write_text(text)


@pytest.mark.parametrize("name", ["cli", "report/write", "config/reference", "intake"])
def test_edit_that_decides_no_result_runs_nothing(tree, name):
    path = tree / "pywrap" / "lithofrac" / f"{name}.py"
    text = path.read_text()
    path.write_text(text + "\n")
    assert not {"simulate", "bench", "table"} & set(planned(tree))
    path.write_text(text)


@pytest.mark.parametrize(
    ("output", "starts"),
    [
        ("out/runs/sandstone_triaxial_p00/summary.json", ("run", "scenes/make", "config/suite")),
        ("out/bench/sandstone/triaxial_p00.parquet", ("point",)),
    ],
)
def test_every_module_that_a_run_imports_makes_it_run_again(tree, output, starts):
    """Such an input is newer than the result once it is edited; no other module is one."""
    done = snakemake(tree, "--detailed-summary")
    assert done.returncode == 0, done.stderr
    header, *rows = (line.split("\t") for line in done.stdout.splitlines() if "\t" in line)
    (row,) = (row for row in rows if row[0] == output)
    inputs = row[header.index("input-file(s)")].split(",")
    package = tree / "pywrap" / "lithofrac"
    decide = imported_by(package, [package / f"{start}.py" for start in starts])
    assert {file for file in inputs if re.search(r"(?<!__init__)\.py$", file)} == {
        str(path.relative_to(tree)) for path in decide if path.name != "__init__.py"
    }
    assert {file for file in inputs if file.endswith(".f90")} == {
        str(path.relative_to(tree))
        for part in ("fortran", "pywrap/face")
        for path in (tree / part).rglob("*.f90")
    }


def imported_by(package, files):
    """Files of the package that some of its files import, directly or not, with those."""
    found, left = set(), list(files)
    while left:
        path = left.pop()
        if path in found:
            continue
        found.add(path)
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module, *(f"{node.module}.{name.name}" for name in node.names)]
            elif isinstance(node, ast.Import):
                names = [name.name for name in node.names]
            else:
                continue
            for name in names:
                top, *inside = name.split(".")
                for depth in range(len(inside) + 1):  # a package is imported before what is in it
                    here = package.joinpath(*inside[:depth])
                    files = (here / "__init__.py", here.with_suffix(".py"))
                    left += [file for file in files if top == package.name and file.is_file()]
    return found


def test_bad_suite_stops_before_any_job(tree):
    suite = tree / "configs" / "three.yaml"
    edited(suite, "confinement_MPa: 10", "confinment_MPa: 10")
    done = snakemake(tree, "--dry-run")
    assert done.returncode != 0
    assert "confinment_MPa" in done.stdout + done.stderr
    edited(suite, "confinment_MPa: 10", "confinement_MPa: 10")


def test_cracks_and_comparisons_are_drawn_where_the_suite_has_them_and_only_there(tree):
    text = (tree / "configs" / "three.yaml").read_text()
    more = """\
  sandstone_soft_p00: {extends: cases/sandstone_soft.yaml}
  punch_gf60: {extends: cases/punch.yaml}
  punch_discrete: {extends: cases/punch.yaml, set: {fracture.mode: inter_element}}
"""
    (tree / "configs" / "six.yaml").write_text(text + more)
    jobs = planned(tree, suite="six")
    assert (jobs["simulate"], jobs["plot_cracks"], jobs["plot_compared"]) == (3, 2, 4)
    assert not {"plot_cracks", "plot_compared"} & set(planned(tree))


def test_pages_are_filled_when_they_are_asked_for_and_only_then(tree):
    assert not (tree / "README.md").exists()  # the runs before have not touched it
    said_by(tree)
    done = snakemake(tree, "--cores", "2", "pages")
    assert done.returncode == 0, done.stderr
    assert (tree / "README.md").exists()
    names = ("sandstone", "stress_strain", "strength", "stiffness_sweep")
    shown = " ".join(f"out/gallery/{name}.png" for name in names)
    said = said_by(tree)
    made = said.index(f"gallery out {shown} --out reports/gallery")
    filled = [i for i, line in enumerate(said) if line.endswith(".md") and "reports/sheets" in line]
    assert filled
    assert min(filled) > made  # the sheets have links to what is in it


@pytest.mark.parametrize("suite", ["suite", "suite_quick"])
def test_every_figure_of_a_suite_stands_on_a_sheet_and_has_a_caption(tree, suite):
    done = snakemake(tree, "--dry-run", "--forceall", "--printshellcmds", suite=suite)
    assert done.returncode == 0, done.stderr
    figures = set(re.findall(r"out/figures/([\w.@-]+)\.(?:svg|png)", done.stdout))
    assert len(figures) > 20
    sheets = load_sheets(tree / "reports" / "sheets")
    for figure in figures:
        assert category_of(figure, sheets)
        words = caption(figure, tree / "reports" / "captions", tree / "out")
        assert "Source." in words
        assert "Units." in words


def test_report_has_a_category_for_each_scene(tree):
    done = snakemake(tree, "--report", "out/report.html")
    assert done.returncode == 0, done.stderr
    text = (tree / "out" / "report.html").read_text()
    for sheet in load_sheets(tree / "reports" / "sheets"):
        assert sheet.category in text


def test_regression_runs_the_quick_suite_and_fails_on_drift(tree):
    jobs = planned(tree, "regression")
    assert set(jobs) == {"run_quick", "regression", "total"}
    done = snakemake(tree, "--cores", "2", "regression")
    assert done.returncode == 0, done.stderr
    assert planned(tree, "regression") == {"regression": 1, "total": 1}
    (tree / "bin" / "fails").write_text("^compare ")
    assert snakemake(tree, "--cores", "2", "regression").returncode != 0
    (tree / "bin" / "fails").unlink()


def test_references_are_not_replaced_without_a_reason(tree):
    done = snakemake(tree, "--dry-run", "update_references")
    assert done.returncode != 0
    assert "no reason, expected --config why=" in done.stdout + done.stderr
    done = snakemake(tree, "--dry-run", "--printshellcmds", "update_references", why="it's finer")
    assert done.returncode == 0, done.stderr
    jobs = {rule: int(n) for rule, n in re.findall(r"^(\w+) +(\d+)$", done.stdout, re.MULTILINE)}
    assert jobs["portable"] == jobs["update_references"] == 1
    assert jobs["run_quick"] > 14  # the portable build, and more meshes of what cracks
    assert "PYTHONPATH=build/portable-site lithofrac run punch_discrete@seed2 " in done.stdout
    assert """--why 'it'"'"'s finer'""" in done.stdout


def test_stability_is_made_when_it_is_asked_for_and_only_then(tree):
    assert "make_stability" not in planned(tree)
    jobs = planned(tree, "stability")
    assert (jobs["make_stability"], jobs["plot_stability"], jobs["stability"]) == (1, 1, 1)
    assert not {"simulate", "page"} & set(jobs)


def test_speed_is_measured_when_it_is_asked_for_and_one_job_at_a_time(tree):
    assert "make_benchmark" not in planned(tree)
    jobs = planned(tree, "speed")
    made = ("make_benchmark", "make_leave_out", "make_growth", "table_speed", "plot_speed")
    assert [jobs[name] for name in made] == [1] * 5
    rules = (tree / "pywrap" / "rules" / "speed.smk").read_text(encoding="utf-8")
    assert rules.count("    threads: 64") == 4


def test_accuracy_is_made_when_it_is_asked_for_and_only_then(tree):
    assert "make_accuracy" not in planned(tree)
    jobs = planned(tree, "accuracy")
    assert (jobs["make_accuracy"], jobs["plot_accuracy"], jobs["accuracy"]) == (1, 1, 1)
    assert not {"simulate", "page"} & set(jobs)


def test_own_geometry_asks_for_what_its_mesh_takes(tree):
    """And for the fixed guess where gmsh cannot read it, as the run itself says why."""
    case = load_case(ROOT / "configs" / "examples" / "two_holes.yaml")
    assert meshed_cost(case, {}).group == "short" != predicted(case).group
    own = tree / "configs" / "own.yaml"
    own.write_text("title: One\ncases:\n  holes: {extends: examples/two_holes.yaml}\n")
    done = snakemake(tree, "--dry-run", suite="own")
    assert "Group job short" in done.stdout, done.stdout + done.stderr
    (tree / "configs" / "examples" / "two_holes.geo").write_text("Point(1) = {0, 0\n")
    done = snakemake(tree, "--dry-run", suite="own")
    assert done.returncode == 0, done.stderr
    assert "Mesh and run holes" in done.stdout
    assert "Group job short" not in done.stdout
