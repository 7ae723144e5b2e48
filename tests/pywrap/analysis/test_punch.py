"""Numbers of the punch curves (analysis/punch.py)."""

import numpy as np
import pytest

from lithofrac.analysis.punch import punch
from lithofrac.analysis.runs import Run

pytestmark = pytest.mark.no_core


def test_peak_fall_and_end_are_those_of_the_curve(make_cracked_run, data_folder):
    folder = make_cracked_run("punch_discrete", test="punch", confinement=4.5)
    row = punch([folder], data_folder).iloc[0]
    assert row["first_peak_MPa"] == row["largest_stress_MPa"] == Run(folder).peak.stress
    assert row["lowest_after_peak_MPa"] == pytest.approx(row["stress_at_end_MPa"])
    assert row["lowest_after_peak_MPa"] < 0.5 * row["first_peak_MPa"]
    assert (row["fracture"], row["compressive_failure"], row["note"]) == (
        "inter-element",
        "on",
        "no regain",
    )
    assert row["a_to_b_percent"] == pytest.approx(
        100.0 * (1.0 - row["lowest_after_peak_MPa"] / row["first_peak_MPa"])
    )
    assert np.isnan(row["b_to_c_percent"]) and row["strain_at_d_percent"] > 0.0


def test_curve_that_never_falls_has_no_peak(make_run, data_folder):
    row = punch([make_run("punch_gf1200", test="punch", peak=False)], data_folder).iloc[0]
    assert (row["fracture"], row["note"]) == ("off", "no peak")
    assert np.isnan(row["first_peak_MPa"]) and np.isnan(row["lowest_after_peak_MPa"])
    assert row["stress_at_end_MPa"] == row["largest_stress_MPa"]


def test_other_scenes_are_left_out(make_run, data_folder):
    table = punch([make_run("sandstone_triaxial_p00")], data_folder)
    assert table.empty
    assert "first_peak_MPa" in table
