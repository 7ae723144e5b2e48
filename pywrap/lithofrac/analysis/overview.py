"""Summaries of runs side by side, as plain text that fits a terminal."""

import textwrap
from collections.abc import Callable
from itertools import zip_longest
from pathlib import Path

from lithofrac.analysis.runs import find_runs

WIDTH = 80  # characters of a line
LABEL, GAP, MOST = 31, 1, 3  # characters of a label, between columns; runs side by side

Row = tuple[str, Callable[[dict], object]]


def _plain(key: str, factor: float = 1.0) -> Callable[[dict], object]:
    """Entry of a summary, in another unit where it is a number."""

    def read(summary: dict) -> object:
        value = summary.get(key)
        return value * factor if isinstance(value, float) else value

    return read


def _share(part: str) -> Callable[[dict], object]:
    """Entry of the ledger at the end over the external work [%]; None without such work."""

    def read(summary: dict) -> object:
        energy = summary.get("energy", {})
        work, value = energy.get("external_J"), energy.get(part)
        return 100.0 * abs(value) / work if work and work > 0.0 and value is not None else None

    return read


ALWAYS: list[Row] = [
    ("status", _plain("status")),
    ("title", _plain("title")),
    ("finished", _plain("finished")),
    ("version", _plain("version")),
    ("commit", _plain("commit")),
    ("elements", _plain("elements")),
    ("nodes", _plain("nodes")),
    ("steps", _plain("steps")),
    ("time step [ns]", _plain("time_step_min_s", 1e9)),
    ("simulated time [ms]", lambda one: _plain("time_s", 1e3)(one.get("energy", {}))),
    ("threads", _plain("threads")),
    ("wall time [s]", _plain("wall_seconds")),
    ("core time [s]", _plain("core_seconds")),
    ("element-steps/core s [million]", _plain("element_steps_per_core_second", 1e-6)),
    ("peak axial stress [MPa]", _plain("peak_stress_MPa")),
    ("axial strain there [%]", _plain("peak_strain", 100.0)),
    ("kinetic/internal there [-]", _plain("kinetic_ratio_at_peak")),
    ("largest plastic strain [-]", _plain("max_plastic_strain")),
    ("elastic [% of work]", _share("elastic_J")),
    ("compressive [% of work]", _share("compressive_dissipation_J")),
    ("fracture [% of work]", _share("fracture_dissipation_J")),
    ("friction [% of work]", _share("friction_J")),
    ("damping [% of work]", _share("damping_J")),
    ("kinetic [% of work]", _share("kinetic_J")),
    ("energy residual [-]", _plain("energy_residual")),
    ("crack events (failed nodes)", _plain("cracks")),
]
WHERE_USED: list[Row] = [  # left out where no run has any
    ("crack length [mm]", _plain("crack_length_mm")),
    ("fragments", _plain("fragments")),
    ("edges taken instead of cuts", _plain("crack_fallbacks")),
    ("resets of one element, most", _plain("most_resets_of_an_element")),
    ("contact pairs, most", _plain("contact_pairs_max")),
    ("sweeps a contact step, mean", _plain("contact_sweeps_mean")),
    ("steps without convergence", _plain("contact_unconverged_steps")),
    ("penetration/element size [-]", _plain("max_penetration_over_h")),
]


def overview(paths: list[Path]) -> str:
    """Table of the summaries of runs, at most three side by side, their notes below.

    Parameters
    ----------
    paths : results folders, or files in them

    Raises
    ------
    FileError
        At a folder that holds no summary, or one that cannot be read.
    """
    runs = [(run.folder.resolve().name, run.summary) for run in find_runs(paths)]
    blocks = [_table(runs[i : i + MOST]) for i in range(0, len(runs), MOST)]
    notes = [_said(name, words) for name, one in runs for words in _notes(one)]
    return "\n\n".join([*blocks, *(["notes\n" + "\n".join(notes)] if notes else [])])


def _table(runs: list[tuple[str, dict]]) -> str:
    """Rows of a few runs; a row that none of them knows is left out."""
    width = (WIDTH - LABEL) // len(runs) - GAP
    lines = _lines("", [name for name, _ in runs], width)
    for rows, needed in ((ALWAYS, lambda value: value is not None), (WHERE_USED, bool)):
        for label, read in rows:
            values = [read(summary) for _, summary in runs]
            if any(map(needed, values)):
                lines += _lines(label, [_text(value) for value in values], width)
    return "\n".join(lines)


def _lines(label: str, cells: list[str], width: int) -> list[str]:
    """One row, each cell in as many lines as it needs."""
    columns = [[label], *(textwrap.wrap(cell, width) or [""] for cell in cells)]
    widths = [LABEL, *(width for _ in cells)]
    gap = " " * GAP
    return [
        gap.join(f"{text:<{wide}}" for text, wide in zip(parts, widths, strict=True)).rstrip()
        for parts in zip_longest(*columns, fillvalue="")
    ]


def _text(value: object) -> str:
    if value is None or value == "":
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _notes(summary: dict) -> list[str]:
    """Why a run failed, and what it says should be looked at."""
    return [words for words in (summary.get("message"), *summary.get("notes", ())) if words]


def _said(name: str, words: str) -> str:
    return textwrap.fill(f"{name}: {words}", WIDTH, initial_indent="  ", subsequent_indent="    ")
