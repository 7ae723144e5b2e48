"""Estimate of the number of elements (pywrap/lithofrac/config/element_count.py)."""

import numpy as np
import pytest

from lithofrac.config import find_case
from lithofrac.config.element_count import element_count, platen_count
from lithofrac.scenes import make_mesh

pytestmark = pytest.mark.no_core


@pytest.mark.parametrize(
    ("name", "overrides"),
    [
        ("bar_wave", {}),
        ("kirsch", {}),
        ("kirsch", {"scene.far_elements_per_radius": 1.0}),
        ("sandstone_triaxial_p00", {}),
        ("sandstone_triaxial_p00", {"scene.whole_height": True}),
        ("sandstone_plane_strain_k02_p00", {"scene.element_size_mm": 1.0}),
        ("sandstone_plane_strain_p00", {"scene.element_size_mm": 1.0}),
        ("punch_gf60", {}),
        ("punch_gf60", {"scene.element_size_mm": 8.0}),
        ("brazilian", {}),
        ("single_element_sandstone", {}),
    ],
)
def test_the_estimate_is_that_of_the_mesh(name, overrides):
    case = find_case(name, None, overrides)
    mesh = make_mesh(case)
    made = np.count_nonzero(mesh.body == mesh.body_names.index("rock"))
    assert element_count(case.scene) == pytest.approx(made, rel=0.25)
    if case.platens is not None:
        others = len(mesh.triangles) - made
        assert platen_count(case.scene, case.platens) == pytest.approx(others, rel=0.25)
