"""The Snakefile reruns what an edit changes, and nothing else.

It is run on a copy of the tree with a stand-in for the command line that only makes the files.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

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
command=$1
while [ $# -gt 1 ]; do
  if [ "$1" = --out ]; then
    if [ $command = run ]; then
      mkdir -p "$2" && touch "$2/summary.json" "$2/history.parquet"
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


def snakemake(root, *arguments, suite="three"):
    environment = dict(os.environ, PATH=f"{root / 'bin'}{os.pathsep}{os.environ['PATH']}")
    return subprocess.run(
        [sys.executable, "-m", "snakemake", "--config", f"suite=configs/{suite}.yaml", *arguments],
        cwd=root, env=environment, capture_output=True, text=True, timeout=300,
    )  # fmt: skip


def planned(root, suite="three"):
    """Jobs of a dry run: rule -> count."""
    done = snakemake(root, "--dry-run", suite=suite)
    assert done.returncode == 0, done.stderr
    return {rule: int(n) for rule, n in re.findall(r"^(\w+) +(\d+)$", done.stdout, re.MULTILINE)}


def edited(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_second_call_has_nothing_to_do(tree):
    assert planned(tree) == {}


def test_edit_of_a_case_in_the_suite_reruns_that_case_alone(tree):
    suite = tree / "configs" / "three.yaml"
    edited(suite, "confinement_MPa: 10", "confinement_MPa: 11")
    assert planned(tree)["simulate"] == 1
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
    assert not {"simulate", "bench"} & set(jobs)
    assert jobs["plot_suite"] == 1
    path.write_text(text)


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
    jobs = planned(tree, "six")
    assert (jobs["simulate"], jobs["plot_cracks"], jobs["plot_compared"]) == (3, 2, 4)
    assert not {"plot_cracks", "plot_compared"} & set(planned(tree))


def test_pages_are_filled_when_they_are_asked_for_and_only_then(tree):
    picture = tree / "reports" / "gallery" / "sandstone.png"
    picture.unlink(missing_ok=True)
    assert not (tree / "README.md").exists()  # the runs before have not touched it
    done = snakemake(tree, "--cores", "2", "pages")
    assert done.returncode == 0, done.stderr
    assert (tree / "README.md").exists()
    assert picture.exists()
