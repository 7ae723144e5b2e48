"""Speed as a table: rows of the benchmark, and what was asked of it with a verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from lithofrac.analysis.reading import read_json, read_summary
from lithofrac.analysis.verdict import OPEN, verdict
from lithofrac.data import DataError
from lithofrac.data.csv_file import read_columns
from lithofrac.errors import FileError

NONE = "-"  # verdict where nothing was asked
BYTES = " bytes per element"
# Steps of two threads: contact is solved by one of them, what yields lies in few of their blocks.
THREADED = ("full_step", "full_step_yielding_10", "discrete_step_pairs_0.1")
BESIDE = ("leave_out.csv", "growth.csv")  # tables beside `benchmark.json`
NEAR = 0.02  # relative, of a number of elements
WITHIN = 2.0  # factor, of a predicted run time
ROW_COLUMNS = (
    "name",
    "elements",
    "threads",
    "million_element_steps_per_core_second",
    "lowest",
    "highest",
    "of_bare_kernel",
    "speed_up",
    "returns_per_step",
    "million_returns_per_core_second",
    "pairs",
    "ns_per_pair",
    "bytes_per_element_step",
    "flops_per_element_step",
    "roofline_fraction",
)


@dataclass(frozen=True)
class Measured:
    """What the three measurements have left, the summaries of runs, and a time of the paper."""

    benchmark: dict
    leave_out: pd.DataFrame
    growth: pd.DataFrame
    runs: dict[str, dict]
    paper_seconds: float  # that the paper states for its discrete punch

    def row(self, name: str, elements: int, threads: int = 1) -> dict:
        """The row of the benchmark; nothing if it has none."""
        for row in self.benchmark["rows"]:
            same = row["name"] == name and row["threads"] == threads
            if same and abs(row["elements"] / elements - 1.0) < NEAR:
                return row
        return {}


@dataclass(frozen=True)
class Target:
    """One demand: `least` or `most` of a number; neither: it stands there without a verdict."""

    what: str
    value: Callable[[Measured], float | None]
    least: float | None = None
    most: float | None = None
    unit: str = ""

    def row(self, measured: Measured) -> dict:
        """Asked, measured, verdict."""
        value = self.value(measured)
        return {
            "target": self.what,
            "asked": self._asked(),
            "measured": value,
            "verdict": self._verdict(value),
        }

    def _asked(self) -> str:
        if self.least is None and self.most is None:
            return f"nothing{',' if self.unit else ''}{self.unit}"
        word, bound = ("at most", self.most) if self.least is None else ("at least", self.least)
        return f"{word} {bound:g}{self.unit}"

    def _verdict(self, value: float | None) -> str:
        if value is None:
            return OPEN
        if self.least is None and self.most is None:
            return NONE
        return verdict(value >= self.least if self.least is not None else value <= self.most)


def speed_rows(inputs: list[Path], data: Path) -> pd.DataFrame:
    """The rows of `benchmark.json`."""
    table = pd.DataFrame(_read(inputs, data).benchmark["rows"])
    return table[[name for name in ROW_COLUMNS if name in table]]


def speed_targets(inputs: list[Path], data: Path) -> pd.DataFrame:
    """What was asked of speed: asked, measured, verdict.

    Inputs are `benchmark.json`, `leave_out.csv`, `growth.csv` and summaries of runs of the punch.
    """
    measured = _read(inputs, data)
    return pd.DataFrame([target.row(measured) for target in TARGETS])


def _read(inputs: list[Path], data: Path) -> Measured:
    """Inputs by their names."""
    by_name = {Path(path).name: Path(path) for path in inputs}
    if "benchmark.json" not in by_name:
        raise DataError("plot speed: expected benchmark.json among the inputs")
    tables = [
        read_columns(by_name[name], (), "a table of the benchmark")
        if name in by_name
        else pd.DataFrame()
        for name in BESIDE
    ]
    runs = [Path(path) for path in inputs if Path(path).name == "summary.json"]
    summaries = [read_summary(path) for path in runs]
    benchmark = read_benchmark(by_name["benchmark.json"])
    by_case = {summary["case"]: summary for summary in summaries}
    return Measured(benchmark, *tables, by_case, _paper_seconds(data))


def _paper_seconds(data: Path) -> float:
    """Run time that Klerck 2004, section 3.1, states for the discrete punch [s]."""
    path = data / "klerck2004" / "parameters.csv"
    stated = read_columns(path, ("quantity", "value"), "what the paper states")
    hours = stated.loc[stated["quantity"] == "runtime_discrete_fracture", "value"]
    return 3600.0 * float(hours.iloc[0])


def read_benchmark(path: Path) -> dict:
    """What `benchmark.json` holds, with its rows.

    Raises
    ------
    FileError
        Where it is another file.
    """
    expected = "rows of the benchmark, each with name, elements and threads"
    found = read_json(path, expected)
    rows = found.get("rows")
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise FileError(f"{path}: rows: expected {expected}")
    lacking = [key for row in rows for key in ("name", "elements", "threads") if key not in row]
    if lacking:
        raise FileError(f"{path}: rows: one has no {lacking[0]!r}, expected {expected}")
    return found


def _of_bare(name: str, elements: int) -> Callable[[Measured], float | None]:
    return lambda measured: measured.row(name, elements).get("of_bare_kernel")


def _time_over(name: str, other: str, elements: int) -> Callable[[Measured], float | None]:
    def value(measured: Measured) -> float | None:
        damped, undamped = (_of_bare(each, elements)(measured) for each in (name, other))
        return None if undamped is None or damped is None else undamped / damped

    return value


def _gain(name: str, elements: int) -> Callable[[Measured], float | None]:
    return lambda measured: measured.row(name, elements, 2).get("speed_up")


def _time_of_two(name: str, elements: int) -> Callable[[Measured], float | None]:
    def value(measured: Measured) -> float | None:
        gain = _gain(name, elements)(measured)
        return None if gain is None else 1.0 / gain

    return value


def _returns(measured: Measured) -> float | None:
    row = measured.row("full_step_yielding_100", 50_000)
    return row.get("million_returns_per_core_second")


def _core_seconds(case: str) -> Callable[[Measured], float | None]:
    return lambda measured: measured.runs.get(case, {}).get("core_seconds")


def _paper_over_ours(measured: Measured) -> float | None:
    own = _core_seconds("punch_discrete")(measured)
    return None if own is None else measured.paper_seconds / own


def _memory(block: str) -> Callable[[Measured], float | None]:
    def value(measured: Measured) -> float | None:
        own = measured.benchmark.get("memory", {}).get(block, {})
        return own.get("peak_bytes_per_element")

    return value


def _other_bits(measured: Measured) -> float | None:
    table = measured.leave_out
    return None if table.empty else int((~table["same_bits"].astype(bool)).sum())


def _unused(measured: Measured) -> float | None:
    """Percent of an elastic step at 5,000 elements that is not for its elements."""
    table, row = measured.growth, measured.row("elastic_step", 5_000)
    if table.empty or not row:
        return None
    step = row["elements"] / row["million_element_steps_per_core_second"] / 1e6
    return 100.0 * float(table["at_no_element"].dropna().iloc[0]) / step


def _prediction(measured: Measured) -> float | None:
    """Largest factor between predicted and measured time of a continuum run."""
    if measured.leave_out.empty:
        return None
    own = measured.leave_out[measured.leave_out["continuum"].astype(bool)]["check_over_measured"]
    return float(pd.concat([own, 1.0 / own]).max())


TARGETS = (
    *(
        Target(
            f"{name} over the bare kernel, {elements:,} elements", _of_bare(name, elements), least
        )
        for name, least, sizes in (
            ("full_step", 0.6, (5_000, 50_000)),
            ("elastic_step", 0.8, (5_000, 50_000)),
            ("full_step_yielding_10", 0.3, (5_000, 50_000)),
            ("discrete_step_pairs_0.1", 0.25, (5_000, 50_000, 200_000)),
            ("discrete_step_full_0.1", 0.25, (5_000, 50_000, 200_000)),
            ("full_step", 0.5, (200_000,)),
        )
        for elements in sizes
    ),
    *(
        Target(
            f"time of {name} over {other}, {elements:,} elements", _time_over(name, other, elements)
        )
        for name, other in (
            ("full_step_damped", "full_step"),
            ("discrete_step_damped_0.1", "discrete_step_full_0.1"),
        )
        for elements in (5_000, 50_000, 200_000)
    ),
    Target("returns per core-second, every element yielding", _returns, 6.0, unit=" million"),
    *(
        Target(f"{name}: two threads over one, {elements:,} elements", _gain(name, elements), 1.6)
        for name in THREADED
        for elements in (50_000, 200_000)
    ),
    *(
        Target(
            f"{name}: time of two threads over one, 5,000 elements",
            _time_of_two(name, 5_000),
            most=1.05,
        )
        for name in THREADED
    ),
    Target("punch_discrete", _core_seconds("punch_discrete"), most=60.0, unit=" core-seconds"),
    Target("punch_discrete: time that the paper states over ours", _paper_over_ours),
    Target("punch_gf60", _core_seconds("punch_gf60"), most=30.0, unit=" core-seconds"),
    *(
        Target(f"memory at the peak, {block}", _memory(block), most=most, unit=BYTES)
        for block, most in (("continuum", 1e3), ("discrete_0.1", 1e3), ("discrete_0.5", None))
    ),
    Target("scenes whose bits hang on what is left out", _other_bits, most=0),
    Target("of an elastic step, all that is not for elements", _unused, most=2.0, unit=" %"),
    Target(
        "predicted over measured time of a continuum run, or its inverse", _prediction, most=WITHIN
    ),
)
