"""What moved against the references, and by how much."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.analysis.references import REALISATIONS, References, is_realisation
from lithofrac.analysis.runs import Run
from lithofrac.analysis.scalars import mesh_hash, scalars

KEY = ["case", "quantity"]


@dataclass(frozen=True)
class Comparison:
    """Numbers of today beside their references.

    meshes : case -> (hash of the references, hash of today), where they differ
    moved : columns of the references, with `now` and `allowed` [unit of the value]
    missing : columns `case`, `quantity`; numbers of the references that are not there today
    new : the same, numbers of today that have no reference
    compared : how many numbers stand on both sides
    """

    meshes: dict[str, tuple[str, str]]
    moved: pd.DataFrame
    missing: pd.DataFrame
    new: pd.DataFrame
    compared: int

    @property
    def drifted(self) -> bool:
        """Whether anything is not as it was; a number that is only new has not drifted."""
        return bool(self.meshes) or not self.moved.empty or not self.missing.empty


def compare(runs: list[Run], references: References, data: Path) -> Comparison:
    """Hold finished runs against references; other realisations among them are left out.

    Raises
    ------
    DataError
        When a run did not complete.
    """
    runs = [run for run in runs if not is_realisation(run)]
    now = scalars(runs, data).rename(columns={"value": "now"})
    both = references.numbers.merge(now[[*KEY, "now"]], on=KEY, how="outer", indicator=True)
    side = both["_merge"]
    common = both[side == "both"].drop(columns="_merge")
    allowed = np.where(common["kind"] == "relative", common["value"].abs(), 1.0)
    common = common.assign(allowed=allowed * common["tolerance"])
    hashes = {run.name: mesh_hash(run) for run in runs}
    return Comparison(
        {
            case: (mesh, hashes[case])
            for case, mesh in references.meshes.items()
            if case in hashes and hashes[case] != mesh
        },
        common[~_stays(common)].reset_index(drop=True),
        both.loc[side == "left_only", KEY].reset_index(drop=True),
        both.loc[side == "right_only", KEY].reset_index(drop=True),
        len(common),
    )


def sentences(found: Comparison, references: References) -> list[str]:
    """What a comparison found, line by line: meshes first, since a new mesh moves every number."""
    lines = [
        f"{case}: the mesh is another one ({old}, now {new}), so that every number of it may move"
        for case, (old, new) in found.meshes.items()
    ]
    for case, rows in found.moved.groupby("case", sort=False):
        lines.append(f"{case}:")
        for row in rows.itertuples():
            lines.append(
                f"  {row.quantity:<40} {_number(row.value):>15} -> {_number(row.now):<15}"
                f" {_amount(row.value, row.now):>12}, {_allowed(row)} ({row.reason})"
            )
    for what, table in {"missing": found.missing, "new, without a reference": found.new}.items():
        for case, rows in table.groupby("case", sort=False):
            names = ", ".join(rows["quantity"])
            lines.append(f"{case}: {what}: {names if len(rows) < 9 else f'{len(rows)} numbers'}")
    made = references.made
    lines.append(
        f"{found.compared} numbers compared: {len(found.moved)} moved,"
        f" {len(found.missing)} missing, {len(found.new)} new, {len(found.meshes)} meshes changed"
    )
    lines.append(
        f"references of {made['date']}, version {made['version']}, commit {made['commit']}:"
        f" {made['why']}"
    )
    return lines


def _stays(rows: pd.DataFrame) -> pd.Series:
    """Which numbers are where they may be; what was there may not vanish, however far counts
    spread."""
    bounded = rows["kind"] == "below"
    vanished = (rows["reason"] == REALISATIONS) & (rows["value"] > 0.0) & (rows["now"] == 0.0)
    change = (rows["now"] - rows["value"]).abs().where(~bounded, rows["now"].abs())
    both_nan = rows["now"].isna() & rows["value"].isna()
    stays = (change <= rows["allowed"]) | both_nan | np.isinf(rows["allowed"])
    return stays & ~vanished


def _number(value: float) -> str:
    return "none" if np.isnan(value) else f"{value:.9g}"


def _amount(old: float, new: float) -> str:
    """A change in percent, where there is something to take it of."""
    if np.isnan(old) or np.isnan(new):
        return ""
    return f"{new - old:+.3g}" if old == 0.0 else f"{100.0 * (new / old - 1.0):+.3g} %"


def _allowed(row) -> str:
    if row.kind == "below":
        return f"allowed below {row.allowed:.3g}"
    return f"allowed {row.allowed:.3g}"
