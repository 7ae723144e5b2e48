"""Tables and verdicts of runs with discrete cracks (analysis/discrete.py, discrete_results.py)."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from lithofrac.analysis import discrete
from lithofrac.analysis.bands import Band
from lithofrac.analysis.discrete_results import discrete_rows
from lithofrac.analysis.runs import Run
from lithofrac.data import DataError

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]


@pytest.fixture
def limits():
    return pd.read_csv(ROOT / "reports" / "bands.csv").set_index("quantity")["band"]


def edited(folder, file, **changes):
    """Change keys of a run's summary or case."""
    path = folder / file
    read = json.loads if path.suffix == ".json" else yaml.safe_load
    path.write_text(json.dumps(read(path.read_text()) | changes))
    return folder


@pytest.fixture
def make_block(make_cracked_run):
    """make_block(name, confinement=0, mode="inter_element") -> discrete block, soft pressure."""

    def made(name, confinement=0.0, mode="inter_element", **summary):
        folder = make_cracked_run(name, mode=mode, test="plane_strain", confinement=confinement)
        return edited(folder, "summary.json", **summary)

    return made


def verdicts(inputs, data_folder, limits):
    """(case, first words of the quantity) -> verdict."""
    rows = discrete_rows([path / "summary.json" for path in inputs], data_folder, limits)
    return {(row["case"], row["quantity"].split()[0]): row for row in rows}


def test_cracks_are_counted_by_their_length(make_block, data_folder):
    row = discrete.cracks([make_block("soft_p00")], data_folder).iloc[0]
    assert (row["cracks"], row["crack_length_mm"], row["fallbacks"]) == (3, 3.0, 1)
    assert row["tensile_percent"] == pytest.approx(200.0 / 3.0)
    assert row["insertion_J"] == pytest.approx(-60.0)


def test_cost_is_held_against_the_continuum_of_the_same_case(make_block, make_run, data_folder):
    """Two continuum runs, one of which has another scene; a third run is discrete as well."""
    block = make_block("soft_p00")
    others = [make_run("other", "triaxial"), make_run("twin", "plane_strain"), make_block("b")]
    edited(others[1], "summary.json", time_step_min_s=9e-9)
    table = discrete.cracks([block, *others], data_folder).set_index("case")
    assert list(table.index) == ["soft_p00", "b"]
    assert table.loc["soft_p00", "continuum"] == "twin"
    assert table.loc["soft_p00", "core_time_over_continuum"] == pytest.approx(1.5)
    assert table.loc["soft_p00", "time_step_over_continuum"] == 1.0


def test_without_a_continuum_run_the_step_is_held_against_the_problem_without_cracks(
    make_block, data_folder
):
    """A run puts that step on record; one that has none says nothing."""
    alone = discrete.cracks([make_block("old")], data_folder).iloc[0]
    assert pd.isna(alone["continuum"])
    assert np.isnan(alone["time_step_over_continuum"])
    cut = make_block("cut", mode="intra_element", time_step_min_s=4e-9, time_step_continuum_s=1e-8)
    both = discrete.cracks([cut, make_block("along", time_step_continuum_s=9e-9)], data_folder)
    both = both.set_index("case")
    assert both.loc["cut", "time_step_over_continuum"] == pytest.approx(0.4)
    assert both.loc["along", "time_step_over_continuum"] == pytest.approx(1.0)
    assert np.isnan(both.loc["along", "core_time_over_continuum"])


def test_directions_stand_beside_each_other(make_block, data_folder):
    row = discrete.bands([make_block("soft_p10", 10.0)], data_folder).iloc[0]
    assert row["confinement_MPa"] == 10.0
    assert row["band_angle_deg"] < 2.0
    assert (row["cracks_near_axis_percent"], row["median_crack_angle_deg"]) == (100.0, 0.0)


def test_run_without_a_crack_has_a_row_without_shares(make_block, data_folder):
    folder = make_block("soft_p00", cracks=0, fragments=0)
    pd.read_parquet(folder / "cracks.parquet").iloc[:0].to_parquet(folder / "cracks.parquet")
    row = discrete.cracks([folder], data_folder).iloc[0]
    assert row["crack_length_mm"] == 0.0
    assert np.isnan(row["tensile_percent"])
    assert np.isnan(discrete.bands([folder], data_folder)["median_crack_angle_deg"].iloc[0])


@pytest.mark.parametrize("table", [discrete.cracks, discrete.bands])
def test_suite_of_continuum_runs_gives_an_empty_table_with_its_columns(
    table, make_run, data_folder
):
    made = table([make_run("sandstone_triaxial_p00")], data_folder)
    assert made.empty
    assert "case" in made


def test_cracks_of_a_continuum_run_are_refused_in_words(make_run):
    with pytest.raises(DataError, match=r"holds no cracks\.parquet, expected a run with discrete"):
        _ = Run(make_run("sandstone_triaxial_p00")).cracks


def test_vertical_band_holds_without_confinement_and_fails_with(make_block, data_folder, limits):
    blocks = [make_block("soft_p00"), make_block("soft_p10", 10.0)]
    rows = verdicts(blocks, data_folder, limits)
    assert rows["soft_p00", "angle"]["verdict"] == "holds"
    assert rows["soft_p00", "angle"]["band"] == "below 15° or none"
    assert rows["soft_p10", "angle"]["verdict"] == "does not hold"
    assert rows["soft_p10", "angle"]["band"] == "20° to 40°"
    assert rows["soft_p10", "share"]["verdict"] == "holds"


def test_angle_that_is_not_that_of_a_band_says_why(make_block, monkeypatch, data_folder, limits):
    def computed(band):
        monkeypatch.setattr(discrete, "find_band", lambda frame: band)
        return verdicts([block], data_folder, limits)["soft_p10", "angle"]

    block, nan = make_block("soft_p10", 10.0), float("nan")
    assert computed(Band(30.0, 9.0, 0.1))["verdict"] == "holds"
    crossing = computed(Band(30.0, 2.0, 0.1))
    assert crossing["computed"] == "30.0° (no band, no single axis)"
    assert crossing["verdict"] == "does not hold"
    assert computed(Band(nan, nan, nan))["computed"] == "no band, no plastic strain"


def test_stiff_blocks_and_other_scenes_are_measured_without_a_verdict(
    make_cracked_run, data_folder, limits
):
    folder = make_cracked_run("stiff", test="plane_strain", stiffness=0.02)
    rows = verdicts([folder], data_folder, limits)
    assert {quantity for _, quantity in rows} == {"smallest"}
    assert len(discrete.bands([folder], data_folder)) == 1


def test_step_may_fall_only_where_elements_are_cut(make_block, data_folder, limits):
    """Both took 0.9 of the step of the continuum."""
    step = {"time_step_continuum_s": 1e-8}
    blocks = [make_block("inter", **step), make_block("intra", mode="intra_element", **step)]
    rows = verdicts(blocks, data_folder, limits)
    assert rows["inter", "smallest"]["verdict"] == "does not hold"
    assert rows["intra", "smallest"]["verdict"] == "holds"
    assert rows["intra", "smallest"]["band"] == "at least 0.4"
    alone = verdicts([make_block("alone", 5.0, "intra_element")], data_folder, limits)
    assert alone["alone", "smallest"]["verdict"] == "cannot be checked"


def test_core_time_has_a_verdict_where_there_is_a_continuum(
    make_block, make_run, data_folder, limits
):
    twin = edited(make_run("twin", "plane_strain"), "summary.json", time_step_min_s=9e-9)
    rows = verdicts([make_block("cheap", core_seconds=8.2), twin], data_folder, limits)
    assert rows["cheap", "core"]["verdict"] == "holds"
    dear = verdicts([make_block("dear", core_seconds=8.3), twin], data_folder, limits)
    assert dear["dear", "core"]["verdict"] == "does not hold"
    assert dear["dear", "core"]["computed"] == "1.51"
