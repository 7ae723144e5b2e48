"""The matrix and the curve of the stability limit: many cells, processes side by side."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import pandas as pd

from lithofrac.config.errors import ConfigError
from lithofrac.results.files import write_table, write_whole
from lithofrac.stability.families import FAMILIES, cells_of
from lithofrac.stability.judge import COLUMNS, judge, lost
from lithofrac.stability.limit import FACTORS, MESHES, point_of
from lithofrac.stability.summary import by_family

LIMIT = "limit"  # the curve, beside the families
GOOD = ("stable", "refused", "n/a")


def make_matrix(
    out: Path, only: list[str], processes: int, say: Callable[[str], None] = print
) -> list[str]:
    """Try the cells and write the tables `stability`, `stability_families` and `stability_limit`.

    Parameters
    ----------
    out : folder, made if it is not there
    only : families, or `limit` for the curve; none: all
    processes : side by side; results do not depend on it
    say : called with a line for every cell that is done

    Returns
    -------
    One sentence for every cell that is neither stable, refused as expected, nor n/a.

    Raises
    ------
    ConfigError
        When there is no such family.
    """
    known = [*FAMILIES, LIMIT]
    for name in only:
        if name not in known:
            raise ConfigError(f"--only {name}: no such family, expected one of {', '.join(known)}")
    families = tuple(name for name in FAMILIES if not only or name in only)
    cells = cells_of(families)
    first = sorted(range(len(cells)), key=lambda i: not cells[i].slow)  # long ones first
    points = [] if only and LIMIT not in only else [(m, f) for m in MESHES for f in FACTORS]
    rows: dict = {}
    out.mkdir(parents=True, exist_ok=True)
    context = multiprocessing.get_context("spawn")  # a fork may copy a lock that is held
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        jobs = {pool.submit(_judge, families, i): i for i in first}
        jobs |= {pool.submit(point_of, *point): point for point in points}
        for job in as_completed(jobs):
            key = jobs[job]
            try:
                rows[key] = job.result()
            except BrokenProcessPool:  # a crash of the core takes all that wait with it
                if not isinstance(key, int):
                    raise
                rows[key] = lost(cells[key])
            if isinstance(key, int):
                say(f"{rows[key]['verdict']:<8}{rows[key]['seconds']:6.1f} s  {cells[key].name}")
    table = pd.DataFrame([rows[i] for i in range(len(cells))], columns=list(COLUMNS))
    if len(cells):
        _write(out / "stability", table)
        _write(out / "stability_families", by_family(table))
    if points:
        _write(out / "stability_limit", pd.DataFrame([rows[point] for point in points]))
    bad = table[~table["verdict"].isin(GOOD)]
    return [
        f"{row.family}: {row.extreme} ({row.mesh}): {row.verdict}: {row.note}"
        for row in bad.itertuples()
    ]


def _judge(families: tuple[str, ...], number: int) -> dict:
    """A cell by its number: cells hold functions, which do not travel between processes."""
    return judge(cells_of(families)[number])


def _write(stem: Path, table: pd.DataFrame) -> None:
    write_table(stem.with_suffix(".parquet"), table)
    write_whole(stem.with_suffix(".csv"), lambda part: table.to_csv(part, index=False))
