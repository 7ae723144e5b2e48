"""Numbers behind the figures, from results with a strength known exactly (analysis/tables.py)."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import yaml

from lithofrac.analysis import tables
from lithofrac.analysis.kirsch_series import plate
from lithofrac.analysis.runs import Run

pytestmark = pytest.mark.no_core
BANDS = Path(__file__).parents[3] / "reports" / "bands.csv"


def test_strength_is_compared_with_the_line_of_its_own_table(make_run, data_folder):
    runs = [make_run("sandstone_triaxial_p10", confinement=10.0, factor=1.02)]
    row = tables.strength(runs, data_folder).iloc[0]
    assert row["table_1_line_MPa"] == pytest.approx(186.9, abs=0.05)
    assert row["above_line_percent"] == pytest.approx(2.0, abs=1e-9)


def test_run_without_a_fall_is_marked_no_peak(make_run, data_folder):
    runs = [make_run("stiff", "plane_strain", stiffness=0.05, peak=False)]
    row = tables.strength(runs, data_folder).iloc[0]
    assert row["note"] == "no peak"
    assert np.isnan(row["strength_MPa"])


def test_confining_stage_is_no_part_of_the_curve(make_run):
    run = Run(make_run("sandstone_triaxial_p10", confinement=10.0))
    assert run.history["axial_strain"].iloc[0] == 0.0
    assert run.family == "sandstone_triaxial"
    assert Run(run.folder.parent / "sandstone_plane_strain_k01_p05").family == (
        "sandstone_plane_strain_k01"
    )


def test_single_element_meets_its_closed_form(make_bench, data_folder):
    paths = [make_bench("quartzite", 10), make_bench("sandstone", 5, factor=0.99)]
    table = tables.single_element(paths, data_folder)
    np.testing.assert_allclose(table["difference_percent"], [0.0, -1.0], atol=1e-9)
    assert list(table["rock"]) == ["quartzite", "sandstone"]


def test_first_yield_and_residual_are_those_of_the_curve(make_bench, data_folder):
    """A curve that yields at 60 and ends at 7 MPa, unlike the closed form of its rock."""
    path = make_bench("sandstone", 0)
    curve = pd.read_parquet(path).iloc[:5]
    curve["plastic_strain"] = [0.0, 0.0, 1e-4, 3e-4, 9e-4]
    curve["axial_stress_MPa"] = [0.0, 59.0, 62.0, 66.0, 7.0]
    curve.to_parquet(path)
    row = tables.single_element([path], data_folder).iloc[0]
    assert row["first_yield_MPa"] == pytest.approx(60.0)
    assert row["residual_MPa"] == 7.0
    assert row["closed_form_first_yield_MPa"] == pytest.approx(54.06, abs=0.005)
    assert row["closed_form_residual_MPa"] == pytest.approx(0.0, abs=1e-9)


def test_curve_that_stays_elastic_has_no_first_yield(make_bench, data_folder):
    path = make_bench("sandstone", 0)
    pd.read_parquet(path).assign(plastic_strain=0.0).to_parquet(path)
    assert np.isnan(tables.single_element([path], data_folder)["first_yield_MPa"].iloc[0])


def test_table_1_quartzite_leaves_the_range_of_tautona_at_high_confinement(make_bench, data_folder):
    make_bench("quartzite", 0)  # moves to the folder in which rocks are found
    table = tables.tautona(["quartzite"], data_folder).set_index("confinement_MPa")
    assert table.loc[20, "table_1_line_MPa"] == pytest.approx(277.8, abs=0.05)
    assert table.loc[120, "table_1_line_MPa"] == pytest.approx(873.7, abs=0.05)
    assert list(table["within_range"]) == ["yes", "no", "no", "no", "no"]


def test_zigong_line_predicts_a_point_left_out_within_its_stated_error(data_folder):
    table = tables.zigong([], data_folder)
    assert table["difference_percent"].abs().max() < 10.0
    assert tables.zigong_fit([], data_folder)["value"].iloc[1] == pytest.approx(3.685, abs=0.05)


def test_errors_say_so_when_nothing_is_digitised(make_run, data_folder):
    table = tables.errors([make_run("sandstone_triaxial_p10", confinement=10.0)], data_folder)
    assert list(table["figure"]) == ["9", "10"]
    assert set(table["series"]) == {"experiment: not digitised"}


def test_errors_measure_a_digitised_curve_once_it_is_there(make_run, digitise):
    """The curve is that of the run, 5 MPa higher."""
    folder = make_run("sandstone_triaxial_p10", confinement=10.0)
    history = Run(folder).history.iloc[10:200:10]
    points = zip(100 * history["axial_strain"], history["axial_stress_MPa"] + 5.0, strict=True)
    table = tables.errors([folder], digitise(list(points)))
    row = table[table["figure"] == "9"].iloc[0]
    assert row["series"] == "triaxial, 10 MPa"
    assert row["rms_MPa"] == pytest.approx(5.0, rel=1e-6)
    assert (row["points"], row["points_left_out"]) == (19, 0)
    assert row["reading_error_MPa"] == 2.0
    assert list(table[table["figure"] == "10"]["series"]) == ["experiment: not digitised"]


def test_curve_of_a_case_that_was_not_run_is_listed_without_an_error(make_run, digitise):
    folder = make_run("sandstone_triaxial_p00")
    row = tables.errors([folder], digitise([(0.1, 20.0)])).iloc[0]
    assert (row["points"], row["points_left_out"]) == (0, 1)
    assert np.isnan(row["rms_MPa"])


def test_strengths_of_figure_10_are_compared_between_the_confinements_run(make_run, digitise):
    runs = [make_run("sandstone_triaxial_p00"), make_run("sandstone_triaxial_p10", confinement=10)]
    between = 0.5 * sum(Run(run).peak.stress for run in runs)
    data = digitise(
        [(5.0, between + 3.0)],
        figure="10",
        compare_with="sandstone_triaxial",
        x={"unit": "MPa", "printed_min": 0, "printed_max": 40},
    )
    table = tables.errors(runs, data)
    assert table[table["figure"] == "10"]["rms_MPa"].iloc[0] == pytest.approx(3.0)


def test_hoop_stress_is_held_against_the_plate_of_the_blocks_own_width(
    tmp_path, monkeypatch, data_folder
):
    """Elements at crown and sidewall that hold 1.1 times the stress of the finite plate."""
    centres = np.array([[0.0, 26e-3], [26e-3, 0.0]])  # [m], hole of 25 mm
    exact = plate(4.0, 4.0).stress(*centres.T / 25e-3)
    folder = tmp_path / "kirsch"
    folder.mkdir()
    hoop = {"stress_xx_MPa": -2.2 * exact[0], "stress_yy_MPa": -2.2 * exact[1]}
    probes = {"probe": ["crown", "sidewall"], "element": [0, 1], "time_s": 1.0, **hoop}
    probes["plastic_strain"] = 0.0
    pd.DataFrame(probes).to_parquet(folder / "probes.parquet")
    scene = {"kind": "hole_quarter", "hole_radius_mm": 25.0, "block_over_radius": 8.0}
    case = {"scene": scene, "loading": {"stress_MPa": 2.0}}
    (folder / "case.yaml").write_text(yaml.safe_dump(case))
    mesh = SimpleNamespace(centroids=lambda: centres)
    monkeypatch.setattr(tables.Mesh, "load", lambda path: mesh)
    table = tables.kirsch([folder], data_folder).set_index("point")
    np.testing.assert_allclose(table["difference_percent"], 10.0)
    assert table.loc["sidewall", "finite_plate"] > table.loc["sidewall", "infinite_plate"] > 2.5
    assert table.loc["crown", "finite_plate"] < table.loc["crown", "infinite_plate"] < -0.5


def test_run_time_lists_what_the_summary_holds(make_run, data_folder):
    row = tables.run_time([BANDS, make_run("sandstone_triaxial_p00")], data_folder).iloc[0]
    assert (row["case"], row["steps"], row["wall_seconds"]) == (
        "sandstone_triaxial_p00",
        100000,
        6.0,
    )
