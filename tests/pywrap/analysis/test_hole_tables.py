"""Tables and checks of the hole scene (analysis/hole_tables.py, hole_checks.py)."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from lithofrac.analysis import hole_theory as theory
from lithofrac.analysis.hole_checks import CONVERGED, ELASTIC, NOT_CONVERGED, hole_checks
from lithofrac.analysis.hole_tables import hole_initiation, predicted, size_effect
from lithofrac.analysis.size_law import hole_fits
from lithofrac.analysis.verdict import FAILS, HOLDS, OPEN
from lithofrac.config.material import Material

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]
NULL = "null test"
BANDS = ROOT / "reports" / "bands.csv"
TENSILE = (12.0, 0.0, 1.1, "tensile")


def cell(table, column, **keys):
    for key, value in keys.items():
        table = table[table[key] == value]
    assert len(table) == 1
    return table[column].iloc[0]


def test_every_run_has_a_row_for_each_zone_and_criterion(make_hole, data_folder):
    folders = [make_hole("hole_r25.0"), make_hole("hole_r06.4", radius_mm=6.4)]
    table = hole_initiation(folders, data_folder)
    assert len(table) == 2 * 3 * 3
    assert list(table["radius_mm"].unique()) == [6.4, 25.0]
    assert (table["largest_stress_MPa"] == 24.0).all()
    found = table.dropna(subset="initiation_MPa")
    assert (found["low_MPa"] <= found["initiation_MPa"]).all()
    assert (found["initiation_MPa"] <= found["high_MPa"]).all()


def test_table_that_is_there_is_read_instead_of_made_again(make_hole, data_folder, tmp_path):
    folder, file = make_hole("hole_r25.0"), tmp_path / "hole_initiation.csv"
    made = hole_initiation([folder], data_folder)
    made.to_csv(file, index=False)
    read = hole_initiation([file, folder], data_folder)
    pd.testing.assert_frame_equal(read, made)
    pd.testing.assert_frame_equal(
        size_effect([file, folder], data_folder), size_effect([folder], data_folder)
    )


def test_size_effect_holds_mean_and_range_of_the_realisations(make_hole, data_folder):
    folders = [
        make_hole(f"hole_r25.0{seed}", cracks=[(stress, 0.0, 1.1, "tensile")])
        for seed, stress in (("", 12.0), ("@seed2", 15.0), ("@seed3", 12.6))
    ]
    table = size_effect(folders, data_folder)
    own = table[(table["zone"] == "primary") & (table["criterion"] == "crack")].iloc[0]
    assert (own["runs"], own["found"]) == (3, 3)
    assert own["mean_MPa"] == pytest.approx(13.2)
    assert (own["min_MPa"], own["max_MPa"]) == (pytest.approx(12.0), pytest.approx(15.0))


def test_event_of_a_failed_block_counts_as_not_found(make_hole, data_folder):
    folder = make_hole("hole_r25.0", cracks=[(25.0, 0.0, 1.1, "tensile")])
    keys = {"zone": "primary", "criterion": "crack"}
    assert cell(hole_initiation([folder], data_folder), "initiation_MPa", **keys) > 0.0
    assert cell(size_effect([folder], data_folder), "found", **keys) == 0


def test_variants_and_null_tests_are_no_size_effect(make_hole, data_folder):
    names = ["hole_r25.0", "hole_r25.0_fine", "hole_null_r25.0", "hole_mesh1mm_r25.0"]
    table = size_effect([make_hole(name) for name in names], data_folder)
    assert list(table["series"].unique()) == ["similar", "mesh1mm"]


def test_theory_stands_beside_the_zones_it_speaks_of():
    rock = Material.load(ROOT / "configs" / "materials" / "tyndall_limestone.yaml")
    primary = predicted("primary", rock, 25.0)
    assert primary.kirsch == pytest.approx(1.5)
    coupled = theory.primary_coupled(1.5e6, 21e9, 0.3, 9.0, 25e-3)[0]
    assert primary.coupled == pytest.approx(coupled / 1e6)
    assert predicted("sidewall", rock, 25.0).kirsch == pytest.approx(10.08, abs=0.01)
    assert np.isnan(predicted("remote", rock, 25.0).kirsch)


def test_fit_needs_four_radii(make_hole, data_folder):
    folders = [make_hole(f"hole_r{r:04.1f}", radius_mm=r) for r in (1.6, 6.4, 25.0)]
    table = hole_fits(folders, data_folder)
    assert set(table["note"]) == {"fewer than 4 radii"}


def test_radius_at_which_a_realisation_stays_whole_is_left_out_of_the_fit(make_hole, data_folder):
    radii = (3.2, 6.4, 12.7, 25.0)
    folders = [make_hole(f"hole_r{r:04.1f}", radius_mm=r, cracks=[TENSILE]) for r in radii]
    keys = {"zone": "primary", "criterion": "crack"}
    assert cell(hole_fits(folders, data_folder), "points", **keys) == 4
    folders.append(make_hole("hole_r03.2@seed2", radius_mm=3.2))
    assert cell(hole_fits(folders, data_folder), "points", **keys) == 3


def test_equal_null_runs_hold_and_different_ones_do_not(make_hole, data_folder):
    same = [make_hole(f"hole_null_r{r:04.1f}", radius_mm=r, cracks=[TENSILE]) for r in (1.6, 6.4)]
    table = hole_checks([BANDS, *same], data_folder)
    own = table[(table["zone"] == "primary") & (table["check"] == NULL)].set_index("criterion")
    assert set(own.loc["crack", "verdict"]) == {HOLDS}
    later = make_hole("hole_null_r25.0", cracks=[(14.0, 0.0, 1.1, "tensile")])
    table = hole_checks([BANDS, *same, later], data_folder)
    own = table[(table["zone"] == "primary") & (table["check"] == NULL)].set_index("criterion")
    assert list(own.loc["crack", "verdict"]) == [FAILS] * 3
    base = make_hole("hole_r25.0", cracks=[(14.0, 0.0, 1.1, "tensile")])
    table = hole_checks([BANDS, *same, base], data_folder)
    own = table[(table["zone"] == "primary") & (table["check"] == NULL)].set_index("criterion")
    assert list(own.loc["crack", "verdict"]) == [FAILS] * 3


def test_null_run_without_the_event_of_the_others_does_not_hold(make_hole, data_folder):
    folders = [make_hole("hole_null_r01.6", radius_mm=1.6, cracks=[TENSILE]),
               make_hole("hole_null_r06.4", radius_mm=6.4)]  # fmt: skip
    table = hole_checks([BANDS, *folders], data_folder)
    keys = {"check": NULL, "case": "hole_null_r06.4", "zone": "primary", "criterion": "crack"}
    assert cell(table, "verdict", **keys) == FAILS


@pytest.mark.parametrize(
    ("stress", "word"),
    [(12.5, CONVERGED), (12.7, NOT_CONVERGED), (11.5, CONVERGED), (6.0, NOT_CONVERGED)],
)
def test_finer_run_is_converged_within_five_percent(make_hole, data_folder, stress, word):
    folders = [make_hole("hole_r25.0", cracks=[TENSILE]),
               make_hole("hole_r25.0_fine", cracks=[(stress, 0.0, 1.1, "tensile")])]  # fmt: skip
    table = hole_checks([BANDS, *folders], data_folder)
    keys = {"check": "half the element size", "zone": "primary", "criterion": "crack"}
    assert cell(table, "verdict", **keys) == word
    assert cell(table, "difference_percent", **keys) == pytest.approx(100 * (stress / 12 - 1))


def test_bound_is_the_load_at_which_the_elastic_gauge_reaches_strength(make_hole, data_folder):
    """Elastic gauges carry 1.1 and -3.3 times the load; ft 1.5 MPa, first yield 30.2 MPa."""
    table = hole_checks([BANDS, make_hole("hole_block150_r25.0@seed2")], data_folder)
    own = table[(table["check"] == ELASTIC) & (table["criterion"] == "curvature")]
    bounds = own.set_index("zone")["reference_MPa"]
    assert bounds["primary"] == pytest.approx(1.5 / 1.1)
    assert bounds["sidewall"] == pytest.approx(30.24 / 3.3, rel=1e-3)
    assert list(own["verdict"]) == [HOLDS] * 3


def test_bound_is_that_of_the_gauge_that_carries_most(make_hole, data_folder):
    """Of two gauges of the fan one carries half as much as the other."""
    folder = make_hole("hole_r25.0")
    probes = pd.read_parquet(folder / "probes.parquet")
    probes.loc[probes["probe"] == "remote_01", "stress_xx_MPa"] *= 0.5
    probes.to_parquet(folder / "probes.parquet")
    table = hole_checks([BANDS, folder], data_folder)
    keys = {"check": ELASTIC, "zone": "remote", "criterion": "curvature"}
    assert cell(table, "reference_MPa", **keys) == pytest.approx(1.5 / 1.1)


def test_value_below_the_bound_does_not_hold_though_its_interval_reaches_it(
    make_hole, data_folder, tmp_path
):
    folder = make_hole("hole_r25.0")
    found = hole_initiation([folder], data_folder)
    sidewall = (found["zone"] == "sidewall") & (found["criterion"] == "curvature")
    found.loc[sidewall, ["low_MPa", "initiation_MPa", "high_MPa"]] = [8.0, 9.0, 10.0]  # bound: 9.2
    found.to_csv(tmp_path / "hole_initiation.csv", index=False)
    table = hole_checks([BANDS, tmp_path / "hole_initiation.csv", folder], data_folder)
    keys = {"check": ELASTIC, "zone": "sidewall", "criterion": "curvature"}
    assert cell(table, "verdict", **keys) == FAILS


def test_initiation_below_the_elastic_solution_does_not_hold(make_hole, data_folder):
    table = hole_checks([BANDS, make_hole("hole_r25.0", kinks={"sidewall": 6.0})], data_folder)
    keys = {"check": ELASTIC, "zone": "sidewall"}
    assert cell(table, "verdict", criterion="curvature", **keys) == FAILS
    assert cell(table, "verdict", criterion="crack", **keys) == OPEN


def test_bands_of_the_checks_are_fixed_in_the_file():
    bands = pd.read_csv(BANDS).set_index("quantity")
    assert bands.loc["hole_null_test", "band"] == 3.0
    assert bands.loc["hole_convergence", "band"] == 5.0
    assert bands["reason"].notna().all()
