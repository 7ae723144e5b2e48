"""Rows of the benchmark: medians of windows that take turns, in million element-steps a second.

Each row has `name`, `elements`, `threads`, the speed per core-second with its range, the speed on
the wall, and its ratio to the bare elastic kernel of the same turns. A row of two threads also
says how much faster than with one thread it is on the wall.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator

from lithofrac.benchmark import blocks, machine
from lithofrac.benchmark.race import Speeds, Subject, median_ratio, race
from lithofrac.config import Material
from lithofrac.core import Run

CELLS = {5_000: 50, 50_000: 158, 200_000: 316}  # elements -> squares along a side of the block
YIELDING = {"1": 0.01, "10": 0.1, "100": 1.0}  # percent -> share of the elements
YIELD_WINDOW = {"1": 0.5, "10": 0.25, "100": 0.1}  # of a window, as returns are slow
THREADS = (1, 2)
WITH_ALL = "0.1"  # pairs an element of the row with failure map, probe and damping
CONTACT_STEPS = 400  # of a window; many more would press the pieces until they yield
MANY, FEW_WINDOWS = 200_000, 3  # elements from which discrete rows have so few windows
LOOKS = 5  # steps in which it is seen which elements yield, before and after the windows
BARE = "bare_elastic_kernel"


def row(name: str, elements: int, threads: int, own: Speeds, bare: Speeds) -> dict:
    """A row of the result: medians and the range."""
    return {
        "name": name,
        "elements": elements,
        "threads": threads,
        "million_element_steps_per_core_second": statistics.median(own.core),
        "lowest": min(own.core),
        "highest": max(own.core),
        "million_element_steps_per_second": statistics.median(own.wall),
        "of_bare_kernel": median_ratio(own.core, bare.core),
    }


def with_threads(rows: list[dict], speeds: dict[str, Speeds]) -> list[dict]:
    """The same rows; those of several threads say what they gain on one, on the wall."""
    for entry in rows:
        if entry["threads"] == 1:
            continue
        one = speeds[key_of(entry["name"], 1)]
        own = speeds[key_of(entry["name"], entry["threads"])]
        entry["speed_up"] = median_ratio(own.wall, one.wall)
    return rows


def key_of(name: str, threads: int) -> str:
    """Name of a subject in its race."""
    return name if threads == 1 else f"{name}, {threads} threads"


def continuum_rows(cells: int, repeat: int) -> list[dict]:
    """Rows of the steps without contact, with the roofs of the machine for this size."""
    rock = Material.load(blocks.ROCK)
    elastic = rock.model_copy(update={"elastic": True})
    mesh = blocks.square(cells)
    problems = {
        "elastic_step": blocks.pressed(mesh, elastic),
        "full_step": blocks.pressed(mesh, rock),
        "elastic_step_damped": blocks.pressed(mesh, elastic, damping=blocks.DAMPED),
        "full_step_damped": blocks.pressed(mesh, rock, damping=blocks.DAMPED),
        "axisymmetric_step": blocks.pressed(mesh, rock, axisymmetric=True),
    }
    names = {BARE: (BARE, 1)}
    subjects = {BARE: Subject(blocks.bare(mesh, rock), has_setup=True)}
    for name, problem in problems.items():
        for threads in THREADS:
            key = key_of(name, threads)
            names[key] = name, threads
            subjects[key] = Subject(blocks.stepper(Run(problem), threads), threads=threads)
    elements = len(mesh.triangles)
    size = machine.STEP_BYTES * elements
    before = machine.bandwidth(size, repeat)
    speeds = race(subjects, elements, repeat)
    stream = max(before, machine.bandwidth(size, repeat))
    flops = machine.peak_flops(repeat)
    rows = []
    for key, (name, threads) in names.items():
        found = row(name, elements, threads, speeds[key], speeds[BARE])
        if threads == 1:
            speed = found["million_element_steps_per_core_second"]
            found |= machine.roofline(name, speed, flops, stream)
        rows.append(found)
    return with_threads(rows, speeds)


def yielding_rows(cells: int, repeat: int) -> list[dict]:
    """Rows of steps in each of which a share of the elements yields.

    `returns_per_step` is the least that was seen in steps before and after the windows;
    `only_these_yield` is true if in all of them it was the layer, no more and no less.
    """
    rock = Material.load(blocks.ROCK)
    mesh = blocks.square(cells)
    elements = len(mesh.triangles)
    names, runs = {}, {}
    subjects = {BARE: Subject(blocks.bare(mesh, rock), has_setup=True)}
    for percent, share in YIELDING.items():
        for threads in THREADS:
            name = f"full_step_yielding_{percent}"
            key = key_of(name, threads)
            names[key] = name, threads, share
            runs[key] = blocks.yielding(mesh, rock, share)
            steps = blocks.stepper(runs[key], threads)
            subjects[key] = Subject(steps, YIELD_WINDOW[percent], threads=threads)
    grew = {key: blocks.elements_that_yield(run, LOOKS) for key, run in runs.items()}
    speeds = race(subjects, elements, repeat)
    rows = []
    for key, (name, threads, share) in names.items():
        seen = grew[key] + blocks.elements_that_yield(runs[key], LOOKS)
        layer = list(range(round(share * elements)))
        returns = min(map(len, seen))
        found = row(name, elements, threads, speeds[key], speeds[BARE])
        speed = found["million_element_steps_per_core_second"]
        rows.append(
            found
            | {
                "returns_per_step": returns,
                "only_these_yield": all(found.tolist() == layer for found in seen),
                "million_returns_per_core_second": speed * returns / elements,
            }
        )
    return with_threads(rows, speeds)


def discrete_rows(cells: int, pairs: str, repeat: int) -> list[dict]:
    """Rows of a step with contact; also pairs, what one costs, and the time over that uncut.

    `discrete_step_pairs` has contact alone; at the pairs of `WITH_ALL` there is a step with failure
    map and probe as well, `discrete_step_full`, and one with damping too, `discrete_step_damped`;
    nothing cracks in them.

    Parameters
    ----------
    cells : squares along a side of the block
    pairs : key of `blocks.PIECES`
    repeat : windows
    """
    rock = Material.load(blocks.ROCK)
    whole = blocks.square(cells, seed=1)
    cut = blocks.cut_square(cells, pairs)
    elements = len(cut.triangles)
    made = {f"discrete_step_pairs_{pairs}": blocks.pieces}
    if pairs == WITH_ALL:
        made[f"discrete_step_full_{pairs}"] = blocks.full_pieces
        made[f"discrete_step_damped_{pairs}"] = blocks.damped_pieces
    runs = {(name, threads): make(cut, rock) for name, make in made.items() for threads in THREADS}
    subjects = {
        BARE: Subject(blocks.bare(whole, rock), has_setup=True),
        "uncut": Subject(blocks.stepper(blocks.pieces(whole, rock)), count=CONTACT_STEPS),
    }
    for (name, threads), run in runs.items():
        steps = blocks.stepper(run, threads)
        subjects[key_of(name, threads)] = Subject(steps, threads=threads, count=CONTACT_STEPS)
    speeds = race(subjects, elements, repeat)
    rows = []
    for (name, threads), run in runs.items():
        own, uncut = speeds[key_of(name, threads)], speeds["uncut"]
        count = run.contact_statistics().pairs_max
        excess = [1 / a - 1 / b for a, b in zip(own.core, uncut.core, strict=True)]
        rows.append(
            row(name, elements, threads, own, speeds[BARE])
            | {
                "pairs": count,
                "ns_per_pair": statistics.median(excess) * 1e3 * elements / count,
                "time_over_uncut": median_ratio(uncut.core, own.core),
                "cracks": run.sizes().cracks,
            }
        )
    return with_threads(rows, speeds)


def measure(repeat: int) -> Iterator[dict]:
    """All rows of the benchmark, one after the other."""
    for cells in CELLS.values():
        yield from continuum_rows(cells, repeat)
        yield from yielding_rows(cells, repeat)
    for pairs in blocks.PIECES:
        for elements, cells in CELLS.items():
            windows = min(repeat, FEW_WINDOWS) if elements >= MANY else repeat
            yield from discrete_rows(cells, pairs, windows)
