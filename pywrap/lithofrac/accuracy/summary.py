"""The sweep in short: a row for every quantity of every problem."""

from __future__ import annotations

import numpy as np
import pandas as pd

from lithofrac.accuracy.subject import Subject
from lithofrac.analysis.front import (
    DEFAULT,
    FINEST,
    TARGET,
    cheapest,
    distance,
    observed_order,
    safe_errors,
)

FAR = 1.5  # distance above which the default is explained
UNEXPLAINED = "NOT EXPLAINED"  # in place of the reason of a default that is far and has none
COLUMNS = (
    "problem",
    "quantity",
    "order_in_size",
    "default_error_percent",
    "default_core_seconds",
    "for_1_percent_take",
    "its_error_percent",
    "its_core_seconds",
    "distance",
    "reason",
)


def summarised(table: pd.DataFrame, subjects: dict[str, Subject]) -> pd.DataFrame:
    """Order, default and cheapest setting of every problem and quantity of `accuracy.csv`."""
    rows = [
        _row(subjects[problem], quantity, own.reset_index(drop=True))
        for (problem, quantity), own in table.groupby(["problem", "quantity"], sort=False)
    ]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def unexplained(summary: pd.DataFrame) -> list[str]:
    """One sentence for every default that is far from the front without a reason."""
    return [
        f"{row.problem}, {row.quantity}: the default lies {row.distance:.2g} from the front and "
        f"has no reason, expected at most {FAR}"
        for row in summary.itertuples()
        if row.reason == UNEXPLAINED
    ]


def _row(subject: Subject, quantity: str, own: pd.DataFrame) -> dict:
    runs = own[own["knob"] != FINEST].reset_index(drop=True)  # it is held against itself
    default = int(np.flatnonzero(runs["knob"] == DEFAULT)[0])
    cost, error = runs["core_seconds"].to_numpy(float), runs["error_percent"].to_numpy(float)
    safe = safe_errors(runs)
    best = cheapest(cost, safe, TARGET)
    far = distance(cost, safe, default, TARGET)
    return {
        "problem": subject.name,
        "quantity": quantity,
        "order_in_size": order_of(runs, subject),
        "default_error_percent": error[default],
        "default_core_seconds": cost[default],
        "for_1_percent_take": "none of these" if best is None else words(runs, best),
        "its_error_percent": np.nan if best is None else error[best],
        "its_core_seconds": np.nan if best is None else cost[best],
        "distance": far,
        "reason": subject.reasons.get(quantity, UNEXPLAINED) if far > FAR else "",
    }


def order_of(runs: pd.DataFrame, subject: Subject) -> float:
    """Observed order in the size of elements (or of the strain step), the default among them."""
    of_size = runs[runs["knob"].isin([subject.size, DEFAULT])]
    size = of_size["value"].where(of_size["knob"] != DEFAULT, subject.default[subject.size])
    return observed_order(size.astype(float).to_numpy(), of_size["error_percent"].to_numpy())


def words(runs: pd.DataFrame, row: int) -> str:
    """Setting of a run, as `element_size_mm = 2`."""
    knob, value = runs.loc[row, ["knob", "value"]]
    return "the default" if knob == DEFAULT else f"{knob} = {value}"
