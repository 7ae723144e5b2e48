"""Speed of the core, next to a bare elastic kernel measured in the same run.

python -m lithofrac.benchmark [--out FILE] [--repeat N]

Every row is the median over windows that take turns, in million element-steps per second of
processor time, so that a machine that drifts or is shared moves all rows alike.
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

from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.kernels import bare_elastic
from lithofrac.problem import Mesh, Problem, Ramp, VelocityLoad
from lithofrac.scenes._rectangle import rectangle

ELEMENT_STEPS = 2.0e7  # in one window
SIDE = 0.08  # [m]
CELLS = {5_000: 50, 50_000: 158}  # elements: squares along a side, two triangles each
WARM_UP = 50


def pressed(mesh: Mesh, material: Material, **changes) -> Problem:
    """The square, held below and pressed from above so slowly that nothing yields."""
    loads = (
        VelocityLoad("bottom", mesh.nodes_of("bottom"), 1),
        VelocityLoad("top", mesh.nodes_of("top"), 1, -1e-4, Ramp(0.0, 1e-5)),
    )
    problem = Problem(mesh, False, (material,), loads, (), 1.0, records=1000)
    return replace(problem, **changes)


def stepper(problem: Problem) -> Callable[[int], None]:
    """Take steps with history records at the normal interval."""
    run = Run(problem)
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


def measure(repeat: int) -> list[dict]:
    """All rows: name, elements, threads, million element-steps per core-second and its range."""
    rows = []
    rock = Material.load("quartzite")
    elastic = rock.model_copy(update={"elastic": True})
    for cells in CELLS.values():
        mesh = rectangle(SIDE, SIDE, SIDE / cells, structured=True, seed=2)
        elements = len(mesh.triangles)
        count = max(100, round(ELEMENT_STEPS / elements / 100) * 100)
        subjects = {
            "bare_elastic_kernel": bare(mesh, rock),
            "elastic_step": stepper(pressed(mesh, elastic)),
            "full_step": stepper(pressed(mesh, rock)),
            "axisymmetric_step": stepper(pressed(mesh, rock, axisymmetric=True)),
        }
        speeds: dict[str, list[float]] = {name: [] for name in subjects}
        for _ in range(repeat):
            for name, steps in subjects.items():
                start = time.process_time()
                steps(count)
                speeds[name].append(elements * count / (time.process_time() - start) / 1e6)
        for name, found in speeds.items():
            rows.append(
                {
                    "name": name,
                    "elements": elements,
                    "threads": 1,
                    "million_element_steps_per_core_second": statistics.median(found),
                    "lowest": min(found),
                    "highest": max(found),
                    "of_bare_kernel": statistics.median(
                        a / b for a, b in zip(found, speeds["bare_elastic_kernel"], strict=True)
                    ),
                }
            )
    return rows


def main(argv: list[str] | None = None) -> None:
    """Measure, print a table, store JSON."""
    parser = argparse.ArgumentParser(description="Measure the speed of the core.")
    parser.add_argument("--out", type=Path, default=Path("out/benchmark.json"))
    parser.add_argument("--repeat", type=int, default=7, help="windows of every row")
    options = parser.parse_args(argv)
    rows = measure(options.repeat)
    print("million element-steps per core-second, median (lowest-highest) of paired windows")
    for row in rows:
        print(
            f"{row['name']:22s}{row['elements']:8d} elements"
            f"{row['million_element_steps_per_core_second']:8.1f}"
            f" ({row['lowest']:.1f}-{row['highest']:.1f}), {row['of_bare_kernel']:.2f} of bare"
        )
    options.out.parent.mkdir(parents=True, exist_ok=True)
    machine = {
        "processor": platform.processor() or platform.machine(),
        "system": platform.platform(),
    }
    options.out.write_text(json.dumps({"machine": machine, "rows": rows}, indent=2) + "\n")


if __name__ == "__main__":
    main()
