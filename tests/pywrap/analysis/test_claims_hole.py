"""Claims on holes from the tables of initiation, and from cracks (analysis/claims_hole.py)."""

import json

import numpy as np
import pandas as pd
import pytest
import yaml

from lithofrac.analysis.claim_parts import CannotCheckError, Source
from lithofrac.analysis.claims_hole import HOLE
from lithofrac.analysis.hole_cracks import direction_deg, zoned_cracks
from lithofrac.analysis.runs import Run

pytestmark = pytest.mark.no_core
ZONES = ("primary", "remote", "sidewall")
RADII = (3.2, 6.4, 12.7, 25.0)


def initiation(stress_of):
    """Table of single runs; rows of another criterion, of another series and of a block that has
    failed must not count."""
    rows = [
        {"case": f"hole_r{r:04.1f}" + (f"@seed{s}" if s > 1 else ""), "zone": zone,
         "criterion": "curvature", "initiation_MPa": stress_of(zone, r, s), "note": np.nan,
         "low_MPa": stress_of(zone, r, s) - 0.1, "high_MPa": stress_of(zone, r, s) + 0.1}
        for zone in ZONES for r in RADII for s in (1, 2)
    ]  # fmt: skip
    last = {"case": "hole_r25.0", "zone": "primary", "criterion": "curvature", "note": np.nan}
    last["initiation_MPa"] = 99.0
    rows.append(last | {"criterion": "crack"})
    rows.append(last | {"case": "hole_null_r25.0"})
    rows.append(last | {"case": "hole_r25.0@seed3", "note": "after the peak"})
    return pd.DataFrame(rows)


def size_effect(stress_of):
    """Table of means; rows of another criterion and of another series must not count."""
    rows = [
        {"series": "similar", "zone": zone, "criterion": "curvature", "radius_mm": r,
         "mean_MPa": stress_of(zone, r, 1)}
        for zone in ZONES for r in reversed(RADII)
    ]  # fmt: skip
    rows.append(rows[0] | {"criterion": "crack", "mean_MPa": 99.0})
    rows.append(rows[0] | {"series": "block150", "mean_MPa": 99.0})
    return pd.DataFrame(rows)


def measured(claim, tables=None, runs=(), data=None):
    """Measures of a claim as numbers."""
    source = Source({run.name: run for run in runs}, tables or {}, data)
    return {name: value.value for name, value in HOLE[claim].measures(source).items()}


def falling(zone, radius, seed):
    """9 MPa over the radius on top of an asymptote; the second realisation 2 MPa higher."""
    return (
        {"primary": 5.0, "remote": 15.0, "sidewall": 20.0}[zone] + 9.0 / radius + 2.0 * (seed - 1)
    )


def test_order_is_that_of_each_realisation_of_the_radius_shown():
    tables = {"hole_initiation": initiation(falling)}
    assert measured("hole_order", tables) == {
        "remote": pytest.approx(10.0), "sidewall": pytest.approx(5.0)
    }  # fmt: skip
    assert measured("hole_stress_bound", tables)["largest"] == pytest.approx(22.36)


def words_of_order(table, means=None):
    tables = {"hole_initiation": table} | ({} if means is None else {"size_effect": means})
    return HOLE["hole_order"].measures(Source({}, tables, None))["sidewall"].note


def test_order_that_is_another_elsewhere_is_said_beside_the_one_that_is_judged():
    """By exhaustion in the second mesh, by the means at 3.2 mm, and within an interval."""
    table = initiation(falling)
    assert words_of_order(table) == "hole_r25.0"
    own = table[table["criterion"] == "curvature"]
    other = own.assign(criterion="exhaustion")
    second = (other["case"] == "hole_r25.0@seed2") & (other["zone"] == "sidewall")
    other.loc[second, "initiation_MPa"] = 1.0
    assert words_of_order(pd.concat([table, other])) == (
        "hole_r25.0; reversed by exhaustion in hole_r25.0@seed2"
    )
    second = (table["case"] == "hole_r25.0@seed2") & (table["zone"] == "remote")
    table.loc[second, "high_MPa"] = 25.0
    means = size_effect(lambda zone, radius, _: falling(zone, radius, 1))
    means.loc[(means["zone"] == "remote") & (means["radius_mm"] == 3.2), "mean_MPa"] += 7.0
    assert words_of_order(table, means) == (
        "hole_r25.0; intervals overlap in hole_r25.0@seed2; means reversed at R = 3.2 mm by 2 MPa"
    )


def test_largest_stress_is_that_of_the_means():
    largest = measured("size_primary_bound", {"size_effect": size_effect(falling)})["largest"]
    assert largest == pytest.approx(5.0 + 9.0 / 3.2)


def test_fall_with_radius_is_a_rank_correlation_and_flattens():
    tables = {"size_effect": size_effect(falling)}
    assert measured("size_remote_falls", tables) == {
        "correlation": pytest.approx(-1.0), "ratio": pytest.approx(15.36 / 17.8125)
    }  # fmt: skip
    size = measured("size_effect", tables)
    assert size["ratio"] == pytest.approx(20.36 / 22.8125)
    late = np.interp(12.5, RADII, [9.0 / r for r in RADII]) - 0.36
    assert size["slope"] == pytest.approx(100.0 * late / (9.0 / 3.2 - 0.36))


def test_stress_that_is_the_same_at_every_radius_does_not_fall():
    tables = {"size_effect": size_effect(lambda zone, r, s: 10.0)}
    assert measured("size_sidewall_falls", tables)["correlation"] == 0.0
    assert measured("size_effect", tables)["ratio"] == 1.0
    assert np.isnan(measured("size_effect", tables)["slope"])


def fits(notes):
    """Fits of three zones with asymptotes of 5, 10 and 15 MPa, and one of another series."""
    return pd.DataFrame(
        {
            "series": ["similar"] * 3 + ["block150"],
            "zone": ["primary", "remote", "sidewall", "primary"],
            "criterion": "curvature",
            "asymptote_MPa": [5.0, 10.0, 15.0, 10.0],
            "note": [*notes, np.nan],
        }
    )


def test_asymptotes_are_those_of_the_fits_that_determine_one():
    assert measured("size_asymptotes", {"hole_fits": fits(3 * [np.nan])})["gap"] == 50.0
    without = fits([np.nan, "not determined", np.nan])
    assert measured("size_asymptotes", {"hole_fits": without})["gap"] == pytest.approx(100.0)
    with pytest.raises(CannotCheckError, match="1 of 3 asymptotes"):
        measured("size_asymptotes", {"hole_fits": fits([np.nan, "no", "no"])})


@pytest.mark.parametrize(
    ("claim", "why"),
    [("hole_order", "no table hole_initiation"), ("size_asymptotes", "no table hole_fits"),
     ("hole_breakout", "no run with cracks"), ("hole_remote_apart", "no run with cracks")],
)  # fmt: skip
def test_missing_table_or_run_is_named(claim, why):
    with pytest.raises(CannotCheckError, match=why):
        measured(claim)


def test_radius_without_initiation_is_left_out_and_too_few_are_not_judged():
    table = size_effect(falling)
    table.loc[(table["zone"] == "remote") & (table["radius_mm"] > 4.0), "mean_MPa"] = np.nan
    with pytest.raises(CannotCheckError, match="remote initiation at 1 of at least 3 radii"):
        measured("size_remote_falls", {"size_effect": table})


@pytest.fixture
def make_hole(make_run):
    """make_hole(name, cracks) -> run with a hole of 10 mm; cracks (x1, y1, x2, y2, mode, moment).

    A moment is a share of the time to the peak, so of its stress.
    """

    def made(name, cracks):
        folder = make_run(name, test="hole")
        history = pd.read_parquet(folder / "history.parquet")
        to_peak = history["time_s"][history["axial_stress_MPa"].idxmax()]
        table = pd.DataFrame(cracks, columns=["x1_mm", "y1_mm", "x2_mm", "y2_mm", "mode", "time_s"])
        length = np.hypot(table["x2_mm"] - table["x1_mm"], table["y2_mm"] - table["y1_mm"])
        table.assign(time_s=table["time_s"] * to_peak, length_mm=length).to_parquet(
            folder / "cracks.parquet"
        )
        case = yaml.safe_load((folder / "case.yaml").read_text())
        case["scene"]["hole_radius_mm"] = 10.0
        (folder / "case.yaml").write_text(yaml.safe_dump(case))
        (folder / "summary.json").write_text(json.dumps({"status": "completed"}))
        return Run(folder)

    return made


T, C = "tensile", "compressive_dilation"
CRACKS = [
    (0.0, 10.0, 0.0, 12.0, T, 0.2),  # primary, along the load
    (0.0, 12.0, 0.5**0.5, 12.0 + 0.5**0.5, T, 0.3),  # primary, at 45 degrees to it
    (12.0, 14.0, 12.0, 16.0, T, 0.5),  # remote, right, middle 19.21 mm out
    (12.0, 10.0, 12.0, 12.0, T, 0.6),  # inward of it, 16.28 mm
    (12.0, 18.0, 12.0, 20.0, T, 0.6),  # outward of it, 22.47 mm
    (11.0, 0.0, 11.0, 1.0, C, 0.8),  # sidewall
    (-12.0, 0.0, -12.0, 3.0, T, 0.9),  # sidewall, tensile, left
    (40.0, 0.0, 40.0, 1.0, C, 0.9),  # in no zone: far
    (12.0, 14.0, 12.0, 17.0, C, 0.9),  # in no zone: a shear band
]


def test_cracks_stand_in_the_zone_of_their_middle(make_hole):
    table = zoned_cracks(make_hole("hole_r25.0", CRACKS))
    assert list(table["zone"]) == ["primary"] * 2 + ["remote"] * 3 + ["sidewall"] * 2 + [""] * 2
    assert list(table["side"]) == [1, 1, 1, 1, 1, 1, -1, 1, 1]
    assert table["radius"].iloc[2] == pytest.approx(np.hypot(12.0, 15.0) / 10.0)
    assert np.all(np.diff(table["stress_MPa"]) >= 0.0)


def test_zigzag_about_the_load_axis_is_parallel_to_it():
    def leaning(*angles):
        x, y = np.sin(np.radians(angles)), np.cos(np.radians(angles))
        return pd.DataFrame({"x1_mm": 0.0, "y1_mm": 0.0, "x2_mm": x, "y2_mm": y, "length_mm": 1.0})

    assert direction_deg(leaning(30.0, -30.0)) == pytest.approx(0.0, abs=1e-9)
    assert direction_deg(leaning(30.0, 210.0)) == pytest.approx(30.0)  # the same line, turned round
    assert direction_deg(leaning(80.0, 100.0)) == pytest.approx(90.0)


def test_direction_and_mode_are_those_of_the_length_in_the_zone(make_hole):
    """Two pieces of the primary crack, 2 mm along the load and 1 mm at 45 degrees to it."""
    run = make_hole("hole_r25.0", CRACKS)
    mean = np.degrees(np.arctan2(1.0, 2.0)) / 2.0
    assert measured("hole_primary_parallel", runs=[run])["direction"] == pytest.approx(mean)
    assert measured("hole_remote_parallel", runs=[run])["direction"] == pytest.approx(0.0)
    assert measured("hole_breakout", runs=[run])["compressive_share"] == pytest.approx(25.0)


def test_primary_cracks_of_two_meshes_that_lean_apart_are_not_parallel(make_hole):
    """The worst run counts: a mean over runs would be upright."""
    lean = {name: (0.0, 10.5, 1.0 * way, 11.5, T, 0.5)
            for name, way in (("hole_r25.0", 1.0), ("hole_r25.0@seed2", -1.0))}  # fmt: skip
    runs = [make_hole(name, [crack]) for name, crack in lean.items()]
    assert measured("hole_primary_parallel", runs=runs)["direction"] == pytest.approx(45.0)


def test_remote_cracks_that_lean_to_both_sides_are_not_parallel(make_hole):
    lean = [(12.0, 14.0, 13.0, 15.0, T, 0.5), (-12.0, 14.0, -13.0, 15.0, T, 0.5)]
    run = make_hole("hole_r25.0", lean)
    assert measured("hole_remote_parallel", runs=[run])["direction"] == pytest.approx(45.0)


def test_remote_cracks_of_two_meshes_that_lean_apart_are_not_parallel(make_hole):
    """The worst run and side counts, as for the primary crack."""
    lean = {"hole_r25.0": 13.0, "hole_r25.0@seed2": 11.0}
    runs = [make_hole(name, [(12.0, 14.0, x, 15.0, T, 0.5)]) for name, x in lean.items()]
    assert measured("hole_remote_parallel", runs=runs)["direction"] == pytest.approx(45.0)


def test_remote_cracks_after_the_largest_stress_are_those_of_a_failed_block(make_hole):
    late = (12.0, 14.0, 13.0, 15.0, T, 1.01)
    run = make_hole("hole_r25.0", [(12.0, 14.0, 12.0, 15.0, T, 0.99), late])
    assert measured("hole_remote_parallel", runs=[run])["direction"] == pytest.approx(0.0)
    alone = make_hole("hole_r16.3", [late])
    with pytest.raises(CannotCheckError, match="no remote crack before the largest stress"):
        measured("hole_remote_parallel", runs=[alone])


def test_remote_crack_begins_off_the_wall_and_grows_both_ways(make_hole):
    run = make_hole("hole_r25.0", CRACKS)
    first = np.hypot(12.0, 15.0) / 10.0
    growth = measured("hole_remote_growth", runs=[run])
    assert growth["inward"] == pytest.approx(first - np.hypot(12.0, 11.0) / 10.0)
    assert growth["outward"] == pytest.approx(np.hypot(12.0, 19.0) / 10.0 - first)
    place = measured("hole_remote_place", runs=[run])
    assert place["from_wall"] == pytest.approx(first - 1.0)
    assert place["to_tip"] == pytest.approx(np.hypot(12.0 - 0.5**0.5, 3.0 - 0.5**0.5) / 10.0)


def test_sides_that_begin_within_one_percent_begin_at_once(make_hole):
    def both(share):
        return [CRACKS[2], (-12.0, 14.0, -12.0, 16.0, T, share)]

    runs = [make_hole("hole_r25.0", both(0.5)), make_hole("hole_r16.3", both(0.6))]
    runs.append(make_hole("hole_r06.4", CRACKS))  # the left side never begins
    assert measured("hole_remote_apart", runs=runs[:1])["share"] == 0.0
    assert measured("hole_remote_apart", runs=runs)["share"] == pytest.approx(200.0 / 3.0)
