"""A small case that cracks, run as users run it: by a process of its own that can be killed."""

import contextlib
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from lithofrac.results.files import MARK

ROOT = Path(__file__).parents[2]
LITHOFRAC = [sys.executable, "-m", "lithofrac"]
RECORDS = 60
CASE = f"""\
extends: {ROOT / "configs" / "cases" / "sandstone_soft.yaml"}
title: A block that cracks at once, 0° to 90°
material: {{extends: sandstone, fracture_energy_J_m2: 5.0}}
scene: {{height_mm: 16.0, element_size_mm: 1.0}}
loading: {{speed_m_s: 2.0, end_strain: 0.02, confinement_MPa: 1.0, ramp_transits: 1.0}}
output: {{records: {RECORDS}, fields: 7, checkpoint_seconds: 0}}
"""
# Of a summary: what depends on the machine and its load, and on how the run came to its end.
TIMES = ("core_seconds", "wall_seconds", "element_steps_per_core_second", "finished")
HOW = ("threads", "notes", "commit")
MADE_BY = ("clocks", "build", "digest")  # of a checkpoint


class Cracking:
    """`lithofrac run` of a case, in a process of its own."""

    def __init__(self, file: Path) -> None:
        self.file = file

    def words(self, out: Path, *more: str) -> list[str]:
        """Arguments of `lithofrac`."""
        return ["run", str(self.file), "--out", str(out), "--quiet", *more]

    def start(self, out: Path, *more: str, **how) -> subprocess.Popen:
        """Start it; `how` goes to Popen."""
        return subprocess.Popen(
            [*LITHOFRAC, *self.words(out, *more)], stderr=subprocess.PIPE, text=True, **how
        )

    def run(self, out: Path, *more: str, **how) -> tuple[int, str]:
        """Run it; exit code and what it said."""
        process = self.start(out, *more, **how)
        said = process.communicate(timeout=300)[1]
        return process.returncode, said

    def stop(self, out: Path, number: signal.Signals, moment: float, *more: str) -> tuple[int, str]:
        """Run it and send a signal: at 7.25 a quarter of the way from checkpoint 7 to the next."""
        process = self.start(out, *more)
        wait_for(out / "mesh.npz", process)
        start, whole = time.monotonic(), int(moment)
        wait_for_checkpoints(out, whole, process)
        time.sleep((moment - whole) * (time.monotonic() - start) / max(whole, 1))
        process.send_signal(number)
        said = process.communicate(timeout=300)[1]
        return process.returncode, said


def wait_for(path: Path, process: subprocess.Popen) -> None:
    """Until a file is there, or the process that would write it has ended."""
    until = time.monotonic() + 120.0
    while not path.exists() and process.poll() is None:
        assert time.monotonic() < until, f"{path} does not come"
        time.sleep(0.001)


def wait_for_checkpoints(out: Path, n: int, process: subprocess.Popen) -> None:
    """Until `n` of them have been seen, or the process has ended."""
    file, last, seen = out / "checkpoint.npz", 0, 0
    while seen < n and process.poll() is None:
        with contextlib.suppress(FileNotFoundError):
            now = file.stat().st_mtime_ns
            seen, last = seen + (now != last), now
        time.sleep(0.001)


def files(folder: Path) -> dict[str, bytes]:
    """Name within the folder -> content, of all files."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def state(folder: Path) -> dict[str, bytes]:
    """The newest checkpoint without its clocks and builder, to the bit."""
    with np.load(folder / "checkpoint.npz", allow_pickle=False) as file:
        return {name: file[name].tobytes() for name in file if name not in MADE_BY}


def summary(folder: Path) -> dict:
    """What `summary.json` says."""
    return json.loads((folder / "summary.json").read_text())


def assert_same(one: Path, two: Path) -> None:
    """Both folders hold the same results to the bit, and no half file."""
    assert state(one) == state(two)
    both = [files(folder) for folder in (one, two)]
    for found in both:
        for name in ("checkpoint.npz", "checkpoint_previous.npz", "summary.json"):
            found.pop(name, None)
        assert [name for name in found if Path(name).name.startswith(".")] == [MARK]
    assert both[0].keys() == both[1].keys()
    for name, content in both[0].items():
        assert content == both[1][name], name
    first, second = (
        {key: value for key, value in summary(folder).items() if key not in (*TIMES, *HOW)}
        for folder in (one, two)
    )
    assert first == second
