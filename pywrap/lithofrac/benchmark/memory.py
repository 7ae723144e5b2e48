"""A process that makes a run, takes some steps, and says what memory it has.

python -m lithofrac.benchmark.memory MESH [PAIRS]

With PAIRS, a key of `blocks.PIECES`, the mesh is in pieces, with failure map, probe and damping.
"""

import json
import sys
from pathlib import Path

from lithofrac.benchmark.blocks import (
    EVERY,
    ROCK,
    damped_pieces,
    pressed,
    stepper,
)
from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.problem import Mesh


def used() -> dict[str, int]:
    """Bytes of this process in memory, now and at most.

    Not from `getrusage`, whose maximum a process takes over from the one that started it.
    """
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    found = dict(line.split(":", 1) for line in lines)
    names = {"resident": "VmRSS", "peak": "VmHWM"}
    return {name: 1024 * int(found[key].split()[0]) for name, key in names.items()}


def main(mesh: Path, pairs: str | None = None) -> None:
    """Print elements, resident and peak bytes, and contact pairs as JSON."""
    rock = Material.load(ROCK)
    if pairs is None:
        run = Run(pressed(Mesh.load(mesh), rock))
    else:
        run = damped_pieces(Mesh.load(mesh), rock)
    stepper(run)(EVERY)
    counts = {"elements": run.sizes().elements, "pairs": run.contact_statistics().pairs_max}
    print(json.dumps(counts | used()))


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:])
