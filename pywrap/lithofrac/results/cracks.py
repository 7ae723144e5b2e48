"""Cracks and fragments of a run as tables."""

from __future__ import annotations

import numpy as np
import pandas as pd

from lithofrac.core import Run

COMPRESSIVE = 0.5  # share of the dissipation above which a crack is one of compressive dilation


def crack_table(run: Run) -> pd.DataFrame:
    """One row for each opened edge; reference positions, end 1 is the failed node."""
    rows = run.cracks()
    direction = np.degrees(rows[:, 7])
    ends = ["x1_mm", "y1_mm", "x2_mm", "y2_mm", "length_mm"]
    return pd.DataFrame(
        {
            "time_s": rows[:, 0] * run.dt,
            "step": rows[:, 0].astype(int),
            "crack": rows[:, 1].astype(int),
            **{name: 1e3 * rows[:, 2 + i] for i, name in enumerate(ends)},
            "direction_deg": direction - 180.0 * np.ceil((direction - 90.0) / 180.0),
            "failure_factor": rows[:, 8],
            "agreement": rows[:, 9],
            "mode": np.where(rows[:, 10] > COMPRESSIVE, "compressive_dilation", "tensile"),
            "compressive_share": rows[:, 10],
            "end": np.where(rows[:, 11] > 0, "through", "tip"),
            "way": np.where(rows[:, 12] > 0, "cut", "edge"),
            "fallback": rows[:, 13] > 0,
            "release_steps": rows[:, 14].astype(int),
            "body": rows[:, 15].astype(int) - 1,
        }
    )


FRAGMENT_COLUMNS = [
    "time_s",
    "fragment",
    "body",
    "elements",
    "area_mm2",
    "mass_kg",
    "x_mm",
    "y_mm",
    "vx_m_s",
    "vy_m_s",
]


def fragments(run: Run) -> np.ndarray:
    """Parts that have come loose from their bodies, (k, 10); columns as `FRAGMENT_COLUMNS`.

    The largest part of a body is the body itself. Mass is per metre of depth.
    """
    part = run.parts()
    nodes, triangles, body, alive = run.mesh()
    displacement, velocity, _ = run.nodes()
    corners = nodes[triangles]
    ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.where(alive, 0.5 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]), 0.0)
    density = np.array([material.density for material in run.problem.materials])
    where = (nodes + displacement)[triangles].mean(axis=1)
    speed = velocity[triangles].mean(axis=1)
    main = set()
    for number in np.unique(body):
        labels = part[alive & (body == number)]
        sizes = np.bincount(labels, weights=area[alive & (body == number)])
        main.add(int(sizes.argmax()))
    rows = []
    for label in np.unique(part[alive]):
        if int(label) in main:
            continue
        chosen = part == label
        mass = area[chosen] * density[body[chosen]]
        centre = np.average(where[chosen], axis=0, weights=mass)
        mean = np.average(speed[chosen], axis=0, weights=mass)
        rows.append(
            [
                run.step * run.dt,
                label,
                body[label],
                chosen.sum(),
                1e6 * area[chosen].sum(),
                mass.sum(),
                *(1e3 * centre),
                *mean,
            ]
        )
    return np.array(rows).reshape(-1, len(FRAGMENT_COLUMNS))


def fragment_table(rows: np.ndarray) -> pd.DataFrame:
    """Name the columns of rows that `fragments` gave."""
    table = pd.DataFrame(rows, columns=FRAGMENT_COLUMNS)
    return table.astype({"fragment": int, "body": int, "elements": int})
