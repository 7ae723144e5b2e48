"""Elements that are recorded: the nearest centroid to a point."""

import numpy as np

from lithofrac.config.case import Case
from lithofrac.problem import Mesh


def probes(case: Case, mesh: Mesh, own: dict[str, tuple[float, float]]) -> dict[str, int]:
    """Probes of the scene and of the case file: name -> element.

    Parameters
    ----------
    own : points [m] of the scene itself; the case file may move or add to them
    """
    points = own | {name: probe.point for name, probe in case.probes.items()}
    centroids = mesh.centroids()
    return {
        name: int(np.argmin(((centroids - point) ** 2).sum(axis=1)))
        for name, point in points.items()
    }
