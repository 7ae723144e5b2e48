"""Where the cracks of a run stand in the mesh of a frame."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.spatial import cKDTree

from lithofrac.analysis.frames import Frame

TOLERANCE = 1e-6  # [mm], rounding of positions written in metres and in millimetres


@dataclass(frozen=True)
class Faces:
    """Both faces of the cracks in a frame.

    Attributes
    ----------
    edges : (k, 2) nodes of the frame, material on their left
    crack : (k,) position of each edge's row in the table of cracks
    other : (l, 2) all other boundary edges
    lost : rows of the table that have opened by then but have no face, (n,)
    """

    edges: np.ndarray
    crack: np.ndarray
    other: np.ndarray
    lost: np.ndarray


def find_faces(frame: Frame, cracks: pd.DataFrame) -> Faces:
    """Boundary edges of a frame that lie on a crack opened by then.

    An edge belongs to a crack when both of its ends lie on it in the reference state. So an edge
    that has been cut in two since it opened is found in pieces.

    Parameters
    ----------
    frame : mesh of a moment
    cracks : rows as in `cracks.parquet`
    """
    edges = frame.boundary()
    opened = np.flatnonzero(cracks["time_s"].to_numpy() <= frame.time_s * (1 + 1e-9))
    if opened.size == 0:
        none = np.zeros(0, dtype=int)
        return Faces(edges[:0], none, edges, none)
    start = cracks[["x1_mm", "y1_mm"]].to_numpy()[opened]
    along = cracks[["x2_mm", "y2_mm"]].to_numpy()[opened] - start
    length = np.linalg.norm(along, axis=1)
    near = cKDTree(frame.nodes[edges].mean(axis=1)).query_ball_point(
        start + 0.5 * along, 0.5 * length + TOLERANCE
    )
    row = np.repeat(np.arange(len(near)), [len(found) for found in near])
    edge = np.concatenate(near).astype(int)
    on_it = np.ones(len(row), dtype=bool)
    for end in (0, 1):
        offset = frame.nodes[edges[edge, end]] - start[row]
        unit = along[row] / length[row, None]
        forward = (offset * unit).sum(axis=1)
        aside = offset[:, 0] * unit[:, 1] - offset[:, 1] * unit[:, 0]
        on_it &= np.abs(aside) <= TOLERANCE
        on_it &= (forward >= -TOLERANCE) & (forward <= length[row] + TOLERANCE)
    edge, first = np.unique(edge[on_it], return_index=True)
    row = row[on_it][first]
    other = np.delete(edges, edge, axis=0)
    lost = np.setdiff1d(np.arange(len(opened)), row)
    return Faces(edges[edge], opened[row], other, opened[lost])
