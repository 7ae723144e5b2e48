"""The pipeline on a real Slurm of one node: a failing run is told and hurts no other, and results
have the same bits as on this machine alone. Nothing is installed here: without Slurm, skipped."""

import importlib.util
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from one_node import INSTALL, PBS, missing, one_node, which

from lithofrac.config import load_suite, predicted

ROOT = Path(__file__).parents[2]
PARTS = ("Snakefile", "configs", "data", "reports", "fortran", "pywrap")
SLURM = "snakemake_executor_plugin_slurm"
GENERIC = "snakemake_executor_plugin_cluster_generic"
# Quick to ask and without accounting, as that of one_node.py has none.
HERE = [
    *("--slurm-status-command", "squeue", "--slurm-no-account"),
    *("--slurm-init-seconds-before-status-checks", "2"),
]
SOON = ["--seconds-between-status-checks", "2", "--latency-wait", "5"]
CLOCKS = ("core_seconds", "wall_seconds", "element_steps_per_core_second", "finished")

GOOD = """\
  bar: {extends: cases/bar.yaml, set: {scene.element_size_mm: 2.5}}
  one_element: {extends: cases/single_element.yaml, set: {loading.end_strain: 0.004}}
"""
THREE = f"""\
title: Two good runs and one that fails
cases:
{GOOD}\
  tears: {{extends: cases/single_element.yaml, set: {{loading.speed_m_s: 3000}}}}
"""
SAME = f"""\
title: Contact, cracks and an unstructured mesh, coarse
cases:
{GOOD}\
  hole:
    extends: cases/hole.yaml
    set:
      scene.wall_elements_per_radius: 6
      scene.far_elements_per_radius: 2
      loading.speed_m_s: 0.04
"""
STUDY = """\
title: Rate
base: configs/cases/single_element.yaml
set: {loading.end_strain: 0.001}
grid: {loading.speed_m_s: [0.1, 0.2]}
name: v{loading.speed_m_s}
quantities: [peak_stress_MPa]
plot: {x: loading.speed_m_s, y: [peak_stress_MPa]}
"""


def lacking(*plugins):
    """Reason to skip, or nothing."""
    if missing():
        return f"no {', '.join(missing())} on this machine; on Debian: {INSTALL}"
    absent = [name for name in plugins if importlib.util.find_spec(name) is None]
    if absent:
        return f"no {', '.join(absent)}: pip install -r requirements-cluster.txt"
    return ""


pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(lacking(SLURM)), reason=lacking(SLURM))]


@pytest.fixture(scope="module")
def cluster():
    """Environment of the clients of a Slurm of one node."""
    with one_node() as environment:
        yield environment


@pytest.fixture
def tree(tmp_path):
    """A copy of the tree, so that nothing of this one is locked or written to."""
    ignored = shutil.ignore_patterns("__pycache__", "*.so")
    for part in PARTS:
        source = ROOT / part
        if source.is_dir():
            shutil.copytree(source, tmp_path / part, ignore=ignored)
        else:
            shutil.copy(source, tmp_path / part)
    (tmp_path / "configs" / "three.yaml").write_text(THREE)
    (tmp_path / "configs" / "same.yaml").write_text(SAME)
    (tmp_path / "bin").mkdir()
    program = tmp_path / "bin" / "lithofrac"  # of the interpreter that runs the tests
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m lithofrac "$@"\n')
    program.chmod(0o755)
    return tmp_path


def snakemake(tree, environment, suite, out, cases, *options):
    """Run the cases of a suite; its exit code and what it said."""
    path = f"{tree / 'bin'}{os.pathsep}{environment['PATH']}"
    done = subprocess.run(
        [
            *(sys.executable, "-m", "snakemake", *options),
            *("--config", f"suite=configs/{suite}.yaml", f"out={out}", "--"),
            *(f"{out}/runs/{case}/summary.json" for case in cases),
        ],
        cwd=tree, env=dict(environment, PATH=path), capture_output=True, text=True, timeout=600,
    )  # fmt: skip
    return done.returncode, done.stdout + done.stderr


def on_slurm(tree, environment, suite, out, cases, together):
    """The same by the profile of Slurm, with so many runs in one job."""
    profile = ("--profile", "configs/profiles/slurm", *HERE, *SOON)
    group = ("--group-components", f"short={together}")
    return snakemake(tree, environment, suite, out, cases, *profile, *group)


def submitted(said):
    """Number of jobs that Slurm was given."""
    return len(numbers(said))


def numbers(said):
    """Of the jobs that Slurm was given."""
    return re.findall(r"submitted with SLURM jobid (\d+)", said)


def asked_for(environment, jobs):
    """Time limit, memory and cores of jobs, as Slurm has them."""
    command = ["squeue", "-h", "--states", "all", "-j", ",".join(jobs), "-o", "%l %m %C"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return sorted(done.stdout.splitlines())


def status(tree, out, case):
    """Of a run, or nothing where it left no summary."""
    path = tree / out / "runs" / case / "summary.json"
    return json.loads(path.read_text())["status"] if path.exists() else None


def test_run_that_fails_is_told_and_the_others_are_kept(tree, cluster):
    """Three jobs of which one fails; the next call has that one left to do."""
    cases = ("bar", "one_element", "tears")
    code, said = on_slurm(tree, cluster, "three", "out", cases, together=1)
    assert code != 0
    assert submitted(said) == 3
    costs = [predicted(load_suite(tree / "configs" / "three.yaml").case(case)) for case in cases]
    wanted = sorted(f"{cost.runtime}:00 {cost.mem_mb}M {cost.threads}" for cost in costs)
    assert asked_for(cluster, numbers(said)) == wanted
    assert [status(tree, "out", case) for case in cases] == ["completed", "completed", None]
    assert "out/log/simulate_tears.txt" in said
    why = (tree / "out" / "log" / "simulate_tears.txt").read_text()
    assert "it has turned inside out" in why
    assert why.strip() in said
    logs = list((tree / ".snakemake" / "slurm_logs").rglob("*.log"))
    assert any("simulate_tears.txt" in log.read_text() for log in logs)
    code, said = snakemake(tree, os.environ, "three", "out", cases, "--dry-run", "--quiet", "rules")
    assert set(re.findall(r"^simulate +(\d+)$", said, re.MULTILINE)) == {"1"}, said


def test_failure_in_a_shared_job_is_told_and_the_others_run_without_it(tree, cluster):
    """Snakemake drops all of a group; without groups the same call comes to an end."""
    cases = ("bar", "one_element", "tears")
    code, said = on_slurm(tree, cluster, "three", "out", cases, together=3)
    assert code != 0
    assert submitted(said) == 1
    assert "it has turned inside out" in said
    assert status(tree, "out", "tears") is None
    code, said = on_slurm(tree, cluster, "three", "out", cases, together=1)
    assert code != 0
    assert [status(tree, "out", case) for case in cases] == ["completed", "completed", None]


def contents(folder):
    """Every file of a run without its clocks: relative name -> bytes."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_dir() or name.startswith("checkpoint"):  # holds clocks; resume is tested apart
            continue
        if name == "summary.json":
            summary = json.loads(path.read_text())
            found[name] = {key: summary[key] for key in summary if key not in CLOCKS}
        elif path.suffix == ".npz":  # a zip, which holds its time
            with np.load(path) as arrays:
                found[name] = {key: arrays[key].tobytes() for key in arrays}
        else:
            found[name] = path.read_bytes()
    return found


def test_same_suite_has_the_same_bits_here_and_on_the_cluster(tree, cluster):
    cases = ("bar", "one_element", "hole")
    code, said = snakemake(tree, os.environ, "same", "here", cases, "--cores", "1")
    assert code == 0, said
    code, said = on_slurm(tree, cluster, "same", "there", cases, together=3)
    assert code == 0, said
    assert submitted(said) == 1
    for case in cases:
        here, there = (contents(tree / out / "runs" / case) for out in ("here", "there"))
        assert {"history.parquet", "energy.parquet", "mesh.npz", "summary.json"} <= set(here)
        assert list(here) == list(there)
        assert [name for name in here if here[name] != there[name]] == []
    assert "cracks.parquet" in contents(tree / "here" / "runs" / "hole")


def own_profile(tree):
    """Folder of a copy of the profile, with the words of the Slurm of one_node.py."""
    folder = tree / "site"
    folder.mkdir()
    words = (tree / "configs" / "profiles" / "slurm" / "config.yaml").read_text()
    own = "slurm-status-command: squeue\nslurm-no-account: true\nseconds-between-status-checks: 2\n"
    (folder / "config.yaml").write_text(words + own)
    return folder


def queue(environment):
    """States of the jobs that wait or run."""
    command = ["squeue", "-h", "-o", "%T"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return done.stdout.split()


def eventually(condition, seconds=120.0):
    """True once it holds, False if it never does."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.5)
    return True


def test_study_that_is_stopped_leaves_no_job_on_the_cluster(tree, cluster):
    (tree / "study.yaml").write_text(STUDY.replace("[0.1, 0.2]", "[0.00001]"))  # hours
    command = [sys.executable, "-m", "lithofrac", "study", "study.yaml", "--out", "out"]
    with subprocess.Popen(
        [*command, "--profile", str(own_profile(tree))],
        cwd=tree, env=cluster, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    ) as study:  # fmt: skip
        try:
            assert eventually(lambda: "RUNNING" in queue(cluster))
        finally:
            study.send_signal(signal.SIGTERM)
        assert study.wait(120) == 130
    assert eventually(lambda: queue(cluster) == [], 60.0)


def test_study_has_the_same_table_here_and_on_the_cluster(tree, cluster):
    """Also that a site's own profile is a folder anywhere."""
    (tree / "study.yaml").write_text(STUDY)
    for out, environment, where in (
        ("here", os.environ, ["--cores", "1"]),
        ("there", cluster, ["--profile", str(own_profile(tree))]),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "lithofrac", "study", "study.yaml", "--out", out, *where],
            cwd=tree, env=environment, capture_output=True, text=True, timeout=600,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        assert set(re.findall(r"Mesh and run (\S+)", done.stderr)) == {"v0.1", "v0.2"}
    assert submitted((tree / "there" / "log" / "snakemake.txt").read_text()) >= 2  # runs, table
    tables = [(tree / out / "table.parquet").read_bytes() for out in ("here", "there")]
    assert tables[0] == tables[1]


@pytest.mark.skipif(
    bool(lacking(GENERIC)) or not all(map(which, PBS)),
    reason=lacking(GENERIC) or f"no {', '.join(PBS)} on this machine; on Debian: slurm-wlm-torque",
)
def test_generic_profile_submits_by_qsub_and_sees_what_failed(tree, cluster):
    cases = ("bar", "tears")
    code, said = snakemake(
        tree, cluster, "three", "out", cases,
        *("--profile", "configs/profiles/pbs", *SOON, "--group-components", "short=1"),
    )  # fmt: skip
    assert code != 0, said
    assert "with external jobid" in said
    assert [status(tree, "out", case) for case in cases] == ["completed", None], said
