"""Width of the zone in which plastic strain localises (Klerck 2004, section 3.2, Fig. 11)."""

import numpy as np

from lithofrac.analysis.frames import Frame

HEIGHT = 0.5  # of the strain that is typical of the zone: the width is that at half height
TOLERANCE = 1e-6  # [mm]: copies of a split node share their reference position


def localised(frame: Frame) -> np.ndarray:
    """Elements in which plastic strain has localised, (m,) bool.

    Those above half of the strain that the plastic strain weighs itself with, sum of e^2 A over
    sum of e A; none without plastic strain.
    """
    strain, area = frame.plastic_strain, frame.areas()
    if not np.any(strain > 0.0):
        return np.zeros(len(strain), dtype=bool)
    return strain > HEIGHT * (strain**2 * area).sum() / (strain * area).sum()


def band_width(frame: Frame) -> float:
    """Width of the localised bands, twice their area over their outline [mm].

    That is the width of a long strip, however it turns, and of several at once; a row of
    triangles is as wide as these are high. Faces of cracks are no outline. NaN without plastic
    strain.
    """
    chosen = localised(frame)
    if not chosen.any():
        return float("nan")
    zone = _whole(frame).part(chosen)
    edges = zone.nodes[zone.boundary()]
    length = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum()
    return float(2.0 * zone.areas().sum() / length)


def _whole(frame: Frame) -> Frame:
    """The same mesh with the copies of a split node made one again."""
    keys = np.round(frame.nodes / TOLERANCE).astype(np.int64)
    _, first, merged = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return Frame(
        frame.time_s,
        frame.nodes[first],
        frame.displacement[first],
        np.ravel(merged)[frame.triangles],
        frame.body,
        frame.plastic_strain,
    )
