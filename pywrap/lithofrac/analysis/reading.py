"""Read back what a run wrote, or say in one sentence why not.

A results folder may be damaged, or hold files of anybody's: pyarrow, json and meshio raise almost
anything at those. Every table and summary is read here.
"""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd

from lithofrac.config.errors import one_line
from lithofrac.errors import FileError
from lithofrac.plain_file import refuse_other

NUMBER = (int, float)
KINDS = {
    "status": (str, "a text"),
    "energy": (dict, "a mapping of numbers"),
    "notes": (list, "a list of texts"),
    "cracks": (int, "a whole number"),
    "steps": (int, "a whole number"),
    "energy_residual": (NUMBER, "a number"),
    "core_seconds": (NUMBER, "a number"),
    "wall_seconds": (NUMBER, "a number"),
    "expected_seconds": (NUMBER, "a number"),
    "time_step_min_s": (NUMBER, "a number"),
}  # key of a summary -> what it holds where it is there


class Summary(dict):
    """Keys of a `summary.json`; one that is asked for and not there is named with its file."""

    def __init__(self, values: dict, path: Path) -> None:
        super().__init__(values)
        self.path = path

    def __missing__(self, key: str) -> None:
        raise FileError(f"{self.path}: key {key!r} is missing, expected the summary of a run")


def read_summary(path: Path) -> Summary:
    """Keys and values of a `summary.json`.

    Raises
    ------
    FileError
        Where the file is not there, no JSON, no mapping, or a value is not what a run writes.
    """
    expected = "the summary of a run"
    if not path.is_file() and (path.parent / "study.yaml").is_file():
        raise FileError(
            f"{path.parent}: is the folder of a study, expected its runs, as {path.parent}/runs/*, "
            f"or read {path.parent}/table.parquet"
        )
    if not path.is_file():
        raise FileError(
            f"{path.parent}: holds no {path.name}, expected a folder of `lithofrac run`"
        )
    values = read_json(path, expected)
    for key, (kind, words) in KINDS.items():
        _refuse(path, key, values.get(key), kind, words)
    for key, value in (values.get("energy") or {}).items():
        _refuse(path, f"energy.{key}", value, NUMBER, "a number")
    return Summary(values, path)


def read_json(path: Path, expected: str) -> dict:
    """Keys and values of a JSON object.

    Raises
    ------
    FileError
        Where the file is none; `expected` says what it should have been.
    """
    refuse_other(path, expected)
    try:
        values = json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        deep = isinstance(error, RecursionError)
        why = "nested too deeply" if deep else one_line(error, 200)
        raise FileError(f"{path}: expected {expected} in JSON ({why})") from None
    if not isinstance(values, dict):
        raise FileError(f"{path}: expected a JSON object, {expected}")
    return values


def _refuse(path: Path, key: str, value: object, kind: type | tuple, words: str) -> None:
    if value is not None and not isinstance(value, kind):
        raise FileError(f"{path}: {key} = {one_line(value)}: expected {words}")


def read_table(path: Path, *columns: str, empty: bool = False) -> pd.DataFrame:
    """Rows of a Parquet table of a run.

    Parameters
    ----------
    columns : of numbers, that it must have at least
    empty : whether a table without rows is right

    Raises
    ------
    FileNotFoundError
        Where there is no such file.
    FileError
        Where it is no Parquet table, or lacks a column or any row.
    """
    if not path.exists():
        raise FileNotFoundError(2, "No such file or directory", str(path))
    if not path.is_file():
        raise FileError(f"{path}: is no regular file, expected a Parquet table")
    try:
        table = pd.read_parquet(path)
    except Exception:  # pyarrow and pandas have dozens
        size = path.stat().st_size
        raise FileError(
            f"{path}: {size} bytes that are no Parquet table, expected one of a run"
        ) from None
    for column in columns:
        if column not in table:
            raise FileError(f"{path}: has no column {column!r}, expected a table of a run")
        if len(table) and not pd.api.types.is_numeric_dtype(table[column]):
            raise FileError(f"{path}: column {column!r} holds no numbers, expected a run")
    if table.empty and not empty:
        raise FileError(f"{path}: has no rows, expected a table of a run")
    return table
