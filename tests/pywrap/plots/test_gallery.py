"""The picture at the top of the README (plots/gallery.py)."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection

from lithofrac.plots import gallery

pytestmark = pytest.mark.no_core


def test_specimen_stands_without_its_platens_and_with_its_cracks(make_cracked_run, data_folder):
    """48 elements of rock; outline of 20 mm and two faces of 3 mm, a little stretched."""
    folder = make_cracked_run("sandstone_plane_strain_p00", test="plane_strain", stiffness=0.02)
    curves, specimen, bar = gallery.figure([folder], data_folder).axes
    assert curves.get_xlabel() == "axial strain [%]"
    drawn = next(c for c in specimen.collections if isinstance(c, PolyCollection))
    assert len(drawn.get_array()) == 48
    lines = next(c for c in specimen.collections if isinstance(c, LineCollection))
    lengths = [np.linalg.norm(end - start) for start, end in lines.get_segments()]
    assert sum(lengths) == pytest.approx(26.0, rel=0.01)
    assert bar.get_xlabel() == "effective plastic strain at the end [-]"
