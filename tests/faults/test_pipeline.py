"""A pipeline that was killed goes on where it was: nothing is lost, nothing is run twice."""

import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import time

import pytest
from fault_runs import LITHOFRAC, RECORDS, ROOT, assert_same, wait_for_checkpoints

pytestmark = [pytest.mark.restart, pytest.mark.one_build, pytest.mark.slow]
NAMES = ("sandstone_soft_p00", "sandstone_soft_p01", "sandstone_soft_p02")
KEYS = f"""\
      material: {{extends: sandstone, fracture_energy_J_m2: 5.0}}
      scene.height_mm: 16.0
      scene.element_size_mm: 1.0
      loading.speed_m_s: 2.0
      loading.end_strain: 0.02
      output: {{records: {RECORDS}, fields: 7, checkpoint_seconds: 0}}
"""


@pytest.fixture
def tree(tmp_path):
    """A copy of the project with a suite of three cases, and a `lithofrac` that notes its calls."""
    root = tmp_path / "tree"
    for part in ("Snakefile", "configs", "data", "reports", "fortran", "pywrap"):
        source = ROOT / part
        copy = shutil.copytree if source.is_dir() else shutil.copy
        root.mkdir(exist_ok=True)
        copy(source, root / part)
    cases = "".join(
        f"  {name}:\n    extends: cases/sandstone_soft.yaml\n    set:\n"
        f"      loading.confinement_MPa: {number}\n{KEYS}"
        for number, name in enumerate(NAMES)
    )
    (root / "configs" / "three.yaml").write_text(f"title: Three\ncases:\n{cases}")
    (root / "bin").mkdir()
    command = root / "bin" / "lithofrac"
    command.write_text(f'#!/bin/sh\necho "$@" >> {root}/said\nexec {" ".join(LITHOFRAC)} "$@"\n')
    command.chmod(0o755)
    return root


def pipeline(root):
    """Snakemake on the three runs, one after the other, in a process group of its own."""
    targets = [f"out/runs/{name}/summary.json" for name in NAMES]
    words = ["--cores", "1", "--rerun-incomplete", "--config", "suite=configs/three.yaml"]
    return subprocess.Popen(
        [sys.executable, "-m", "snakemake", *words, "--", *targets],
        cwd=root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        env={**os.environ, "PATH": f"{root / 'bin'}{os.pathsep}{os.environ['PATH']}"},
        start_new_session=True,
    )  # fmt: skip


def second_case_is_at_work(runs, process):
    """Names of the case that is finished and of the one that is at work; waits for both."""
    while process.poll() is None:
        finished = [name for name in NAMES if (runs / name / "summary.json").exists()]
        started = [name for name in NAMES if (runs / name / "checkpoint.npz").exists()]
        if finished and len(started) > len(finished):
            return finished, next(name for name in started if name not in finished)
        time.sleep(0.01)
    pytest.fail(process.communicate()[0])


def front(root, monkeypatch):
    """tasks.py as a module that works on the copy."""
    spec = importlib.util.spec_from_file_location("tasks", ROOT / "tasks.py")
    tasks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tasks)
    monkeypatch.setattr(tasks, "ROOT", root)
    return tasks


def test_killed_pipeline_goes_on(tree, tmp_path, monkeypatch):
    runs, said, tasks = tree / "out" / "runs", tree / "said", front(tree, monkeypatch)
    first = pipeline(tree)
    finished, stopped = second_case_is_at_work(runs, first)
    wait_for_checkpoints(runs / stopped, 20, first)
    tasks.forget_killed_pipeline()
    assert list((tree / ".snakemake" / "locks").glob("*.lock")), "it is alive, and keeps its lock"
    os.killpg(first.pid, signal.SIGKILL)
    first.communicate()
    killed = time.time()
    assert not (runs / stopped / "summary.json").exists()
    before = (runs / finished[0] / "summary.json").read_bytes()
    said.unlink()

    tasks.forget_killed_pipeline()
    again = pipeline(tree)
    words, _ = again.communicate(timeout=300)
    assert again.returncode == 0, words
    assert sorted(line.split()[1] for line in said.read_text().splitlines()) == sorted(
        set(NAMES) - set(finished)
    )
    assert (runs / finished[0] / "summary.json").read_bytes() == before
    assert (runs / stopped / "fields" / "frame_0000.vtu").stat().st_mtime < killed, "it was resumed"

    suite = ["--suite", str(tree / "configs" / "three.yaml")]
    whole = tmp_path / "whole"
    subprocess.run([*LITHOFRAC, "run", stopped, *suite, "--out", str(whole), "--quiet"], check=True)
    assert_same(whole, runs / stopped)
