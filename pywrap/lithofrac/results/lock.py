"""A results folder belongs to one run at a time."""

from __future__ import annotations

import errno
import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

NAME = ".lock"
# What file systems say that have no locks, some of those over a network.
NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)


class FolderInUseError(RuntimeError):
    """Another run is writing into the folder."""


@contextmanager
def only_run(folder: Path) -> Iterator[list[str]]:
    """Make `folder` and keep other runs out of it; yields sentences for the summary.

    The system drops the lock with the process that holds it, however that ends: the file that a
    killed run leaves keeps nobody out.

    Raises
    ------
    FolderInUseError
        At once, if another run is at work there.
    OSError
        If the folder cannot be made or written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / NAME
    handle, notes = _locked(path)
    try:
        os.pwrite(handle, f"{os.getpid():<20}".encode(), 0)
        yield notes
    finally:
        with suppress(OSError):  # the folder may have become read-only, or be gone
            path.unlink()
        os.close(handle)


def _locked(path: Path) -> tuple[int, list[str]]:
    """Handle of the lock file, held by this process; a sentence where nothing can be held."""
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            who = os.pread(handle, 20, 0).decode(errors="replace").strip()
            os.close(handle)
            raise FolderInUseError(
                f"{path.parent}: another run writes into it"
                f"{f', process {who}' if who.isdigit() else ''}; wait for its end, or give this "
                "one a folder of its own"
            ) from None
        except OSError as error:
            if error.errno in NO_LOCKS:
                return handle, [f"{path.parent}: no locks here, a second run would not be noticed"]
            os.close(handle)
            raise
        if _is(handle, path):
            return handle, []
        os.close(handle)  # its last holder removed it after we had opened it: it keeps nobody out


def _is(handle: int, path: Path) -> bool:
    """Whether the open file is still the one of that name."""
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False
