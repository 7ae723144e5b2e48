"""Write a file under a temporary name, then rename it: it is whole or it is not there."""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pandas as pd

from lithofrac.plain_file import text_of

OWN_FILES = (
    "summary.json",
    "history.parquet",
    "energy.parquet",
    "probes.parquet",
    "cracks.parquet",
    "fragments.parquet",
    "checkpoint.npz",
    "checkpoint_previous.npz",
    "checkpoint_failed.npz",
    "fields.pvd",
    "fields/frame_[0-9]*.vtu",
    "fields/cracks_[0-9]*.vtu",
    "fields/failed.vtu",
    "mesh.npz",
    "case.yaml",
    "geometry.geo",
    "geometry.msh",
)  # of a run: what the next one in the same folder may delete


MARK = ".lithofrac"  # in a folder that a run has made: what it holds under these names may go
MARKED = "Results of `lithofrac run`; the next run in this folder replaces them.\n"


def foreign(folder: Path) -> Path | None:
    """A file that a run would replace in a folder that no run has made; None without one."""
    if (folder / MARK).is_file() or _has_summary(folder) or _has_checkpoint(folder):
        return None
    return next((path for pattern in OWN_FILES for path in sorted(folder.glob(pattern))), None)


def _has_summary(folder: Path) -> bool:
    """Whether a run, of a version without the mark perhaps, has ended there."""
    try:
        values = json.loads(text_of(folder / "summary.json", "a summary"))
    except (ValueError, RecursionError):  # FileError as well
        return False
    return isinstance(values, dict) and {"status", "energy_residual"} <= set(values)


def _has_checkpoint(folder: Path) -> bool:
    """The same of a run that was stopped."""
    for path in folder.glob("checkpoint*.npz"):
        if path.is_file() and zipfile.is_zipfile(path):
            with suppress(zipfile.BadZipFile, OSError), zipfile.ZipFile(path) as file:
                if "fingerprint.npy" in file.namelist():
                    return True
    return False


def write_whole(path: Path, write: Callable[[Path], None], older: Path | None = None) -> None:
    """Call `write(temporary path)`, flush to disk, rename to `path`.

    Parameters
    ----------
    older : where the file goes that has been `path` so far, once the new one is whole

    Raises
    ------
    OSError
        From the disk; the temporary file is removed, older files stay as they were.
    """
    temporary = part_of(path)
    try:
        write(temporary)
        with open(temporary, "rb") as file:
            os.fsync(file.fileno())
        if older is not None and path.exists():
            path.replace(older)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def part_of(path: Path) -> Path:
    """Name of `path` while it is written; a run that is killed leaves it behind."""
    return path.with_name(f".{path.stem}.part{path.suffix}")


def write_table(path: Path, table: pd.DataFrame) -> None:
    """Write a Parquet table."""
    write_whole(path, lambda part: table.to_parquet(part, index=False))


def write_json(path: Path, values: dict) -> None:
    """Write a JSON object, one key a line; NaN is refused."""
    write_text(path, json.dumps(values, indent=2, allow_nan=False) + "\n")


def write_text(path: Path, text: str) -> None:
    """Write a text in UTF-8, whatever the locale."""
    write_whole(path, lambda part: part.write_text(text, encoding="utf-8"))
