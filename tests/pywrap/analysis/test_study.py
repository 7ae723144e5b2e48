"""The table of a study (pywrap/lithofrac/analysis/study.py)."""

import json

import numpy as np
import pandas as pd
import pytest

from lithofrac.analysis.study import check_quantities, study_table
from lithofrac.config.study import load_study
from lithofrac.data import DataError

pytestmark = pytest.mark.no_core

STUDY = """\
title: Confinement
base: case.yaml
cases:
  b: {loading.confinement_MPa: 10}
  a: {}
  c: {loading.confinement_MPa: 20, fracture.mode: inter_element}
quantities: [strength.strength_MPa, steps, core_seconds, max_plastic_strain]
plot: {x: loading.confinement_MPa, y: [strength.strength_MPa]}
"""


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.yaml"
    path.write_text(STUDY)
    return path


def test_rows_are_runs_in_the_order_of_the_study(study, make_run, data_folder):
    runs = [make_run(name, confinement=p) for name, p in (("a", 5), ("b", 10))]
    runs.append(make_run("c", confinement=20, peak=False))
    table = study_table([study, *runs], data_folder)
    assert list(table.columns) == [
        "case", "realisation", "loading.confinement_MPa", "fracture.mode",
        "strength.strength_MPa", "steps", "core_seconds", "max_plastic_strain",
    ]  # fmt: skip
    assert list(table["case"]) == ["b", "a", "c"]
    assert list(table["loading.confinement_MPa"]) == [10, 5, 20]  # that of `a` is its case's own
    assert list(table["steps"]) == [100000.0] * 3
    strength = table["strength.strength_MPa"]
    assert strength[0] == pytest.approx(186.9, rel=1e-3)  # of Table 1 at 10 MPa
    assert np.isnan(strength[2])
    assert table["max_plastic_strain"].isna().all()


def test_a_table_goes_through_parquet(study, make_run, data_folder, tmp_path):
    runs = [make_run(name) for name in "abc"]
    table = study_table([study, *runs], data_folder)
    table.to_parquet(tmp_path / "t.parquet")
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "t.parquet"), table)


def test_a_run_that_is_missing_or_did_not_complete_is_refused(study, make_run, data_folder):
    runs = [make_run(name) for name in "ab"]
    with pytest.raises(DataError, match=r"study.yaml: c: its run is not among the inputs"):
        study_table([study, *runs], data_folder)
    runs.append(make_run("c"))
    summary = runs[0] / "summary.json"
    summary.write_text(json.dumps({**json.loads(summary.read_text()), "status": "failed"}))
    with pytest.raises(DataError, match="status 'failed', expected a completed run"):
        study_table([study, *runs], data_folder)


def test_a_quantity_like_no_other_is_refused_with_all_that_there_are(study):
    study.write_text(STUDY.replace("core_seconds", "zzz"))
    with pytest.raises(DataError, match="expected one of: ") as said:
        check_quantities(load_study(study), study)
    listed = str(said.value).partition("expected one of: ")[2].split(", ")
    assert listed == sorted(listed)
    assert {"bands.band_angle_deg", "strength.strength_MPa", "wall_seconds"} <= set(listed)


@pytest.mark.parametrize(
    ("quantity", "message"),
    [
        ("peak_stres_MPa", "no such quantity, did you mean 'peak_stress_MPa'?"),
        ("energy.fiction_J", "no such quantity, did you mean 'energy.friction_J'?"),
        ("strength.strength", "no such quantity, did you mean 'strength.strength_MPa'?"),
        (
            "hole_initiation.initiation_MPa",
            "expected hole_initiation.initiation_MPa[zone,criterion]",
        ),
        ("strength.strength_MPa[a]", "expected strength.strength_MPa"),
    ],
)
def test_a_quantity_that_no_run_has_is_refused_beforehand(study, quantity, message):
    study.write_text(STUDY.replace("core_seconds", f'"{quantity}"'))
    with pytest.raises(DataError) as said:
        check_quantities(load_study(study), study)
    assert str(said.value) == f"{study}: quantities.2 = {quantity}: {message}"
