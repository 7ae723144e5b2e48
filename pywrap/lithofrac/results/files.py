"""Write a file under a temporary name, then rename it: it is whole or it is not there."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path

import pandas as pd

OWN_FILES = (
    "summary.json",
    "history.parquet",
    "energy.parquet",
    "probes.parquet",
    "cracks.parquet",
    "fragments.parquet",
    "checkpoint.npz",
    "checkpoint_previous.npz",
    "fields.pvd",
    "fields/frame_[0-9]*.vtu",
    "fields/cracks_[0-9]*.vtu",
    "fields/failed.vtu",
    "mesh.npz",
    "case.yaml",
    "geometry.geo",
    "geometry.msh",
)  # of a run: what the next one in the same folder may delete


def write_whole(path: Path, write: Callable[[Path], None]) -> None:
    """Call `write(temporary path)`, flush to disk, rename to `path`.

    Raises
    ------
    OSError
        From the disk; the temporary file is removed and an older `path` stays as it was.
    """
    temporary = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        write(temporary)
        with open(temporary, "rb") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_table(path: Path, table: pd.DataFrame) -> None:
    """Write a Parquet table."""
    write_whole(path, lambda part: table.to_parquet(part, index=False))


def write_json(path: Path, values: dict) -> None:
    """Write a JSON object, one key a line; NaN is refused."""
    text = json.dumps(values, indent=2, allow_nan=False) + "\n"
    write_whole(path, lambda part: part.write_text(text))
