"""What the compiled core may refuse, and what a file may lack, as Python exceptions."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps


class CoreError(RuntimeError):
    """The core refused a call; the message says why and where."""


class FileError(ValueError):
    """A file is not what it should be; the message names it and says why."""


class GuardError(CoreError):
    """A guard has stopped the run; the message says where, why, and what to try."""


class CheckpointError(CoreError):
    """There is no checkpoint that this run can go on from."""


def checked(call: Callable) -> Callable:
    """Turn the trailing (code, message) of a face routine into an exception."""

    @wraps(call, assigned=())
    def wrapper(*args):
        *results, code, message = call(*args)
        if code:
            raise CoreError(message.decode().strip())
        return results[0] if len(results) == 1 else tuple(results)

    return wrapper
