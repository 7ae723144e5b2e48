"""The claims table: every claim has bands, and values are those of the runs (analysis/claims.py).

Verdicts are asserted for made-up runs alone: that a claim holds for the suite is a result.
"""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from punch_runs import CRACKS

from lithofrac.analysis.claims import BANDS, CHECKS, COLUMNS, band_words, claims, combined, judge
from lithofrac.analysis.verdict import FAILS, HOLDS, OPEN
from lithofrac.data import DataError

pytestmark = pytest.mark.no_core


@pytest.fixture
def bands(data_folder):
    return data_folder.parent / "reports" / f"{BANDS}.csv"


@pytest.fixture
def table_of(bands, data_folder):
    """table_of(*inputs) -> claims by id."""
    return lambda *inputs: claims([bands, *inputs], data_folder).set_index("claim")


def values(cell):
    """Numbers of a cell, without their units."""
    return [float(part.split()[0].rstrip("°")) for part in cell.split("; ")]


def test_every_claim_has_a_check_and_every_measure_a_band_with_a_reason(bands, data_folder):
    stated = pd.read_csv(data_folder / "klerck2004" / "claims.csv")
    table = pd.read_csv(bands)
    assert stated["claim"].is_unique
    assert set(stated["claim"]) == set(CHECKS) == set(table["claim"])
    assert not table.duplicated(["claim", "measure"]).any()
    for row in table.itertuples():
        ends = [end for end in (row.least, row.most) if not pd.isna(end)]
        assert ends and ends == sorted(ends), row.claim
        assert isinstance(row.reason, str) and isinstance(row.quantity, str), row.claim


def test_without_runs_every_claim_is_there_and_none_is_judged(table_of):
    table = table_of().reset_index()
    assert tuple(table) == COLUMNS
    assert set(table["verdict"]) == {OPEN}
    assert table["note"].str.len().min() > 0
    assert not table["band"].str.contains("nan").any()


def test_claim_without_a_band_is_refused(tmp_path, bands, data_folder):
    table = pd.read_csv(bands)
    table[table["claim"] != "punch_drop"].to_csv(tmp_path / f"{BANDS}.csv", index=False)
    with pytest.raises(DataError, match="'punch_drop' is missing"):
        claims([tmp_path / f"{BANDS}.csv"], data_folder)
    with pytest.raises(DataError, match=f"no {BANDS}.csv"):
        claims([], data_folder)


def test_measure_without_a_band_is_refused(tmp_path, bands, data_folder, make_punch_run):
    table = pd.read_csv(bands)
    kept = (table["claim"] != "punch_low_gf") | (table["measure"] != "regain")
    table[kept].to_csv(tmp_path / f"{BANDS}.csv", index=False)
    runs = [make_punch_run(f"punch_gf{gf}", gf) for gf in (60, 300, 1200)]
    with pytest.raises(DataError, match="'punch_low_gf': measure 'regain' has no band"):
        claims([tmp_path / f"{BANDS}.csv", *runs], data_folder)


@pytest.mark.parametrize(
    ("least", "most", "words", "inside"),
    [
        (1.0, 2.0, "1 to 2 mm", {0.9: False, 1.0: True, 2.0: True, 2.1: False}),
        (np.nan, 2.0, "at most 2 mm", {-5.0: True, 2.1: False}),
        (1.0, np.nan, "at least 1 mm", {0.9: False, 9.0: True}),
    ],
)
def test_band_holds_its_ends_and_a_blank_end_is_open(least, most, words, inside):
    band = SimpleNamespace(least=least, most=most, unit="mm")
    assert band_words(band) == words
    for value, good in inside.items():
        assert judge(value, band) == (HOLDS if good else FAILS)
    assert judge(float("nan"), band) == OPEN


def test_claim_holds_when_all_its_measures_do_and_one_failure_decides():
    assert combined([HOLDS, HOLDS]) == HOLDS
    assert combined([HOLDS, OPEN]) == OPEN
    assert combined([OPEN, FAILS, HOLDS]) == FAILS


def test_curves_of_the_punch_give_their_falls(table_of, make_punch_run):
    """All four curves are alike: rise, fall by a strain of 0.004 to the residual, flat."""
    names = {"punch_gf60": 60, "punch_gf300": 300, "punch_gf1200": 1200}
    runs = [make_punch_run(name, gf) for name, gf in names.items()]
    runs.append(make_punch_run("punch_discrete", cracks=CRACKS))
    table = table_of(*runs)
    assert values(table.loc["punch_low_gf", "value"]) == [1.0, 0.0]
    assert values(table.loc["punch_discrete", "value"])[1] == 1.0
    history = pd.read_parquet(runs[-1] / "history.parquet")["axial_stress_MPa"]
    fall = 100.0 * (1.0 - history.iloc[-1] / history.max())
    assert values(table.loc["punch_drop", "value"])[0] == pytest.approx(fall, rel=1e-3)
    assert table.loc["punch_drop", "note"] == "no regain: the fall is the final one"
    assert table.loc["punch_hardening", "verdict"] == FAILS
    assert values(table.loc["punch_time_step", "value"]) == [1.0]
    assert table.loc["punch_tension_only", "note"] == "no run punch_tension_only"


def test_damage_of_the_punch_is_found_where_it_was_put(table_of, make_punch_run):
    """First element beside an edge; gauges yield at 0.1 and 0.2 of the run, on the way up."""
    row = table_of(make_punch_run("punch_gf60")).loc["punch_initiation"]
    distance, first, share = values(row["value"])
    assert distance == pytest.approx(np.hypot(1.0 / 3.0, 1.0 / 3.0), rel=1e-3)
    assert 0.4 < first < 0.6
    assert share == 100.0


def test_cracks_of_tension_alone_are_split_by_place(table_of, make_punch_run):
    """Lengths 3 and 3 mm on the axis, 1.41 from an edge of the strip, 2 far away."""
    run = make_punch_run("punch_tension_only", compression=False, cracks=CRACKS)
    table = table_of(run)
    whole = 8.0 + np.sqrt(2.0)
    extent, alone = values(table.loc["punch_tension_crack", "value"])
    assert extent == pytest.approx(62.5)
    assert alone == pytest.approx(100.0 * 6.0 / whole, rel=1e-3)
    near = values(table.loc["punch_tension_pattern", "value"])[0]
    assert near == pytest.approx(100.0 * np.sqrt(2.0) / whole, rel=1e-3)


def test_spread_of_the_peak_is_that_of_the_variants(table_of, make_punch_run):
    base = make_punch_run("punch_tension_only", compression=False, cracks=CRACKS)
    row = table_of(base).loc["punch_tension_only"]
    assert row["note"] == "no run to compare"
    other = make_punch_run("punch_tension_only_coarse", compression=False, cracks=CRACKS)
    history = pd.read_parquet(other / "history.parquet")
    history["axial_stress_MPa"] *= 1.25
    history.to_parquet(other / "history.parquet")
    row = table_of(base, other).loc["punch_tension_only"]
    assert values(row["value"])[1] == pytest.approx(25.0)
    assert row["note"].startswith("coarse ")


def test_strengths_of_sandstone_are_compared_at_one_confinement(table_of, make_run):
    runs = [
        make_run("sandstone_triaxial_p00"),
        make_run("sandstone_triaxial_p10", confinement=10.0),
        make_run("sandstone_soft_p10", "plane_strain", 10.0),
        make_run("sandstone_plane_strain_p10", "plane_strain", 10.0, 0.02, 1.09),
        make_run("sandstone_plane_strain_p10_intra", "plane_strain", 10.0, 0.02, 0.5),
    ]
    table = table_of(*runs)
    assert values(table.loc["plane_strain_above", "value"]) == [pytest.approx(9.0)]
    assert values(table.loc["initial_linear", "value"])[0] < 0.1
    assert table.loc["strength_rises", "verdict"] == OPEN  # one run between platens
    bend, residual = values(table.loc["triaxial_curve", "value"])
    assert bend == pytest.approx(0.0, abs=1e-6)
    peaks = [pd.read_parquet(run / "history.parquet")["axial_stress_MPa"] for run in runs[:2]]
    assert residual == pytest.approx(max(100.0 * p.iloc[-1] / p.max() for p in peaks), rel=1e-3)
