"""Verdicts against bands that are fixed beforehand (analysis/results.py)."""

import json
from pathlib import Path

import pytest

from lithofrac.analysis.results import QUALITY, verdicts

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]
BANDS = ROOT / "reports" / "bands.csv"
QUARTZITE = ROOT / "configs" / "materials" / "quartzite.yaml"


@pytest.fixture
def table(make_run, make_bench, data_folder):
    runs = [
        make_run("sandstone_triaxial_p00", factor=1.029),
        make_run("sandstone_triaxial_p10", confinement=10.0, factor=0.969),
        make_run("sandstone_plane_strain_p10", "plane_strain", 10.0, 0.02, factor=1.09),
        make_run("sandstone_plane_strain_k05_p10", "plane_strain", 10.0, 0.05, peak=False),
    ]
    inputs = [BANDS, QUARTZITE, make_bench("sandstone", 0), make_bench("sandstone", 5, 1.002)]
    return verdicts([*inputs, *(run / "summary.json" for run in runs)], data_folder)


def verdict_of(table, case):
    return table[table["case"] == case].iloc[0]


def test_triaxial_peak_holds_inside_three_percent_and_fails_outside(table):
    assert verdict_of(table, "sandstone_triaxial_p00")["verdict"] == "holds"
    outside = verdict_of(table, "sandstone_triaxial_p10")
    assert (outside["difference"], outside["verdict"]) == ("-3.1 %", "does not hold")


def test_plane_strain_is_to_lie_above_the_line(table):
    assert verdict_of(table, "sandstone_plane_strain_p10")["verdict"] == "holds"
    stiff = verdict_of(table, "sandstone_plane_strain_k05_p10")
    assert (stiff["computed"], stiff["verdict"]) == ("no peak", "cannot be checked")


def test_plane_strain_meets_the_material_point_where_its_curve_is_there(
    make_run, make_bench, data_folder
):
    run = make_run("sandstone_plane_strain_p10", "plane_strain", 10.0, 0.02, factor=1.09)
    point = make_bench("sandstone", 10, factor=1.03, test="stiff_confinement")
    row = verdict_of(
        verdicts([BANDS, run / "summary.json", point], data_folder), "sandstone_plane_strain_p10"
    )
    assert (row["difference"], row["verdict"]) == ("+5.8 %", "does not hold")
    assert "material point" in row["expected"]


def test_worst_confinement_of_a_rock_is_the_one_shown(table):
    row = verdict_of(table, "single element, sandstone, triaxial")
    assert "strength at 5 MPa" in row["quantity"]
    assert row["verdict"] == "does not hold"  # 0.2 % against a band of 0.01 %


def test_measured_values_stand_beside_the_paper(table):
    rows = table[table["case"] == "quartzite of Table 1 and TauTona"]
    assert list(rows["verdict"]) == ["holds"] + 4 * ["does not hold"]
    assert rows["measured"].iloc[0] == "260.5 (212.7 to 338.9) MPa"


def test_worst_energy_residual_is_named_with_its_run(table):
    row = table[table["quantity"] == QUALITY["energy_residual"]].iloc[0]
    assert row["case"].startswith("worst of 4 runs: ")
    assert row["verdict"] == "holds"


def test_worst_residual_is_looked_for_in_runs_of_every_kind(make_run, data_folder):
    """A bar has no axial measure and no peak, so it counts for the residual alone."""
    runs = [make_run("sandstone_triaxial_p00"), make_run("bar_wave", "bar")]
    path = runs[1] / "summary.json"
    summary = json.loads(path.read_text())
    path.write_text(json.dumps(summary | {"energy_residual": 2e-6, "kinetic_ratio_at_peak": None}))
    table = verdicts([BANDS, *(run / "summary.json" for run in runs)], data_folder)
    row = table[table["quantity"] == QUALITY["energy_residual"]].iloc[0]
    assert (row["case"], row["verdict"]) == ("worst of 2 runs: bar_wave", "does not hold")
    assert verdict_of(table, "worst of 1 runs: sandstone_triaxial_p00")["verdict"] == "holds"


def test_no_row_lacks_a_band(table):
    assert (table["band"].str.len() > 0).all()
