"""Numbers that a suite is held to: how they are made, how far each may move, where they lie.

A folder of references holds

    numbers.csv   case, quantity, value, kind, tolerance, reason
    meshes.csv    case, mesh (a hash: with another mesh every number moves)
    updates.csv   date, version, commit, cases, numbers, why; a line for each time they were made

`kind` is what `tolerance` is: `relative` (of the value), `absolute` (unit of the value) or `below`
(the value itself stays below it). `reason` is one of the words below.
"""

import datetime
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.analysis.runs import Run
from lithofrac.analysis.scalars import ENERGY, mesh_hash, scalars
from lithofrac.data import DataError
from lithofrac.data.csv_file import read_columns

NUMBERS = ["case", "quantity", "value", "kind", "tolerance", "reason"]
MESHES = ["case", "mesh"]
UPDATES = ["date", "version", "commit", "cases", "numbers", "why"]
REALISATION = "@seed"  # NAME@seed2 is case NAME on another mesh

# Two builds of one source round differently (fused multiply-add). Where no crack opens that moves
# a number of the quick suite by 2e-10 at most; ten times a digit that anyone prints is 1e-6.
FLOOR = 1e-6
MARGIN = 3.0  # over a difference that was measured once
LIMIT = 1e-6  # of the energy residual in every run
OF_THE_MESH = ("elements", "nodes", "steps")  # counts that another realisation says nothing about

RESIDUAL = "energy_residual"  # all noise: only its size is watched

EXACT, ROUNDING, REALISATIONS = "exact", "rounding", "realisations"
COMES_AND_GOES = "comes and goes"  # there in one build and not in the other


@dataclass(frozen=True)
class References:
    """A folder of references, read."""

    numbers: pd.DataFrame
    meshes: dict[str, str]
    made: dict[str, str]  # the last line of updates.csv

    def of(self, cases: list[str]) -> "References":
        """References of these cases alone."""
        numbers = self.numbers[self.numbers["case"].isin(cases)].reset_index(drop=True)
        meshes = {case: mesh for case, mesh in self.meshes.items() if case in cases}
        return References(numbers, meshes, self.made)


def is_realisation(run: Run) -> bool:
    """Whether a run is of a case on another mesh than its own."""
    return REALISATION in run.name


def make(runs: list[Run], twins: list[Run], data: Path) -> tuple[pd.DataFrame, dict[str, str]]:
    """Values of runs, and how far each may move.

    Parameters
    ----------
    runs : of a portable build; NAME@seedN stands beside NAME for its spread
    twins : the same cases of a native build; what they differ by is rounding
    data : the folder `data/`

    Returns
    -------
    numbers : DataFrame with columns `NUMBERS`
    meshes : case -> hash

    Raises
    ------
    DataError
        When a run is of a native build, or a twin is missing, native=false or on another mesh.
    """
    own = [run for run in runs if not is_realisation(run)]
    _check_builds(runs, twins, own)
    meshes = {run.name: mesh_hash(run) for run in own}
    for twin in twins:
        if twin.name in meshes and mesh_hash(twin) != meshes[twin.name]:
            raise DataError(f"{twin.folder}: another mesh than that of {twin.name}, run both again")
    key = ["case", "quantity"]
    values = scalars(own, data)
    twin = scalars([run for run in twins if run.name in meshes], data).set_index(key)["value"]
    others = scalars([run for run in runs if is_realisation(run)], data)
    others["case"] = others["case"].str.split(REALISATION).str[0]
    spread = {name: rows["value"].to_numpy() for name, rows in others.groupby(key)}
    energies = values[values["quantity"].str.match(rf"{ENERGY}.*_J$")]
    largest = energies["value"].abs().groupby(energies["case"]).max()
    values["scale"] = (
        values["value"]
        .abs()
        .where(~values["quantity"].isin(energies["quantity"]), values["case"].map(largest))
    )
    values["twin"] = [
        twin.get(name, np.nan) for name in zip(*(values[k] for k in key), strict=True)
    ]
    values["rounding"] = (values["twin"] - values["value"]).abs()
    grown = values["rounding"] * MARGIN > FLOOR * values["scale"]
    amplified = set(values["case"][grown & (values["quantity"] != RESIDUAL)])
    rows = []
    for row in values.itertuples():
        name = (row.case, row.quantity)
        found = tolerance(row, spread.get(name, np.empty(0)), row.case in amplified)
        rows.append((*name, row.value + 0.0, *found))  # no minus zero
    return pd.DataFrame(rows, columns=NUMBERS), meshes


def tolerance(row, others: np.ndarray, amplified: bool) -> tuple[str, float, str]:
    """Kind, size and reason of the tolerance of one number.

    Counts and numbers that hang on single cracks get the spread of the realisations. Others get
    `FLOOR`, unless rounding comes near it: cracks amplify rounding, and then the spread of the
    realisations is what can be relied on.

    Parameters
    ----------
    row : `quantity`, `nature`, `value`, `twin` (of the native build), `rounding` between both, and
        `scale` of a relative difference: the value, of an energy the largest of its run
    others : of other realisations of the mesh
    amplified : whether rounding has grown in any number of the run, so that a count that agrees
        does so by chance
    """
    if np.isnan(row.value) != np.isnan(row.twin):
        return "absolute", np.inf, COMES_AND_GOES
    if np.isnan(row.value):
        return "absolute", 0.0, EXACT
    known = np.array([row.value, row.twin, *others[np.isfinite(others)]])
    if row.quantity == RESIDUAL:
        return "below", LIMIT, "limit"
    spread = max(float(np.ptp(known)), MARGIN * row.rounding)
    if row.nature != "number":
        alone = row.quantity in OF_THE_MESH or not others.size
        if alone and row.rounding == 0.0:
            return "absolute", 0.0, EXACT
        least = 1.0 if amplified and row.nature == "count" else 0.0
        return "absolute", max(spread, least), REALISATIONS
    if row.rounding * MARGIN > FLOOR * row.scale:
        return "absolute", spread, REALISATIONS
    if row.scale == abs(row.value):
        return "relative", FLOOR, ROUNDING
    return "absolute", FLOOR * row.scale, ROUNDING


def write(
    folder: Path, numbers: pd.DataFrame, meshes: dict[str, str], why: str, runs: list[Run]
) -> None:
    """Replace the references of a folder and add a line to its updates.

    Parameters
    ----------
    why : the reason, a sentence; kept
    runs : what the numbers are of, for version and commit; several commits are all named

    Raises
    ------
    DataError
        When there is no reason.
    """
    if not why.strip():
        raise DataError("references: no reason, expected --why with what moved the numbers and why")
    folder.mkdir(parents=True, exist_ok=True)
    line = {
        "date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        **{key: _all(run.summary.get(key) for run in runs) for key in ("version", "commit")},
        "cases": len(meshes),
        "numbers": len(numbers),
        "why": " ".join(why.split()),
    }
    log = folder / "updates.csv"
    before = [read_columns(log, UPDATES, "updates", dtype=str)] if log.exists() else []
    updates = pd.concat([*before, pd.DataFrame([line], columns=UPDATES).astype(str)])
    tables = {
        "numbers": numbers.sort_values(["case", "quantity"], kind="stable"),
        "meshes": pd.DataFrame(sorted(meshes.items()), columns=MESHES),
        "updates": updates,
    }
    for name, table in tables.items():
        part = folder / f".{name}.part"
        table.to_csv(part, index=False, float_format="%.10g")
        part.replace(folder / f"{name}.csv")


def read(folder: Path) -> References:
    """References of a folder.

    Raises
    ------
    DataError
        When a file is missing or lacks a column.
    """
    tables = {}
    for name, columns in {"numbers": NUMBERS, "meshes": MESHES, "updates": UPDATES}.items():
        path = folder / f"{name}.csv"
        if not path.is_file():
            raise DataError(f"{path}: no such file, expected references of `lithofrac references`")
        tables[name] = read_columns(
            path, columns, "references", ("value", "tolerance") if name == "numbers" else (),
            dtype=None if name == "numbers" else str,
        )  # fmt: skip
    meshes = dict(tables["meshes"][MESHES].itertuples(index=False))
    return References(tables["numbers"], meshes, tables["updates"].iloc[-1].to_dict())


def _all(words: Iterable[str | None]) -> str:
    """Distinct words in one string."""
    return " ".join(sorted({word or "unknown" for word in words}))


def _check_builds(runs: list[Run], twins: list[Run], own: list[Run]) -> None:
    """Portable runs, each case with a native twin."""
    for run in runs:
        if run.summary.get("native") is not False:
            raise DataError(
                f"{run.folder}: not of a native=false build, expected one: its bits are the same"
                " on every x86-64 since 2013 (python3 tasks.py portable)"
            )
    native = {run.name for run in twins if run.summary.get("native")}
    lost = [run.name for run in own if run.name not in native]
    if lost:
        raise DataError(
            f"{lost[0]}: no run of a native build beside it, expected one: it tells the rounding"
        )
