"""Speed of the core, next to a bare elastic kernel measured in the same run.

python -m lithofrac.benchmark [--out FILE] [--repeat N]

Every row is the median over windows that take turns, in million element-steps per second of
processor time, so that a machine that drifts or is shared moves all rows alike. Discrete steps
are those of a block that is cut into square pieces and pressed together; next to each runs the
same cut mesh without contact.
"""

from __future__ import annotations

import argparse
import json
import platform
import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.kernels import bare_elastic
from lithofrac.problem import Contact, Mesh, Problem, Ramp, VelocityLoad
from lithofrac.scenes._rectangle import rectangle

ELEMENT_STEPS = 2.0e7  # in one window
SIDE = 0.08  # [m]
CELLS = {5_000: 50, 50_000: 158}  # elements: squares along a side, two triangles each
PIECES = {"0.02": 50, "0.1": 11, "0.5": 3}  # pairs an element -> squares along a piece
FRICTION = 0.5
STRAIN = 2e-4  # that closes the cuts
WARM_UP = 50


def pressed(mesh: Mesh, material: Material, **changes) -> Problem:
    """The square, held below and pressed from above so slowly that nothing yields."""
    loads = (
        VelocityLoad("bottom", mesh.nodes_of("bottom"), 1),
        VelocityLoad("top", mesh.nodes_of("top"), 1, -1e-4, Ramp(0.0, 1e-5)),
    )
    problem = Problem(mesh, False, (material,), loads, (), 1.0, records=1000)
    return replace(problem, **changes)


def in_pieces(mesh: Mesh, side: float) -> Mesh:
    """The mesh cut into squares; each has its own nodes on the cuts.

    Parameters
    ----------
    mesh : structured mesh
    side : of a square, a multiple of its element size [m]
    """
    column, row = np.floor(mesh.centroids() / side).astype(int).T
    piece = np.repeat(column + row * (column.max() + 1), 3)
    (node, _), copy = np.unique([mesh.triangles.ravel(), piece], axis=1, return_inverse=True)
    return replace(mesh, nodes=mesh.nodes[node], triangles=copy.reshape(-1, 3).astype(np.int32))


def pieces(mesh: Mesh, material: Material, **changes) -> Run:
    """The pieces under uniaxial stress, pressed on from above."""
    low, high = (np.flatnonzero(abs(mesh.nodes[:, 1] - y) < 1e-9) for y in (0.0, SIDE))
    loads = (
        VelocityLoad("bottom", low.astype(np.int32), 1),
        VelocityLoad("top", high.astype(np.int32), 1, -0.1, Ramp(0.0, 1e-5)),
    )
    run = Run(Problem(mesh, False, (material,), loads, (), 1.0, records=1000, **changes))
    displacement = STRAIN * mesh.nodes * [material.poisson, -1.0]
    run.set_motion(displacement, 0.0 * displacement)
    return run


def stepper(run: Run) -> Callable[[int], None]:
    """Take steps with history records at the normal interval."""
    run.advance(WARM_UP)

    def steps(count: int) -> None:
        for _ in range(0, count, 100):
            run.advance(min(100, count))
            run.loads()

    return steps


def bare(mesh: Mesh, material: Material) -> Callable[[int], None]:
    """The bare elastic kernel on the same mesh."""
    velocity = 1e-3 * mesh.nodes.T

    def steps(count: int) -> None:
        bare_elastic(
            mesh.nodes.T,
            mesh.triangles.T + 1,
            material.young,
            material.poisson,
            material.density,
            velocity,
            count,
            0.9,
        )

    return steps


def race(
    subjects: dict[str, Callable[[int], None]], elements: int, repeat: int
) -> dict[str, list[float]]:
    """Million element-steps per core-second of every window of subjects that take turns."""
    count = max(100, round(ELEMENT_STEPS / elements / 100) * 100)
    speeds: dict[str, list[float]] = {name: [] for name in subjects}
    for _ in range(repeat):
        for name, steps in subjects.items():
            start = time.process_time()
            steps(count)
            speeds[name].append(elements * count / (time.process_time() - start) / 1e6)
    return speeds


def row(name: str, elements: int, speeds: list[float], bare_speeds: list[float]) -> dict:
    """A row of the result: medians and the range."""
    return {
        "name": name,
        "elements": elements,
        "threads": 1,
        "million_element_steps_per_core_second": statistics.median(speeds),
        "lowest": min(speeds),
        "highest": max(speeds),
        "of_bare_kernel": median_ratio(speeds, bare_speeds),
    }


def median_ratio(a: list[float], b: list[float]) -> float:
    """Median of the ratios of paired windows."""
    return statistics.median(x / y for x, y in zip(a, b, strict=True))


def continuum_rows(cells: int, repeat: int) -> list[dict]:
    """Rows of the steps without contact."""
    rock = Material.load("quartzite")
    elastic = rock.model_copy(update={"elastic": True})
    mesh = rectangle(SIDE, SIDE, SIDE / cells, structured=True, seed=2)
    subjects = {
        "bare_elastic_kernel": bare(mesh, rock),
        "elastic_step": stepper(Run(pressed(mesh, elastic))),
        "full_step": stepper(Run(pressed(mesh, rock))),
        "axisymmetric_step": stepper(Run(pressed(mesh, rock, axisymmetric=True))),
    }
    speeds = race(subjects, len(mesh.triangles), repeat)
    return [
        row(name, len(mesh.triangles), found, speeds["bare_elastic_kernel"])
        for name, found in speeds.items()
    ]


def discrete_row(cells: int, pairs: str, repeat: int) -> dict:
    """Row of a step with contact; also pairs, what one costs, and the time over that without.

    Parameters
    ----------
    cells : squares along a side of the block
    pairs : key of `PIECES`
    repeat : windows
    """
    rock = Material.load("quartzite")
    size = SIDE / cells
    mesh = rectangle(SIDE, SIDE, size, structured=True, seed=1)
    cut = in_pieces(mesh, PIECES[pairs] * size)
    elements = len(cut.triangles)
    run = pieces(cut, rock, contact=Contact(default_friction=FRICTION))
    subjects = {
        "bare": bare(mesh, rock),
        "alone": stepper(pieces(cut, rock)),
        "contact": stepper(run),
    }
    speeds = race(subjects, elements, repeat)
    found = row(f"discrete_step_pairs_{pairs}", elements, speeds["contact"], speeds["bare"])
    count = run.contact_statistics().pairs_max
    excess = [1 / a - 1 / b for a, b in zip(speeds["contact"], speeds["alone"], strict=True)]
    return found | {
        "pairs": count,
        "ns_per_pair": statistics.median(excess) * 1e3 * elements / count,
        "time_over_no_contact": median_ratio(speeds["alone"], speeds["contact"]),
    }


def measure(repeat: int) -> list[dict]:
    """All rows: name, elements, threads, million element-steps per core-second and its range."""
    rows = [row for cells in CELLS.values() for row in continuum_rows(cells, repeat)]
    return rows + [discrete_row(max(CELLS.values()), pairs, repeat) for pairs in PIECES]


def main(argv: list[str] | None = None) -> None:
    """Measure, print a table, store JSON."""
    parser = argparse.ArgumentParser(description="Measure the speed of the core.")
    parser.add_argument("--out", type=Path, default=Path("out/benchmark.json"))
    parser.add_argument("--repeat", type=int, default=7, help="windows of every row")
    options = parser.parse_args(argv)
    rows = measure(options.repeat)
    print("million element-steps per core-second, median (lowest-highest) of paired windows")
    for row in rows:
        contact = ""
        if "pairs" in row:
            contact = f", {row['pairs']} pairs at {row['ns_per_pair']:.0f} ns,"
            contact += f" {row['time_over_no_contact']:.2f} of the time without"
        print(
            f"{row['name']:24s}{row['elements']:8d} elements"
            f"{row['million_element_steps_per_core_second']:8.1f}"
            f" ({row['lowest']:.1f}-{row['highest']:.1f}), {row['of_bare_kernel']:.2f} of bare"
            f"{contact}"
        )
    options.out.parent.mkdir(parents=True, exist_ok=True)
    machine = {
        "processor": platform.processor() or platform.machine(),
        "system": platform.platform(),
    }
    options.out.write_text(json.dumps({"machine": machine, "rows": rows}, indent=2) + "\n")


if __name__ == "__main__":
    main()
