"""Measure, print a table, store JSON."""

from __future__ import annotations

import argparse
import platform
from pathlib import Path

from lithofrac.benchmark import machine
from lithofrac.benchmark.rows import measure
from lithofrac.results.files import write_json

# what the memory is of -> contact pairs an element; the discrete ones have all that a step may do
MEMORY = {"continuum": None, "discrete_0.1": "0.1", "discrete_0.5": "0.5"}


def line(row: dict) -> str:
    """A row in words."""
    said = (
        f"{row['name']:24s}{row['elements']:8d} elements, {row['threads']} thread(s)"
        f"{row['million_element_steps_per_core_second']:8.1f}"
        f" ({row['lowest']:.1f}-{row['highest']:.1f}), {row['of_bare_kernel']:.2f} of bare"
    )
    if "speed_up" in row:
        said += f", {row['speed_up']:.2f} times one thread"
    if "returns_per_step" in row:
        said += f", {row['million_returns_per_core_second']:.2f} million returns/s"
    if "pairs" in row:
        said += f", {row['pairs']} pairs at {row['ns_per_pair']:.0f} ns,"
        said += f" {row['time_over_uncut']:.2f} of the time uncut"
    if "roofline_fraction" in row:
        said += f", {row['roofline_fraction']:.2f} of the roof"
    return said


def main(argv: list[str] | None = None) -> None:
    """Measure all rows and the memory, print them, and write the JSON."""
    parser = argparse.ArgumentParser(
        prog="python -m lithofrac.benchmark", description="Measure the speed of the core."
    )
    parser.add_argument("--out", type=Path, default=Path("out/benchmark.json"))
    parser.add_argument("--repeat", type=int, default=9, help="windows of every row")
    options = parser.parse_args(argv)
    print("million element-steps per core-second, median (lowest-highest) of paired windows")
    rows = []
    for row in measure(options.repeat):
        print(line(row), flush=True)
        rows.append(row)
    used = {name: machine.memory(pairs) for name, pairs in MEMORY.items()}
    for name, own in used.items():
        print(
            f"{name}: memory {own['resident_bytes_per_element']:.0f} bytes an element, "
            f"{own['peak_bytes_per_element']:.0f} at the peak"
        )
    options.out.parent.mkdir(parents=True, exist_ok=True)
    described = {
        "processor": platform.processor() or platform.machine(),
        "system": platform.platform(),
        "million_flops_per_core_second": machine.peak_flops(options.repeat) / 1e6,
    }
    write_json(options.out, {"machine": described, "memory": used, "rows": rows})


if __name__ == "__main__":
    main()
