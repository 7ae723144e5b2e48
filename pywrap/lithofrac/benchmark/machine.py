"""What a machine could do with a step: bytes and flops of the kernels, memory, and its two roofs.

Bytes are those that pass between memory and core if every array is read or written once in each
of the two passes of a step (elements, then nodes) and nothing of it stays in a cache; a mesh has
one node for two triangles. Flops count additions, multiplications, divisions and roots of the
formulas as they stand, one each; minima, maxima and signs count nothing. Both are of a step
without damping whose elements do not yield; a return mapping iterates, so it has no fixed count.

Elements, `fortran/mechanics/kinematics.f90`: gather 4, stretch 41, hooke 10, corner_forces 37,
beyond 20 (the check of all planes), scatter 8; a node has 6 for each component
(`kick_and_drift`). Bare kernel, `bare_kernel.f90`: gather 8, deformation and rotation 27,
rate of deformation 18, unrotated 18, stress 10, rotated 17, forces 16 and 8; a node 5 for each
component. Hoop terms of axisymmetry: 3 for the strain and 5 for the force.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from lithofrac.benchmark.blocks import cut_square, square

NODES = 0.5  # an element
REAL, INTEGER = 8, 4
# Each entry: reals that are read or written once; a change in place is two.
ELEMENT = {"gradient": 4, "volume": 1}
ELEMENT_INTEGERS = {"node": 3, "place": 3}
NODE_OF_ELEMENTS = {"u": 2, "buffer": 4}
NODE = {"buffer": 4, "internal": 2, "inverse_mass": 2, "external": 2, "v": 4, "u": 4}
BARE_ELEMENT = {"gradient": 4, "stress": 8}
BARE_NODE_OF_ELEMENTS = {"x": 2, "v": 2, "f": 4}
BARE_NODE = {"inverse_mass": 1, "f": 4, "v": 4, "x": 4}


def _sum(reals: dict[str, int], integers: int, *of_nodes: dict[str, int]) -> float:
    nodes = sum(sum(part.values()) for part in of_nodes)
    return REAL * (sum(reals.values()) + NODES * nodes) + INTEGER * integers


STEP_BYTES = _sum(ELEMENT, sum(ELEMENT_INTEGERS.values()), NODE_OF_ELEMENTS, NODE)
BYTES = {
    "bare_elastic_kernel": _sum(BARE_ELEMENT, 3, BARE_NODE_OF_ELEMENTS, BARE_NODE),
    "elastic_step": STEP_BYTES,
    "full_step": STEP_BYTES,
    "axisymmetric_step": STEP_BYTES + REAL,  # hoop
}
STEP_FLOPS = 4 + 41 + 10 + 37 + 20 + 8 + NODES * 2 * 6
FLOPS = {
    "bare_elastic_kernel": 8 + 27 + 18 + 18 + 10 + 17 + 16 + 8 + NODES * 2 * 5,
    "elastic_step": STEP_FLOPS,
    "full_step": STEP_FLOPS,
    "axisymmetric_step": STEP_FLOPS + 8,
}

MATRIX = 768  # rows of the matrices that are multiplied
MEMORY_CELLS = 23, 316  # squares along a side: 1,058 and 199,712 elements


def bandwidth(size: float, repeat: int) -> float:
    """Bytes per core-second of a triad a = b + s c whose three arrays take `size` bytes together.

    numpy makes two passes of it, with two arrays to read and two to write (a twice, and again).
    Arrays are new in each repeat: pages that fall badly in a cache halve what is found.
    """
    n = max(1024, int(size / 3 / REAL))
    passes = max(1, int(2e8 / (5 * REAL * n)))
    best = 0.0
    for _ in range(repeat):
        a, b, c = np.zeros(n), np.ones(n), np.full(n, 2.0)
        start = time.process_time()
        for _ in range(passes):
            np.multiply(c, 3.0, out=a)
            np.add(a, b, out=a)
        best = max(best, passes * 5 * REAL * n / (time.process_time() - start))
    return best


def peak_flops(repeat: int) -> float:
    """Flops per core-second of a product of matrices."""
    a = np.ones((MATRIX, MATRIX))
    best = 0.0
    for _ in range(repeat):
        start = time.process_time()
        a @ a
        best = max(best, 2.0 * MATRIX**3 / (time.process_time() - start))
    return best


def roofline(name: str, speed: float, flops: float, stream: float) -> dict:
    """Columns of a row: bytes and flops of an element-step, and the share of the lower roof.

    Parameters
    ----------
    speed : million element-steps per core-second
    flops : peak of a core [1/s]
    stream : bandwidth of a core for arrays as large as those of a step [B/s], one for all rows
    """
    if name not in BYTES:
        return {}
    roof = min(stream / BYTES[name], flops / FLOPS[name])
    return {
        "bytes_per_element_step": BYTES[name],
        "flops_per_element_step": FLOPS[name],
        "bandwidth_GB_s": stream / 1e9,
        "roofline_fraction": speed * 1e6 / roof,
    }


def memory(pairs: str | None = None) -> dict:
    """Bytes an element of a run, resident and at the peak: a large fresh process less a small one.

    Of a process that reads its mesh from a file, as `lithofrac run --mesh` does.

    Parameters
    ----------
    pairs : of contact an element, a key of `blocks.PIECES`; None: the continuum
    """
    small, large = (_process(cells, pairs) for cells in MEMORY_CELLS)
    more = large["elements"] - small["elements"]
    return {
        "elements": large["elements"],
        "pairs": large["pairs"],
        "resident_bytes_per_element": (large["resident"] - small["resident"]) / more,
        "peak_bytes_per_element": (large["peak"] - small["peak"]) / more,
    }


def _process(cells: int, pairs: str | None) -> dict:
    with TemporaryDirectory(prefix="lithofrac_") as folder:
        path = Path(folder) / "mesh.npz"
        (square(cells) if pairs is None else cut_square(cells, pairs)).save(path)
        command = [sys.executable, "-m", "lithofrac.benchmark.memory", str(path)]
        command += [pairs] if pairs else []
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=os.environ)
    return json.loads(done.stdout)
