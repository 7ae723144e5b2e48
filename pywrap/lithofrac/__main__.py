"""`python -m lithofrac` and the installed `lithofrac`: the command line, from its first import."""

import signal
import sys
from contextlib import suppress

INTERRUPTED = 130


def start() -> int:
    """Run one command; its exit code. Ctrl-C and SIGTERM end it alike, from the first import on."""
    try:
        if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:  # else somebody asked to be deaf
            signal.signal(signal.SIGTERM, _interrupt)
        from lithofrac.cli import main

        code = main()
    except KeyboardInterrupt:
        with suppress(OSError):  # nobody can be told
            print("lithofrac: interrupted", file=sys.stderr, flush=True)
        code = INTERRUPTED
    if code == INTERRUPTED:
        # One that left a text under execution, as those of dataclasses, is remembered as never
        # caught: Python would end by the signal. The next text makes it forget.
        exec("")
    return code


def _interrupt(number: int, frame: object) -> None:
    """Leave every block on the way, so that gmsh is stopped and no half file or folder is left."""
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(start())
