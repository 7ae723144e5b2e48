"""How far a run is: a bar on a terminal, a plain line now and then in a log."""

import sys
import time
from contextlib import suppress
from typing import TextIO

EVERY_SECONDS = 10.0  # between two lines of a log


class Progress:
    """Shows what `run.simulate` reports at each record.

    Parameters
    ----------
    name : name of the case
    stream : where to write, default the standard error
    """

    def __init__(self, name: str, stream: TextIO | None = None) -> None:
        self.name = name
        self.stream = sys.stderr if stream is None else stream
        self.bar = None
        self.written = time.monotonic()

    def __call__(self, report: dict) -> None:
        """Take one report: step, steps, time_s, percent, rate, cracks, residual, seconds_left."""
        with suppress(OSError):  # a full disk below the log is no reason to stop
            if self.stream.isatty():
                self._move_bar(report)
            elif (
                time.monotonic() - self.written > EVERY_SECONDS or report["step"] == report["steps"]
            ):
                self.written = time.monotonic()
                print(f"{self.name}: {line(report)}", file=self.stream, flush=True)

    def warn(self, said: str) -> None:
        """Put a sentence on a line of its own."""
        text = f"{self.name}: warning: {said}"
        with suppress(OSError):  # as above; the summary has it too
            if self.bar is None:
                print(text, file=self.stream, flush=True)
            else:
                self.bar.write(text, file=self.stream)

    def close(self) -> None:
        """Leave the bar as it is and go to a new line."""
        if self.bar is not None:
            with suppress(OSError):
                self.bar.close()

    def _move_bar(self, report: dict) -> None:
        if self.bar is None:
            from tqdm import tqdm

            self.bar = tqdm(
                total=report["steps"], desc=self.name, unit="step", unit_scale=True,
                file=self.stream, dynamic_ncols=True,
            )  # fmt: skip
        self.bar.set_postfix_str(
            f"{report['rate'] / 1e6:.0f}M el/s, {report['cracks']} crack events, "
            f"residual {report['residual']:.0e}",
            refresh=False,
        )
        self.bar.update(report["step"] - self.bar.n)


def line(report: dict) -> str:
    """One report in words."""
    return (
        f"step {report['step']} of {report['steps']} ({report['percent']:.0f} %), "
        f"{1e3 * report['time_s']:.4f} ms, {report['rate'] / 1e6:.1f}M element-steps/s, "
        f"{report['cracks']} crack events, energy residual {report['residual']:.1e}, "
        f"{report['seconds_left']:.0f} s left"
    )
