"""`python -m lithofrac` and the installed `lithofrac`: the command line, from its first import."""

import sys
from contextlib import suppress

INTERRUPTED = 130


def start() -> int:
    """Run one command; its exit code. Ctrl-C during the first imports ends like a later one."""
    try:
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


if __name__ == "__main__":
    sys.exit(start())
