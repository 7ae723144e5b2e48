"""Plane strain at several lateral stiffnesses (plots/stiffness.py)."""

import pytest

from lithofrac.data import DataError
from lithofrac.plots import stiffness

pytestmark = pytest.mark.no_core


def test_panels_are_the_lowest_middle_and_highest_confinement_with_most_stiffnesses(
    make_run, data_folder
):
    runs = [
        make_run(f"sandstone_plane_strain_k{k}_p{p}", "plane_strain", p, k / 100.0)
        for k in (1, 5)
        for p in (0, 5, 10, 20)
    ]
    runs.append(make_run("sandstone_plane_strain_k2_p40", "plane_strain", 40.0, 0.02))
    figure = stiffness.figure(runs, data_folder)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["0 MPa", "10 MPa", "20 MPa"]
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words == ["0.01 E", "0.02 E", "0.05 E", "continuum"]
    assert figure.axes[0].get_ylabel() == "axial stress [MPa]"


def test_hard_sides_do_not_set_the_scale(make_run, data_folder):
    runs = [
        make_run("sandstone_plane_strain_k02_p00", "plane_strain", 0.0, 0.02),
        make_run("sandstone_plane_strain_steel_p00", "plane_strain", 0.0, 100.0, factor=5.0),
    ]
    top = stiffness.figure(runs, data_folder).axes[0].get_ylim()[1]
    assert 100.0 < top < 200.0


def test_runs_of_other_tests_are_no_sweep(make_run, data_folder):
    with pytest.raises(DataError, match="no run in plane strain"):
        stiffness.figure([make_run("sandstone_triaxial_p00")], data_folder)
