"""A run that was killed goes on to the same bits, whenever that was."""

import signal
import subprocess
import sys

import pytest
from fault_runs import assert_same

# As in test_disk.py; a process that is killed has no say in how.
pytestmark = [pytest.mark.restart, pytest.mark.one_build]


def finish(cracking, out, *more):
    """Resume; a run that had not come to a first checkpoint says so and is started anew."""
    code, said = cracking.run(out, "--resume", *more)
    if code == 2:
        assert said == f"lithofrac: --resume: {out}: there is no checkpoint to resume from\n"
        assert not list(out.glob("checkpoint*"))
        code, said = cracking.run(out, *more)
    assert (code, said) == (0, "")


@pytest.mark.parametrize(
    ("kills", "seed"),
    [(3, 0), *(pytest.param(5, seed, marks=pytest.mark.slow) for seed in range(1, 11))],
)
def test_killed_at_random_moments(cracking, unbroken, moments, tmp_path, kills, seed):
    """Every run is killed once, and resumed with another number of threads."""
    for number, moment in enumerate(moments(kills, seed)):
        out = killed(cracking, tmp_path / str(number), moment)
        finish(cracking, out, "--threads", str(1 + number % 3))
        assert_same(unbroken, out)


def killed(cracking, folder, moment):
    """Results folder of a run that was killed; earlier if it had come to its end before."""
    for attempt in range(5):
        out = folder / str(attempt)
        code, _ = cracking.stop(out, signal.SIGKILL, moment / 2**attempt)
        if code == -signal.SIGKILL:
            return out
    raise AssertionError("the run ends before it can be killed")


@pytest.mark.slow
def test_killed_again_and_again(cracking, unbroken, tmp_path):
    """Each attempt lives for ten more checkpoints."""
    out, attempts = tmp_path / "out", 1
    code, _ = cracking.stop(out, signal.SIGKILL, 10.5)
    while code == -signal.SIGKILL:
        code, _ = cracking.stop(out, signal.SIGKILL, 10.5, "--resume")
        attempts += 1
    assert code == 0
    assert attempts > 3
    assert_same(unbroken, out)


# Kills the process at one point of its code; the number counts the calls until then.
DRIVER = """
import os, signal, sys
from pathlib import Path
import numpy as np
from lithofrac import cli, core, run
from lithofrac.results import checkpoint, fields

def kill():
    os.kill(os.getpid(), signal.SIGKILL)

def before(owner, name, count):
    calls, old = [], getattr(owner, name)
    def wrapped(*args, **more):
        calls.append(name)
        if len(calls) == count:
            kill()
        return old(*args, **more)
    setattr(owner, name, wrapped)

def after(owner, name, count, halved=False, counted=lambda *args: True):
    calls, old = [], getattr(owner, name)
    def wrapped(*args, **more):
        if counted(*args):
            calls.append(name)
        value = old(*args, **more)
        if len(calls) == count and counted(*args):
            if halved:
                os.truncate(args[0], os.path.getsize(args[0]) // 2)
            kill()
        return value
    setattr(owner, name, wrapped)

def is_previous(_, new):
    return new.name == checkpoint.PREVIOUS

POINTS = {
    "before the first checkpoint": lambda: before(checkpoint, "write", 1),
    "within a checkpoint": lambda: after(np, "savez", 20, halved=True),
    "between two renames": lambda: after(Path, "replace", 25, counted=is_previous),
    "in the core": lambda: after(core.Run, "advance", 31),
    "within a frame": lambda: after(fields.meshio, "write", 4, halved=True),
    "after the last checkpoint": lambda: before(run, "write_table", 1),
    "before the summary": lambda: before(run, "write_json", 1),
}
POINTS[sys.argv[1]]()
sys.exit(cli.main(sys.argv[2:]))
"""
LEFT = {
    "within a checkpoint": ".checkpoint.part.npz",
    "within a frame": "fields/.*.part.vtu",
}


@pytest.mark.parametrize(
    "point",
    [
        "before the first checkpoint",
        "within a checkpoint",
        "between two renames",
        pytest.param("in the core", marks=pytest.mark.slow),
        pytest.param("within a frame", marks=pytest.mark.slow),
        "after the last checkpoint",
        pytest.param("before the summary", marks=pytest.mark.slow),
    ],
)
def test_killed_at_a_point(cracking, unbroken, tmp_path, point):
    out = tmp_path / "out"
    done = subprocess.run([sys.executable, "-c", DRIVER, point, *cracking.words(out)], timeout=300)
    assert done.returncode == -signal.SIGKILL
    if point in LEFT:
        assert list(out.glob(LEFT[point]))
    if point == "between two renames":
        assert not (out / "checkpoint.npz").exists()
        assert (out / "checkpoint_previous.npz").exists()
    finish(cracking, out)
    assert_same(unbroken, out)
