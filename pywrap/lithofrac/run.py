"""Run a problem to its end: records, frames, checkpoints, summary."""

from __future__ import annotations

import math
import os
import platform
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import numpy as np

import lithofrac
from lithofrac import guards
from lithofrac._build import NATIVE
from lithofrac.analysis.crack_faces import find_faces
from lithofrac.analysis.frames import MM, Frame
from lithofrac.analysis.run_numbers import finite, peak, ratio, residual
from lithofrac.core import Run
from lithofrac.errors import CoreError, GuardError
from lithofrac.guards import Watch
from lithofrac.plan import expected_seconds
from lithofrac.problem import Problem
from lithofrac.results import checkpoint
from lithofrac.results.cracks import crack_table, fragment_table
from lithofrac.results.fields import write_cracks, write_frame, write_series
from lithofrac.results.files import write_json, write_table
from lithofrac.results.lock import only_run
from lithofrac.results.recorder import Recorder

FAILED_FRAME = "fields/failed.vtu"


def simulate(
    problem: Problem,
    out: Path,
    threads: int = 1,
    resume: bool = False,
    progress: Callable[[dict], None] | None = None,
    meta: dict | None = None,
    prepare: Callable[[], None] | None = None,
    warn: Callable[[str], None] | None = None,
) -> dict:
    """Step `problem` to its end and write the results folder `out`.

    Parameters
    ----------
    problem : what to run
    out : results folder; made if it is not there
    threads : threads of the core; results are the same bits for any number
    resume : go on from the newest good checkpoint in `out`
    progress : called at every record with step, steps, time_s, percent, rate, residual and
        seconds_left
    meta : entries for the summary (case, commit)
    prepare : called once the folder belongs to this run, before anything is written into it
    warn : called with a sentence when a guard warns for the first time

    Returns
    -------
    dict
        The summary, as in summary.json.

    Raises
    ------
    CoreError
        A step failed or a guard stopped the run: summary.json says `failed`, fields/failed.vtu
        and checkpoint_failed.npz hold the state to look at, and the last good checkpoint stays.
        Or there is no good checkpoint to resume from.
    KeyboardInterrupt
        Passed on after a checkpoint is written; summary.json says `interrupted`.
    FolderInUseError
        Another run is at work in the folder.
    OSError
        The folder cannot be written; the checkpoints that it holds stay as they are.
    """
    with only_run(out) as notes:
        if prepare is not None:
            prepare()
        (out / "fields").mkdir(exist_ok=True)
        session = _Session(problem, out, threads, meta or {}, warn)
        session.notes += notes
        if resume:
            session.resume()
        return _to_its_end(session, out, progress)


LAYOUT = {
    "state": ("f8", ("state",)),
    "clocks": ("f8", (2,)),
    "frames": ("f8", ("frames",)),
    "finished": ("b1", ()),
} | guards.LAYOUT  # of a checkpoint, beside what the recorder keeps


def misfit(problem: Problem, arrays: dict[str, np.ndarray]) -> str:
    """Why the arrays of a checkpoint are not those of a run of `problem`, or nothing."""
    run = Run(problem)
    why = checkpoint.misfit(arrays, {**LAYOUT, **Recorder(run).layout()})
    if why or not len(arrays["history"]):
        return why or "it holds no record"
    try:
        run.restore(arrays["state"])
    except CoreError as error:
        return str(error)
    return ""


def _to_its_end(session: _Session, out: Path, progress: Callable[[dict], None] | None) -> dict:
    """Step a session to its end; whatever stops it, the folder says so."""
    try:
        session.run_to_end(progress)
    except KeyboardInterrupt:
        if session.recorder.history:
            session.save_checkpoint()
            session.write("interrupted")
        raise
    except CoreError as error:
        session.fail(str(error))
        raise
    return session.write("completed")


class _Session:
    """One call of `simulate`: the run, its records and its clocks."""

    def __init__(
        self,
        problem: Problem,
        out: Path,
        threads: int,
        meta: dict,
        warn: Callable[[str], None] | None,
    ) -> None:
        self.problem, self.out, self.threads, self.meta = problem, out, threads, meta
        self.warn = warn
        self.run = Run(problem)
        self.recorder = Recorder(self.run)
        self.frames: list[tuple] = []  # time [s], files
        self.mark = checkpoint.fingerprint(problem)
        self.steps = math.ceil(problem.end_time / self.run.dt)
        self.every = max(1, self.steps // problem.records)
        self.watch = Watch(self.run, self.steps)
        self.core_before = self.wall_before = 0.0
        self.core_start, self.wall_start = time.process_time(), time.perf_counter()
        self.first_step = 0
        self.notes: list[str] = []

    @property
    def core_seconds(self) -> float:
        return self.core_before + time.process_time() - self.core_start

    @property
    def wall_seconds(self) -> float:
        return self.wall_before + time.perf_counter() - self.wall_start

    def resume(self) -> None:
        found = checkpoint.recover(self.out, self.mark, partial(misfit, self.problem))
        arrays = found.arrays
        self.notes += found.notes
        self.run.restore(arrays["state"])
        self.recorder.restore(arrays)
        self.watch.restore(arrays)
        self.core_before, self.wall_before = arrays["clocks"]
        self.frames = [
            (float(moment), *self._names(i)) for i, moment in enumerate(arrays["frames"])
        ]
        self.first_step = self.run.step
        for name in (FAILED_FRAME, checkpoint.FAILED):
            (self.out / name).unlink(missing_ok=True)

    def save_checkpoint(self) -> None:
        checkpoint.write(self.out, self.mark, self._arrays())

    def fail(self, message: str) -> None:
        """Write the state that failed, apart from the checkpoints, and the tables so far."""
        if not self.recorder.history:  # the start itself failed
            self.recorder.record()
        checkpoint.write_failed(self.out, self.mark, self._arrays())
        write_frame(self.out / FAILED_FRAME, self.run, numbered=True)
        self.write("failed", message)

    def _arrays(self) -> dict[str, np.ndarray]:
        """All that a checkpoint keeps."""
        return {
            "state": self.run.save(),
            "clocks": np.array([self.core_seconds, self.wall_seconds]),
            "frames": np.array([moment for moment, *_ in self.frames]),
            "finished": np.array(self.run.step >= self.steps),
            **self.recorder.arrays(),
            **self.watch.arrays(),
        }

    def run_to_end(self, progress: Callable[[dict], None] | None) -> None:
        run = self.run
        if not self.recorder.history:
            with _signals_later() as asked_to_stop:
                run.advance(0, self.threads)
                self._record()
                self._look()
            if asked_to_stop:
                raise KeyboardInterrupt
            self.save_checkpoint()
        saved = time.perf_counter()
        while run.step < self.steps:
            with _signals_later() as asked_to_stop:
                self._advance(min(run.step + self.every, self.steps))
                self._record()
                self._look()
            if asked_to_stop:
                raise KeyboardInterrupt
            if progress is not None:
                progress(self._progress())
            if time.perf_counter() - saved >= self.problem.checkpoint_seconds:
                self.save_checkpoint()
                saved = time.perf_counter()
        self.save_checkpoint()

    def _record(self) -> None:
        self.recorder.record()
        due = self.run.step / self.steps * max(1, self.problem.fields - 1)
        if self.problem.fields and due >= len(self.frames):
            self._write_fields()

    def _names(self, number: int) -> list[str]:
        """Files of a frame: the mesh, and the cracks where they may open."""
        cracks = [] if self.problem.fracture is None else [f"fields/cracks_{number:04d}.vtu"]
        return [f"fields/frame_{number:04d}.vtu", *cracks]

    def _write_fields(self) -> None:
        moment, names = self.run.step * self.run.dt, self._names(len(self.frames))
        write_frame(self.out / names[0], self.run)
        if len(names) > 1:
            frame, table = Frame.load(self.out / names[0], moment), crack_table(self.run)
            faces = find_faces(frame, table)
            write_cracks(
                self.out / names[1], frame.nodes / MM, frame.displacement / MM,
                faces.edges, table.iloc[faces.crack],
            )  # fmt: skip
        self.frames.append((moment, *names))

    def _advance(self, step: int) -> None:
        """Step the run to `step`, with the looks that are due before it."""
        while self.run.step < step:
            self.run.advance(min(self.watch.steps_ahead(), step - self.run.step), self.threads)
            if self.run.step < step:
                self._look()

    def _look(self) -> None:
        """Hold the run against its guards, before its state becomes a checkpoint."""
        try:
            sentences = self.watch.look()
        except GuardError:
            if self.recorder.history[-1][0] < self.run.step:  # stopped between two records
                self.recorder.record()
            raise
        for said in sentences:
            if self.warn is not None:
                self.warn(said)

    def _progress(self) -> dict:
        done = self.run.step - self.first_step
        seconds = time.perf_counter() - self.wall_start
        return {
            "step": self.run.step,
            "steps": self.steps,
            "time_s": self.run.step * self.run.dt,
            "percent": 100.0 * self.run.step / self.steps,
            "rate": done * len(self.problem.mesh.triangles) / max(seconds, 1e-9),
            "cracks": self.run.sizes().cracks,
            "residual": self.recorder.energy[-1][-1],
            "seconds_left": seconds / max(done, 1) * (self.steps - self.run.step),
        }

    def write(self, status: str, message: str = "") -> dict:
        """Write the tables and the summary; returns the summary."""
        history = self.recorder.history_table()
        energy = self.recorder.energy_table()
        write_table(self.out / "history.parquet", history)
        write_table(self.out / "energy.parquet", energy)
        if self.recorder.probes:
            write_table(self.out / "probes.parquet", self.recorder.probe_table())
        if self.problem.fracture is not None:
            write_table(self.out / "cracks.parquet", crack_table(self.run))
            fragments = fragment_table(self.recorder.fragments)
            write_table(self.out / "fragments.parquet", fragments)
        if self.frames:
            write_series(self.out / "fields.pvd", self.frames)
        summary = self._summary(status, message, history, energy)
        write_json(self.out / "summary.json", summary)
        return summary

    def _summary(self, status: str, message: str, history, energy) -> dict:
        run, elements = self.run, len(self.problem.mesh.triangles)
        core, last = self.core_seconds, energy.iloc[-1]
        contact, sizes = run.contact_statistics(), run.sizes()
        return {
            "status": status,
            "message": message,
            **self.meta,
            "version": lithofrac.__version__,
            "native": NATIVE,
            "machine": _machine(),
            "finished": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
            "elements": elements,
            "nodes": len(self.problem.mesh.nodes),
            "steps": run.step,
            "time_step_min_s": run.dt,
            "time_step_max_s": run.dt,
            "time_step_continuum_s": Run(replace(self.problem, fracture=None)).dt,
            "threads": self.threads,
            "core_seconds": core,
            "expected_seconds": expected_seconds(self.problem, run.step),
            "wall_seconds": self.wall_seconds,
            "element_steps_per_core_second": elements * run.step / core,
            "energy": {name: finite(value) for name, value in last.items()},
            "energy_residual": residual(energy),
            **peak(history, energy),
            "damping_over_external": finite(
                ratio(-energy["damping_J"].iloc[-1], energy["external_J"].iloc[-1])
            ),
            "max_plastic_strain": finite(
                run.elements(np.arange(sizes.elements)).plastic_strain.max()
            ),
            "cracks": sizes.cracks,
            "fragments": self.recorder.fragments_now,
            "crack_length_mm": float(1e3 * run.cracks()[:, 6].sum()),
            "crack_fallbacks": sizes.fallbacks,
            "crack_nodes_without_way": sizes.closed,
            "most_resets_of_an_element": sizes.most_resets,
            "max_penetration_over_h": finite(contact.max_penetration_over_h),
            "contact_pairs_max": contact.pairs_max,
            "contact_sweeps_mean": contact.sweeps_mean,
            "contact_unconverged_steps": contact.unconverged_steps,
            "notes": [*self.notes, *self.watch.notes()],
        }


@contextmanager
def _signals_later() -> Iterator[list[int]]:
    """Hold back Ctrl-C and SIGTERM, so that a step and its record stay together.

    Yields a list that holds the signals which came meanwhile. Outside the main thread, where
    Python delivers no signals, it stays empty.
    """
    came: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield came
        return
    held = (signal.SIGINT, signal.SIGTERM)
    before = {number: signal.signal(number, lambda n, _: came.append(n)) for number in held}
    try:
        yield came
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _machine() -> str:
    """System, number of cores and, where the system tells it, the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    known = [platform.system(), platform.machine(), f"{os.cpu_count()} cores", *models[:1]]
    return ", ".join(part for part in known if part)
