"""Variants beside their twins (analysis/variants.py)."""

import numpy as np
import pandas as pd
import pytest
import yaml

from lithofrac.analysis.runs import Run
from lithofrac.analysis.variants import (
    changed_keys,
    families,
    residual_stress,
    variants,
    work_after_peak,
)
from lithofrac.data import DataError

pytestmark = pytest.mark.no_core

SUITE = """\
title: t
cases:
  block: {{extends: {file}}}
  block_paper: {{extends: {file}, twin: block, set: {{fracture.reset: paper}}}}
  block_not_run: {{extends: {file}, twin: block, set: {{fracture.weights: volume}}}}
  continuum: {{extends: {file}}}
  continuum_weak: {{extends: {file}, twin: continuum}}
"""


def change(folder, **dotted):
    """Set dotted keys of the case of a run; `__` stands for the dot."""
    case = yaml.safe_load((folder / "case.yaml").read_text())
    for name, value in dotted.items():
        section, key = name.split("__")
        case.setdefault(section, {})[key] = value
    (folder / "case.yaml").write_text(yaml.safe_dump(case))
    return folder


@pytest.fixture
def suite(tmp_path):
    path = tmp_path / "suite.yaml"
    path.write_text(SUITE.format(file="cases/bar.yaml"))
    return path


@pytest.fixture
def inputs(suite, make_run, make_cracked_run):
    """The suite and four runs: a pair with cracks, a pair whose peak differs by a tenth."""
    return [
        suite,
        make_run("continuum_weak", factor=0.9, confinement=5.0),
        make_run("continuum", confinement=5.0),
        change(make_cracked_run("block", cracks=3), fracture__reset="normal"),
        change(make_cracked_run("block_paper", cracks=5), fracture__reset="paper"),
    ]


def test_pairs_stand_in_the_order_of_the_suite_and_only_where_both_were_run(inputs):
    found = [(twin.name, [run.name for run in own]) for twin, own in families(inputs)]
    assert found == [("block", ["block_paper"]), ("continuum", ["continuum_weak"])]
    assert families(inputs[:2]) == []


def test_a_twin_is_followed_by_its_variants(inputs, data_folder):
    table = variants(inputs, data_folder)
    assert list(table["case"]) == ["block", "block_paper", "continuum", "continuum_weak"]
    assert list(table["twin"].fillna("")) == ["", "block", "", "continuum"]
    assert table["choice"][1] == "fracture.reset: paper"


def test_differences_are_those_of_the_curves(inputs, data_folder):
    row = variants(inputs, data_folder).set_index("case").loc["continuum_weak"]
    assert row["peak_change_percent"] == pytest.approx(-10.0)
    assert row["residual_change_percent"] == pytest.approx(0.0, abs=1e-9)
    assert row["curve_rms_percent"] > 1.0
    assert np.isnan(row["crack_length_change_mm"])
    assert row["what_changes"] == (
        "residual stress, work after the peak within 1 %; peak stress -10 %; strain at peak -10 %"
    )


def test_equal_curves_differ_in_their_cracks_alone(inputs, data_folder):
    row = variants(inputs, data_folder).set_index("case").loc["block_paper"]
    assert row["crack_length_change_mm"] == pytest.approx(2.0)
    assert (row["curve_rms_percent"], row["core_time_over_twin"]) == (0.0, 1.0)
    assert row["tensile_percent"] == pytest.approx(40.0)  # two of five
    assert row["near_axis_percent"] == pytest.approx(100.0)
    # The residual of a dry block is zero: there is no change relative to it.
    assert row["what_changes"] == (
        "peak stress, strain at peak, work after the peak within 1 %; crack events 3 to 5"
    )


def test_a_run_without_a_peak_says_so(suite, make_run, data_folder):
    runs = [make_run("continuum"), make_run("continuum_weak", peak=False)]
    row = variants([suite, *runs], data_folder).iloc[1]
    assert np.isnan(row["peak_change_percent"])
    assert "a peak in continuum alone" in row["what_changes"]


def test_residual_stress_is_the_mean_over_the_last_tenth_of_the_strain(make_run):
    folder = make_run("a")
    strain = np.linspace(0.0, 0.02, 201)
    stress = np.where(strain >= 0.0179999, 40.0 + 1e4 * (strain - 0.019), 100.0)
    pd.DataFrame(
        {"time_s": 0.1 * strain, "axial_strain": strain, "axial_stress_MPa": stress}
    ).to_parquet(folder / "history.parquet")
    assert residual_stress(Run(folder)) == pytest.approx(40.0)


def test_work_after_the_peak_is_the_area_of_the_fall(make_run):
    folder = make_run("a")  # a straight fall to nothing over 0.4 %
    run = Run(folder)
    assert work_after_peak(run) == pytest.approx(0.5 * 0.004 * run.peak.stress, rel=1e-9)
    assert np.isnan(work_after_peak(Run(make_run("b", peak=False))))


def test_keys_that_one_case_lacks_are_named_and_titles_are_not(make_run):
    plain = Run(make_run("a"))
    scaled = Run(change(make_run("b"), material__reference_size_mm=1.0))
    assert changed_keys(scaled, plain) == ["material.reference_size_mm: 1.0"]
    assert changed_keys(plain, scaled) == ["material.reference_size_mm: left out"]


def test_without_a_suite_nothing_says_what_is_a_variant(inputs, data_folder):
    with pytest.raises(DataError, match="0 suite files among the inputs, expected one"):
        variants(inputs[1:], data_folder)


def test_a_suite_without_variants_gives_an_empty_table(suite, data_folder):
    table = variants([suite], data_folder)
    assert table.empty
    assert "what_changes" in table
