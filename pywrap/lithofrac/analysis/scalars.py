"""Every number that a run ends with, and a mark of its mesh: what a regression watches."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.analysis.discrete import bands, cracks
from lithofrac.analysis.hole_tables import hole_initiation
from lithofrac.analysis.punch import punch
from lithofrac.analysis.runs import Run
from lithofrac.analysis.tables import kirsch, strength
from lithofrac.data import DataError
from lithofrac.problem import Mesh

# Of summary.json: what the machine was doing, and what says nothing of the rock.
OF_THE_MACHINE = (
    "core_seconds", "wall_seconds", "expected_seconds", "element_steps_per_core_second", "threads",
)  # fmt: skip
ENERGY = "energy."  # in front of the entries of the ledger at the end of the run
IS_NOISE = (f"{ENERGY}residual_J", f"{ENERGY}residual_relative")  # `energy_residual` bounds both
ROUNDED = 1e-9  # [m] node positions of a mesh count as equal to this


@dataclass(frozen=True)
class Table:
    """A table of the pipeline whose numbers are watched.

    make : as in `lithofrac plot`, from inputs and the folder `data/`
    scenes : kinds of scene it is about; none means that it picks its runs itself
    columns : numbers to watch
    keys : columns that tell apart the rows of a case
    nature : as in `scalars`
    """

    make: Callable[[list[Path], Path], pd.DataFrame]
    columns: tuple[str, ...]
    scenes: tuple[str, ...] = ()
    keys: tuple[str, ...] = ()
    nature: str = "number"


# What summary.json does not hold already.
TABLES = {
    "strength": Table(
        strength,
        ("strength_MPa", "strain_at_peak_percent", "largest_stress_MPa"),
        ("triaxial", "plane_strain"),
    ),
    "punch": Table(punch, ("first_peak_MPa", "lowest_after_peak_MPa", "largest_stress_MPa")),
    "cracks": Table(cracks, ("tensile_percent",), nature="picked"),
    "bands": Table(
        bands,
        ("band_angle_deg", "cracks_near_axis_percent", "median_crack_angle_deg"),
        nature="picked",
    ),
    "hole_initiation": Table(
        hole_initiation, ("initiation_MPa",), ("hole",), ("zone", "criterion")
    ),
    "kirsch": Table(kirsch, ("computed", "difference_percent"), ("hole_quarter",), ("point",)),
}


def scalars(runs: list[Run], data: Path) -> pd.DataFrame:
    """Numbers of finished runs: columns `case`, `quantity`, `value` and `nature`.

    The nature is `count`, `picked` (it hangs on single cracks and moves in jumps) or `number`. What
    a run does not have (a peak that never came) is NaN.

    Raises
    ------
    DataError
        When a run did not complete, or rows of a table cannot be told apart.
    """
    rows = [row for run in runs for row in _of_summary(run)]
    for name in TABLES:
        rows += table_rows(name, runs, data)
    found = pd.DataFrame(rows, columns=["case", "quantity", "value", "nature"])
    twice = found.duplicated(["case", "quantity"])
    if twice.any():
        case, quantity = found.loc[twice.idxmax(), ["case", "quantity"]]
        raise DataError(f"{case}: {quantity} is there twice, expected keys that tell rows apart")
    return found.astype({"value": float})


def mesh_hash(run: Run) -> str:
    """Mark of nodes, triangles, bodies and edge sets of the mesh of a run.

    Positions count to a nanometre, so that another order of sums in the mesher makes no new mesh.
    """
    mesh = Mesh.load(run.folder / "mesh.npz")
    digest = hashlib.sha256()
    parts = {
        "nodes": np.rint(mesh.nodes / ROUNDED),
        "triangles": mesh.triangles,
        "body": mesh.body,
        **{f"edges:{name}": mesh.edge_sets[name] for name in sorted(mesh.edge_sets)},
    }
    digest.update("\0".join(mesh.body_names).encode())
    for name, part in parts.items():
        digest.update(f"\0{name} {part.shape}\0".encode())
        digest.update(np.ascontiguousarray(part, dtype="<i8").tobytes())
    return digest.hexdigest()[:16]


def _of_summary(run: Run) -> list[tuple]:
    """Rows of `summary.json`."""
    summary = run.summary
    if summary["status"] != "completed":
        raise DataError(f"{run.folder}: status {summary['status']!r}, expected a completed run")
    ledger = {f"{ENERGY}{name}": value for name, value in summary["energy"].items()}
    rows = []
    for name, value in {**summary, **ledger}.items():
        if name in (*OF_THE_MACHINE, *IS_NOISE) or isinstance(value, str | bool | dict | list):
            continue
        nature = "count" if isinstance(value, int) else "number"
        rows.append((run.name, name, np.nan if value is None else value, nature))
    return rows


def table_rows(name: str, runs: list[Run], data: Path) -> list[tuple]:
    """Rows of one of `TABLES`, as in `scalars`; keys stand in brackets behind the column."""
    table = TABLES[name]
    asked = [run.folder for run in runs if not table.scenes or run.test in table.scenes]
    if not asked:
        return []
    rows = []
    for row in table.make(asked, data).to_dict("records"):
        which = ",".join(str(row[key]) for key in table.keys)
        for column in table.columns:
            quantity = f"{name}.{column}" + (f"[{which}]" if which else "")
            rows.append((row["case"], quantity, row[column], table.nature))
    return rows
