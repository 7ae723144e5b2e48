"""A process that makes a run, takes some steps, and says what memory it has.

python -m lithofrac.benchmark.memory CELLS
"""

import json
import os
import resource
import sys
from pathlib import Path

from lithofrac.benchmark.blocks import EVERY, ROCK, pressed, square, stepper
from lithofrac.config import Material
from lithofrac.core import Run


def resident() -> int:
    """Bytes of this process in memory, now."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def main(cells: int) -> None:
    """Print elements, resident and peak bytes as JSON."""
    run = Run(pressed(square(cells), Material.load(ROCK)))
    stepper(run)(EVERY)
    peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(json.dumps({"elements": run.sizes().elements, "resident": resident(), "peak": peak}))


if __name__ == "__main__":
    main(int(sys.argv[1]))
