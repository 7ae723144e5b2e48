"""Files of anybody's: a device or a pipe might never end, and a size may be beyond any memory."""

from __future__ import annotations

from pathlib import Path

from lithofrac.errors import FileError

MOST_BYTES = 10_000_000  # of a text; those of the project have some thousands


def refuse_other(path: Path, expected: str, most: int = MOST_BYTES) -> None:
    """Refuse what is no regular file of at most `most` bytes, before it is opened.

    Parameters
    ----------
    expected : what the file should have been, for messages

    Raises
    ------
    FileError
        Where there is no such file, or it is a folder, device or pipe, or too large.
    """
    if not path.exists():
        raise FileError(f"{path}: no such file, expected {expected}")
    if not path.is_file():
        raise FileError(f"{path}: is no regular file, expected {expected}")
    if path.stat().st_size > most:
        raise FileError(f"{path}: is larger than {most:.3g} bytes, expected {expected}")


def text_of(path: Path, expected: str) -> str:
    """The text of a file in UTF-8; arguments and errors as of `refuse_other`."""
    refuse_other(path, expected)
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise FileError(f"{path}: byte {error.start} is not UTF-8, expected {expected}") from None
