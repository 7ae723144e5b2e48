"""The table of a study: a row a run, a column for each overridden key and each quantity."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from lithofrac.analysis.runs import Run, find_runs
from lithofrac.analysis.scalars import ENERGY, TABLES, table_rows
from lithofrac.config.errors import suggestion
from lithofrac.config.study import Study, load_study
from lithofrac.data import DataError
from lithofrac.results.columns import ENERGY_COLUMNS

HEAD = ("case", "realisation")  # columns in front
# Numbers of summary.json.
SUMMARY = (
    "elements",
    "nodes",
    "steps",
    "time_step_min_s",
    "time_step_max_s",
    "time_step_continuum_s",
    "threads",
    "core_seconds",
    "expected_seconds",
    "wall_seconds",
    "element_steps_per_core_second",
    "energy_residual",
    "peak_stress_MPa",
    "peak_strain",
    "kinetic_ratio_at_peak",
    "damping_over_external",
    "max_plastic_strain",
    "cracks",
    "fragments",
    "crack_length_mm",
    "crack_fallbacks",
    "crack_nodes_without_way",
    "most_resets_of_an_element",
    "max_penetration_over_h",
    "contact_pairs_max",
    "contact_sweeps_mean",
    "contact_unconverged_steps",
)
OF_A_TABLE = re.compile(r"(?P<table>\w+)\.(?P<column>\w+)(?P<keys>\[[^\]]*\])?\Z")


def check_quantities(study: Study, file: Path) -> None:
    """Refuse a quantity that no run has, before any is started.

    Raises
    ------
    DataError
        With one sentence per quantity, one per line.
    """
    known = [*SUMMARY, *(f"{ENERGY}{name}" for name in ENERGY_COLUMNS)]
    known += [f"{name}.{column}" for name, table in TABLES.items() for column in table.columns]
    wrong = []
    for i, quantity in enumerate(study.quantities):
        said = f"{file}: quantities.{i} = {quantity}:"
        found = OF_A_TABLE.match(quantity)
        plain = f"{found['table']}.{found['column']}" if found else quantity
        if plain not in known:
            wrong.append(f"{said} no such quantity, {suggestion(plain, known)}")
            continue
        keys = TABLES[found["table"]].keys if found and found["table"] in TABLES else ()
        given = found["keys"][1:-1].split(",") if found and found["keys"] else []
        if len(given) != len(keys):
            shape = f"{plain}[{','.join(keys)}]" if keys else plain
            wrong.append(f"{said} expected {shape}")
    if wrong:
        raise DataError("\n".join(wrong))


def study_table(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Table of a study from its file and its runs.

    Parameters
    ----------
    inputs : the study file (`.yaml`), and `summary.json` or folders of its runs
    data : the folder `data/`

    Returns
    -------
    DataFrame
        `case`, `realisation`, overridden keys by their dotted names, quantities by theirs; rows in
        the order of the study. NaN where a run has no such number (a peak that never came).

    Raises
    ------
    DataError
        When there is no study file, a run of the study is missing, or one did not complete.
    """
    file, study = study_of(inputs)
    check_quantities(study, file)
    runs = {run.name: run for run in find_runs([p for p in inputs if Path(p) != file])}
    missing = [name for name in study.names if name not in runs]
    if missing:
        raise DataError(f"{file}: {missing[0]}: its run is not among the inputs, expected all runs")
    own = [runs[name] for name in study.names]
    for run in own:
        if run.summary["status"] != "completed":
            raise DataError(
                f"{run.folder}: status {run.summary['status']!r}, expected a completed run"
            )
    tables = _tables(study, own, data)
    rows = [
        {
            **dict(zip(HEAD, (run.name, study.realisation(run.name)), strict=True)),
            **{key: _value(study, run, key) for key in study.keys},
            **{name: _quantity(run, name, tables) for name in study.quantities},
        }
        for run in own
    ]
    table = pd.DataFrame(rows)
    for key in study.keys:  # one type a column, which Parquet asks for
        if table[key].map(type).nunique() > 1 and not _numbers(table[key]):
            table[key] = table[key].map(str)
    return table.astype({name: float for name in study.quantities})


def study_of(inputs: list[Path]) -> tuple[Path, Study]:
    """The study file among the inputs of a plot, and the study."""
    files = [Path(path) for path in inputs if Path(path).suffix in (".yaml", ".yml")]
    if len(files) != 1:
        raise DataError(f"plot study: {len(files)} .yaml files among the inputs, expected one")
    return files[0], load_study(files[0])


def _tables(study: Study, runs: list[Run], data: Path) -> dict[tuple[str, str], float]:
    """(case, quantity) -> value, of those tables alone that the study asks for."""
    asked = dict.fromkeys(name.split(".")[0] for name in study.quantities)
    rows = [row for name in asked if name in TABLES for row in table_rows(name, runs, data)]
    return {(case, quantity): value for case, quantity, value, _ in rows}


def _quantity(run: Run, name: str, tables: dict[tuple[str, str], float]) -> float:
    """Number of a run; NaN where it has none."""
    if name in SUMMARY:
        value = run.summary.get(name)
    elif name.startswith(ENERGY):
        value = run.summary["energy"].get(name.removeprefix(ENERGY))
    else:
        value = tables.get((run.name, name))
    return np.nan if value is None else float(value)


def _value(study: Study, run: Run, key: str) -> Any:
    """Value of a dotted key in a run: its own override, else that of the case as it was run."""
    value = study.overrides(run.name).get(key, run.case)
    if value is run.case:
        for word in key.split("."):
            value = value.get(word) if isinstance(value, dict) else None
    return value if value is None or np.isscalar(value) else json.dumps(value)


def _numbers(column: pd.Series) -> bool:
    """Whether all entries are numbers, or missing."""
    return all(
        value is None or (isinstance(value, int | float) and not isinstance(value, bool))
        for value in column
    )
