"""The sweep: every run of every problem, processes side by side, and its tables."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.accuracy.problems import SUBJECTS
from lithofrac.accuracy.subject import Outcome, Setting, Subject
from lithofrac.accuracy.summary import summarised, unexplained
from lithofrac.analysis.front import DEFAULT, FINEST
from lithofrac.config.errors import ConfigError
from lithofrac.errors import CoreError
from lithofrac.results.files import write_table, write_whole

COLUMNS = (
    "problem",
    "quantity",
    "knob",
    "value",
    "default",
    "error_percent",
    "core_seconds",
    "elements",
    "steps",
)


def make_sweep(
    out: Path, only: list[str], processes: int, say: Callable[[str], None] = print
) -> list[str]:
    """Run the problems and write the tables `accuracy` and `accuracy_summary`.

    Parameters
    ----------
    out : folder, made if it is not there
    only : problems; none: all
    processes : side by side; errors do not depend on it, core seconds do on a machine that is full
    say : called with a line for every run that is done

    Returns
    -------
    One sentence for every run that failed, and for every default that is far without a reason.

    Raises
    ------
    ConfigError
        When there is no such problem.
    """
    for name in only:
        if name not in SUBJECTS:
            known = ", ".join(SUBJECTS)
            raise ConfigError(f"--only {name}: no such problem, expected one of {known}")
    chosen = {name: subject for name, subject in SUBJECTS.items() if not only or name in only}
    jobs = [(name, i) for name in chosen for i in range(len(chosen[name].settings()))]
    out.mkdir(parents=True, exist_ok=True)
    found: dict[tuple[str, int], Outcome | str] = {}
    context = multiprocessing.get_context("spawn")  # a fork may copy a lock that is held
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        waiting = {pool.submit(run_one, *job): job for job in jobs}
        for done in as_completed(waiting):
            job = waiting[done]
            found[job] = done.result()
            say(_line(job, found[job]))
    table = pd.concat(
        [
            table_of(subject, [found[name, i] for i in range(len(subject.settings()))])
            for name, subject in chosen.items()
        ],
        ignore_index=True,
    )
    _write(out / "accuracy", table)
    summary = summarised(table, SUBJECTS)
    _write(out / "accuracy_summary", summary)
    failed = [_line(job, ended) for job, ended in found.items() if isinstance(ended, str)]
    return failed + unexplained(summary)


def run_one(name: str, number: int) -> Outcome | str:
    """A run by its number, or why it failed: problems hold functions, which do not travel."""
    subject = SUBJECTS[name]
    try:
        return subject.run(**subject.settings()[number][1])
    except CoreError as error:
        return str(error)


def table_of(subject: Subject, outcomes: list[Outcome | str]) -> pd.DataFrame:
    """Rows of one problem, by quantity and then by run; a run that failed has no numbers.

    Raises
    ------
    CoreError
        When the finest solution failed, that the others are held against.
    """
    runs = list(zip(subject.settings(), outcomes, strict=True))
    rows = []
    for quantity in subject.quantities:
        exact = None
        if subject.finest is not None:
            if isinstance(outcomes[-1], str):
                raise CoreError(f"{subject.name}, finest: {outcomes[-1]}")
            exact = outcomes[-1].values[quantity]
        rows += [
            _row(subject, quantity, knob, knobs.get(knob), ended, exact)
            for (knob, knobs), ended in runs
        ]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _row(
    subject: Subject,
    quantity: str,
    knob: str,
    value: Setting | None,
    ended: Outcome | str,
    exact: float | None,
) -> dict:
    row = {"problem": subject.name, "quantity": quantity, "knob": knob}
    row |= {"value": _text(value), "default": _text(subject.default.get(knob))}
    if isinstance(ended, str):
        return row
    error = ended.values[quantity] if exact is None else ended.values[quantity] / exact - 1.0
    return row | {
        "error_percent": np.nan if knob == FINEST else 100.0 * abs(error),
        "core_seconds": ended.core_seconds,
        "elements": ended.elements,
        "steps": ended.steps,
    }


def _text(value: Setting | None) -> str:
    """A setting as it stands in the table: four digits are enough to tell it."""
    return f"{value:.4g}" if isinstance(value, float) else "" if value is None else str(value)


def _line(job: tuple[str, int], ended: Outcome | str) -> str:
    name, number = job
    knob, knobs = SUBJECTS[name].settings()[number]
    turned = knob if knob in (DEFAULT, FINEST) else f"{knob} = {_text(knobs[knob])}"
    if isinstance(ended, str):
        return f"{name}, {turned}: {ended}"
    return f"{ended.core_seconds:8.3f} s  {name}, {turned}"


def _write(stem: Path, table: pd.DataFrame) -> None:
    write_table(stem.with_suffix(".parquet"), table)
    write_whole(stem.with_suffix(".csv"), lambda part: table.to_csv(part, index=False))
