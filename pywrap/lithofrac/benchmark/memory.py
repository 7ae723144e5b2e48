"""A process that makes a run, takes some steps, and says what memory it has.

python -m lithofrac.benchmark.memory CELLS
"""

import json
import sys
from pathlib import Path

from lithofrac.benchmark.blocks import EVERY, ROCK, pressed, square, stepper
from lithofrac.config import Material
from lithofrac.core import Run


def used() -> dict[str, int]:
    """Bytes of this process in memory, now and at most.

    Not from `getrusage`, whose maximum a process takes over from the one that started it.
    """
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    found = dict(line.split(":", 1) for line in lines)
    names = {"resident": "VmRSS", "peak": "VmHWM"}
    return {name: 1024 * int(found[key].split()[0]) for name, key in names.items()}


def main(cells: int) -> None:
    """Print elements, resident and peak bytes as JSON."""
    run = Run(pressed(square(cells), Material.load(ROCK)))
    stepper(run)(EVERY)
    print(json.dumps({"elements": run.sizes().elements} | used()))


if __name__ == "__main__":
    main(int(sys.argv[1]))
