"""Read an .npz of anybody's: no code in it is run, and no size in it is believed.

A damaged zip makes zipfile, zlib and numpy raise almost anything; all of it becomes one sentence.
"""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from lithofrac.errors import FileError
from lithofrac.plain_file import refuse_other

MOST_BYTES = 1_000_000_000  # unpacked; a mesh of two million elements has 50 million


def arrays_of(path: Path, expected: str) -> dict[str, np.ndarray]:
    """All arrays of a file, by name.

    Parameters
    ----------
    expected : what the file should have been, for messages

    Raises
    ------
    FileError
        Where there is no such file or it does not hold arrays of numbers and texts alone.
    """
    refuse_other(path, expected, MOST_BYTES)
    try:
        with zipfile.ZipFile(path) as file:
            size = sum(member.file_size for member in file.infolist())
        if size > MOST_BYTES:
            raise ValueError(f"{size:.2g} bytes unpacked, at most {MOST_BYTES:.2g} are read")
        with np.load(path, allow_pickle=False) as file:
            found = {name: file[name] for name in file}
    except Exception as error:
        words = " ".join(str(error).split()) or type(error).__name__
        raise FileError(f"{path}: expected {expected} ({words[:200]})") from None
    for name, array in found.items():
        if not isinstance(array, np.ndarray):  # a member that numpy did not write
            raise FileError(f"{path}: expected {expected} ({name!r} is no array)")
    return found
