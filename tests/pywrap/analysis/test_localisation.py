"""Width of bands of plastic strain (analysis/localisation.py)."""

import numpy as np
import pytest
from punch_runs import block

from lithofrac.analysis.frames import Frame
from lithofrac.analysis.localisation import band_width, localised

pytestmark = pytest.mark.no_core


def frame(strain_of, split=False):
    """Block of 8 x 8 mm in squares of 1 mm; `strain_of` takes centroids x, y [mm].

    `split` gives every element nodes of its own, as if each edge had cracked.
    """
    mesh = block()
    nodes, triangles = 1e3 * mesh.nodes, mesh.triangles
    if split:
        nodes, triangles = nodes[triangles.ravel()], np.arange(triangles.size).reshape(-1, 3)
    body = np.zeros(len(triangles), dtype=int)
    strain = strain_of(*(1e3 * mesh.centroids().T)).astype(float)
    return Frame(0.0, nodes, np.zeros_like(nodes), triangles, body, strain)


def column(x, y):
    return 0.1 * ((x > 2.0) & (x < 3.0))


def test_column_of_squares_is_as_wide_as_twice_its_area_over_its_outline():
    """8 x 1 mm: 16 / 18; it tends to 1 mm as the column grows."""
    assert band_width(frame(column)) == pytest.approx(16.0 / 18.0)


def test_two_bands_are_as_wide_as_one():
    def both(x, y):
        return column(x, y) + 0.1 * ((x > 5.0) & (x < 6.0))

    assert band_width(frame(both)) == pytest.approx(band_width(frame(column)))


def test_cracks_in_the_band_do_not_narrow_it():
    assert band_width(frame(column, split=True)) == pytest.approx(band_width(frame(column)))


def test_what_hardens_beside_the_band_does_not_widen_it():
    def hardened(x, y):
        return np.maximum(column(x, y), 0.002)

    assert localised(frame(hardened)).sum() == 16
    assert band_width(frame(hardened)) == pytest.approx(band_width(frame(column)))


def test_frame_without_plastic_strain_has_no_width():
    empty = frame(lambda x, y: np.zeros_like(x))
    assert np.isnan(band_width(empty)) and not localised(empty).any()
