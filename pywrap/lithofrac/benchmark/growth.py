"""How cost grows: with elements, steps, cracks and threads; exponents fitted in logarithms.

python -m lithofrac.benchmark.growth [--out FILE] [--repeat N]

Series, each a set of rows of one table:

- `elements`: a step of the pressed block, and `test`: all steps of a test of fixed duration, whose
  number grows with the square root of the elements;
- `steps`: the same block over more and more steps, with records at the normal interval;
- `cracks`: what a step takes more once the block is cut into pieces, over its cut edges;
- `threads`: a step on the wall; on a machine of two cores two points, hence no interval;
- `small`: an elastic step of a few chunks of elements. What is left of a line through these times
  at no element is what a step costs beside its elements: its bookkeeping, and every question
  whether a feature is on.
"""

from __future__ import annotations

import argparse
import os
import statistics
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

from lithofrac.benchmark import blocks
from lithofrac.benchmark.race import Subject, race, seconds_a_step
from lithofrac.benchmark.rows import CONTACT_STEPS
from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.results.files import write_whole

ELEMENTS = (32, 50, 100, 158, 316)  # squares along a side: 2,048 to 199,712 elements
STEPS = (500, 1_000, 2_000, 4_000, 8_000)
CRACKS = (50, 25, 10, 5, 2)  # squares along a piece of `CUT` along the block
CUT = 100
SIDE_OF_STEPS, SIDE_OF_THREADS = 50, 158
SMALL = (8, 11, 16, 23)  # 1, 2, 4 and 9 chunks
DURATION = 1e-4  # of the test [s]
CONFIDENCE = 0.95


def exponent(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float]:
    """Slope of log y over log x, and the ends of its interval (NaN with fewer than four points).

    A small excess may come out negative by noise: such points have no logarithm and are left out.
    """
    x, y = x[y > 0.0], y[y > 0.0]
    if len(x) < 2:
        return np.nan, np.nan, np.nan
    if len(x) < 4:
        return float(np.polyfit(np.log(x), np.log(y), 1)[0]), np.nan, np.nan
    line, cov = np.polyfit(np.log(x), np.log(y), 1, cov=True)
    half = stats.t.ppf(0.5 + 0.5 * CONFIDENCE, len(x) - 2) * np.sqrt(cov[0, 0])
    return float(line[0]), float(line[0] - half), float(line[0] + half)


def series(name: str, x: list[float], seconds: list[float]) -> list[dict]:
    """Rows of a series with its exponent."""
    slope, low, high = exponent(np.array(x, float), np.array(seconds))
    fit = {"exponent": slope, "exponent_low": low, "exponent_high": high}
    return [
        {"series": name, "x": float(a), "seconds": b} | fit for a, b in zip(x, seconds, strict=True)
    ]


def with_elements(sides: tuple[int, ...], repeat: int) -> list[dict]:
    """Series `elements` and `test`."""
    rock = Material.load(blocks.ROCK)
    count, step, test = [], [], []
    for cells in sides:
        run = Run(blocks.pressed(blocks.square(cells), rock))
        elements = len(run.problem.mesh.triangles)
        speeds = race({"step": Subject(blocks.stepper(run))}, elements, repeat)["step"]
        count.append(elements)
        step.append(seconds_a_step(speeds.core, elements))
        test.append(step[-1] * DURATION / run.dt)
    return series("elements", count, step) + series("test", count, test)


def with_steps(cells: int, numbers: tuple[int, ...], repeat: int) -> list[dict]:
    """Series `steps`."""
    run = Run(blocks.pressed(blocks.square(cells), Material.load(blocks.ROCK)))
    elements, steps = len(run.problem.mesh.triangles), blocks.stepper(run)
    speeds = race({str(n): Subject(steps, count=n) for n in numbers}, elements, repeat)
    seconds = [n * seconds_a_step(speeds[str(n)].core, elements) for n in numbers]
    return series("steps", list(numbers), seconds)


def with_cracks(cells: int, sides: tuple[int, ...], repeat: int) -> list[dict]:
    """Series `cracks`."""
    rock = Material.load(blocks.ROCK)
    mesh = blocks.square(cells, seed=1)
    elements = len(mesh.triangles)
    subjects = {}
    for side in (cells, *sides):  # the first is the block in one piece
        cut = blocks.in_pieces(mesh, side * blocks.SIDE / cells)
        steps = blocks.stepper(blocks.pieces(cut, rock))
        subjects[str(side)] = Subject(steps, count=CONTACT_STEPS)
    speeds = race(subjects, elements, repeat)
    edges, more = [], []
    for side in sides:
        pairs = zip(speeds[str(side)].core, speeds[str(cells)].core, strict=True)
        more.append(elements * statistics.median(1 / a - 1 / b for a, b in pairs) / 1e6)
        edges.append(2 * cells * (-(-cells // side) - 1))
    return series("cracks", edges, more)


def with_threads(cells: int, threads: list[int], repeat: int) -> list[dict]:
    """Series `threads`, of time on the wall."""
    mesh, rock = blocks.square(cells), Material.load(blocks.ROCK)
    subjects = {
        str(n): Subject(blocks.stepper(Run(blocks.pressed(mesh, rock)), n), threads=n)
        for n in threads
    }
    elements = len(mesh.triangles)
    speeds = race(subjects, elements, repeat)
    seconds = [seconds_a_step(speeds[str(n)].wall, elements) for n in threads]
    return series("threads", threads, seconds)


def of_few(sides: tuple[int, ...], repeat: int) -> list[dict]:
    """Series `small`, which also has what a step costs at no element."""
    elastic = Material.load(blocks.ROCK).model_copy(update={"elastic": True})
    subjects, count = {}, []
    for cells in sides:
        run = Run(blocks.pressed(blocks.square(cells), elastic))
        count.append(len(run.problem.mesh.triangles))
        run.advance(blocks.WARM_UP)
        subjects[str(cells)] = Subject(lambda n, run=run: run.advance(n))
    # as many steps for all, so that they share a race
    speeds = race(subjects, count[-1], repeat)
    seconds = [seconds_a_step(own.core, count[-1]) for own in speeds.values()]
    _, at_none = np.polyfit(np.ceil(np.array(count) / 128), seconds, 1)
    return [row | {"at_no_element": at_none} for row in series("small", count, seconds)]


def measure(repeat: int) -> pd.DataFrame:
    """All series."""
    threads = [2**i for i in range((os.cpu_count() or 1).bit_length())]
    rows = of_few(SMALL, repeat)
    rows += with_elements(ELEMENTS, repeat)
    rows += with_steps(SIDE_OF_STEPS, STEPS, repeat)
    rows += with_cracks(CUT, CRACKS, repeat)
    rows += with_threads(SIDE_OF_THREADS, threads, repeat)
    return pd.DataFrame(rows)


def main(argv: list[str] | None = None) -> None:
    """Measure the series and write the table."""
    parser = argparse.ArgumentParser(
        prog="python -m lithofrac.benchmark.growth", description="Measure how cost grows."
    )
    parser.add_argument("--out", type=Path, default=Path("out/tables/growth.csv"))
    parser.add_argument("--repeat", type=int, default=5, help="windows of every point")
    options = parser.parse_args(argv)
    table = measure(options.repeat)
    print(table.to_string(index=False))
    options.out.parent.mkdir(parents=True, exist_ok=True)
    write_whole(options.out, lambda part: table.to_csv(part, index=False))


if __name__ == "__main__":
    main()
