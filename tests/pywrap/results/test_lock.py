"""One run a folder (pywrap/lithofrac/results/lock.py)."""

import errno
import fcntl
import os

import pytest

from lithofrac.results import lock
from lithofrac.results.lock import FolderInUseError, only_run

pytestmark = pytest.mark.no_core


def test_second_is_refused_in_a_sentence_until_the_first_is_done(tmp_path):
    out = tmp_path / "new" / "out"
    with only_run(out) as notes:
        assert notes == []
        for _ in range(2):
            with pytest.raises(FolderInUseError) as refused, only_run(out):
                pass
            assert str(refused.value) == (
                f"{out}: another run writes into it, process {os.getpid()}; wait for its end, "
                "or give this one a folder of its own"
            )
    assert list(out.iterdir()) == []
    with only_run(out):
        pass


def test_failure_lets_go_as_well(tmp_path):
    with pytest.raises(ZeroDivisionError), only_run(tmp_path):
        raise ZeroDivisionError
    with only_run(tmp_path):
        pass


def test_file_that_a_killed_run_has_left_keeps_nobody_out(tmp_path):
    (tmp_path / lock.NAME).write_text("4711")
    with only_run(tmp_path):
        pass
    assert not (tmp_path / lock.NAME).exists()


def test_file_that_its_holder_removes_meanwhile_is_not_taken_for_the_lock(tmp_path, monkeypatch):
    """The second opens it, the first removes it and ends, a third makes another one."""
    opened, flock = [], fcntl.flock

    def late(handle, how):
        if not opened:
            opened.append(handle)
            (tmp_path / lock.NAME).unlink()
        flock(handle, how)

    monkeypatch.setattr(lock.fcntl, "flock", late)
    with only_run(tmp_path), pytest.raises(FolderInUseError), only_run(tmp_path):
        pass


@pytest.mark.parametrize("code", lock.NO_LOCKS)
def test_file_system_without_locks_is_noted(tmp_path, monkeypatch, code):
    def refuse(handle, how):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(lock.fcntl, "flock", refuse)
    with only_run(tmp_path) as notes:
        assert notes == [f"{tmp_path}: no locks here, a second run would not be noticed"]


def test_other_failures_of_the_lock_are_not_hidden(tmp_path, monkeypatch):
    def refuse(handle, how):
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(lock.fcntl, "flock", refuse)
    with pytest.raises(OSError, match="Input/output error"), only_run(tmp_path):
        pass
