"""Elements that are recorded: the nearest centroid to a point."""

import numpy as np

from lithofrac.config.base import MM
from lithofrac.config.case import Case
from lithofrac.config.errors import ConfigError, one_line
from lithofrac.problem import Mesh


def probes(case: Case, mesh: Mesh, own: dict[str, tuple[float, float]]) -> dict[str, int]:
    """Probes of the scene and of the case file: name -> element.

    Parameters
    ----------
    own : points [m] of the scene itself; the case file may move or add to them

    Raises
    ------
    ConfigError
        When a point is farther than one element from the body.
    """
    points = own | {name: probe.point for name, probe in case.probes.items()}
    centroids = mesh.centroids()
    found = {}
    for name, point in points.items():
        element = int(np.argmin(((centroids - point) ** 2).sum(axis=1)))
        corners = mesh.nodes[mesh.triangles[element]]
        away, size = _distance(corners, np.array(point))
        if away > size:
            x, y = (f"{value / MM:g}" for value in point)
            where = f"probes.{one_line(name)} = ({x}, {y}) mm"
            raise ConfigError(
                f"{where}: lies {away / MM:.3g} mm outside of the body, "
                f"expected at most one element, {size / MM:.3g} mm"
            )
        found[name] = element
    return found


def _distance(corners: np.ndarray, point: np.ndarray) -> tuple[float, float]:
    """Distance of a point from a counter-clockwise triangle, and its longest edge [m]."""
    edges = np.roll(corners, -1, axis=0) - corners
    to_point = point - corners
    lengths = np.hypot(*edges.T)
    if np.all(edges[:, 0] * to_point[:, 1] >= edges[:, 1] * to_point[:, 0]):
        return 0.0, lengths.max()
    along = np.clip((to_point * edges).sum(axis=1) / lengths**2, 0.0, 1.0)
    return np.hypot(*(to_point - along[:, None] * edges).T).min(), lengths.max()
