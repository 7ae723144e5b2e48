"""Error against cost: Pareto front, observed order, what an error costs."""

from __future__ import annotations

import numpy as np
import pandas as pd

TARGET = 1.0  # [%], error that a user is told the cost of
DEFAULT, FINEST = "default", "finest"  # in place of a knob, in a table of runs
SAME_COST = 1.02  # work over another at which a run counts as dearer
SAME_ERROR = 1.1  # error over that of the default up to which it counts as equal


def pareto_front(cost: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Runs that none is better than in one and as good in the other, cheapest first.

    Parameters
    ----------
    cost, error : (n,); where either is not finite the run is left out

    Returns
    -------
    Indices (k,); cost rises and error falls along them.
    """
    cost, error = np.asarray(cost, dtype=float), np.asarray(error, dtype=float)
    known = np.flatnonzero(np.isfinite(cost) & np.isfinite(error))
    by_cost = known[np.lexsort([error[known], cost[known]])]
    least = np.inf
    front = []
    for i in by_cost:
        if error[i] < least:
            front.append(i)
            least = error[i]
    return np.array(front, dtype=int)


def observed_order(size: np.ndarray, error: np.ndarray) -> float:
    """Slope of log error over log size, least squares; NaN with fewer than two errors above 0."""
    size, error = np.asarray(size, dtype=float), np.asarray(error, dtype=float)
    known = np.isfinite(error) & (error > 0.0) & np.isfinite(size)
    if len(np.unique(size[known])) < 2:
        return float("nan")
    return float(np.polyfit(np.log(size[known]), np.log(error[known]), 1)[0])


def safe_error(work: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Largest error of a run and of those that are dearer, along one knob.

    A knob may take the answer through the exact one on its way: an error that is small by such a
    chance does not count, since more work makes it larger again.

    Parameters
    ----------
    work : (n,) elements times steps
    error : (n,); NaN stays and counts as infinite for cheaper runs
    """
    work, error = np.asarray(work, dtype=float), np.asarray(error, dtype=float)
    bad = np.where(np.isfinite(error), error, np.inf)
    dearer = work[None, :] > SAME_COST * work[:, None]
    worst = np.where(dearer, bad[None, :], -np.inf).max(axis=1, initial=-np.inf)
    return np.where(np.isfinite(error), np.maximum(worst, error), np.nan)


def safe_errors(runs: pd.DataFrame) -> np.ndarray:
    """Errors [%] that are not small by chance (`safe_error`), knob by knob; the default's as it is.

    Parameters
    ----------
    runs : rows of one quantity of one problem in `accuracy.csv`, the default among them

    Returns
    -------
    (n,); infinite where a dearer run of the same knob has no number.
    """
    work = runs["elements"].to_numpy(float) * runs["steps"].to_numpy(float)
    error = runs["error_percent"].to_numpy(float)
    knob = runs["knob"].to_numpy()
    safe = error.copy()
    for name in set(knob) - {DEFAULT}:
        own = np.flatnonzero((knob == name) | (knob == DEFAULT))
        kept = own[knob[own] == name]
        safe[kept] = safe_error(work[own], error[own])[knob[own] == name]
    return safe


def cheapest(cost: np.ndarray, error: np.ndarray, target: float) -> int | None:
    """Index of the cheapest run whose error is at most `target`; None where there is none."""
    cost = np.where(np.asarray(error, dtype=float) <= target, cost, np.inf)
    return int(np.argmin(cost)) if len(cost) and np.isfinite(cost).any() else None


def distance(cost: np.ndarray, error: np.ndarray, default: int, target: float) -> float:
    """Cost of the default over the least that its aim costs.

    The aim is `target`; where the default misses that, its own error and a tenth of it.

    Parameters
    ----------
    cost, error : (n,) of all runs, the default among them
    default : its index
    """
    error = np.asarray(error, dtype=float)
    aim = max(target, SAME_ERROR * error[default])
    best = cheapest(cost, error, aim)
    return float("nan") if best is None else float(np.asarray(cost)[default] / cost[best])
