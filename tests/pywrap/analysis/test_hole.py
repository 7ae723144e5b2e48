"""Initiation about a hole, read from runs (analysis/hole.py)."""

import numpy as np
import pandas as pd
import pytest

from lithofrac.analysis.hole import AFTER, HoleRun, is_hole
from lithofrac.analysis.initiation import Kink
from lithofrac.analysis.runs import Run

pytestmark = pytest.mark.no_core
RECORD = 24.0 / 400  # MPa from one record of the synthetic runs to the next


def events(folder):
    return {(e.zone, e.criterion): e for e in HoleRun(Run(folder)).events()}


@pytest.mark.parametrize(("zone", "kink"), [("primary", 4.0), ("remote", 8.0), ("sidewall", 10.0)])
def test_bend_of_each_zone_is_found_on_its_first_gauge(make_hole, zone, kink):
    """The second gauge of each zone bends half a MPa later."""
    event = events(make_hole("hole_r25.0"))[zone, "curvature"]
    assert event.stress == pytest.approx(kink, abs=0.05)
    assert event.low <= event.stress <= event.high
    assert event.probe in ("crown", "remote_01", "sidewall_right")


@pytest.mark.parametrize(
    ("zone", "probe", "window", "stress"),
    [
        ("primary", "crown", 6.0, 4.0),  # put where the element begins to soften
        ("primary", "crown", 3.9, 3.5),  # which is beyond the window: another bend
        ("sidewall", "sidewall_right", 12.0, 3.5),
    ],
)
def test_tension_gauge_does_not_bend_before_its_element_softens(
    make_hole, zone, probe, window, stress
):
    run = HoleRun(Run(make_hole("hole_r25.0")))
    early = Kink(3.5, 3.4, 3.6, 1.0, 2.0, 0.0, window, 100)
    event = run._bent(zone, run.gauges[probe], early)
    assert event.stress == pytest.approx(stress, abs=2 * RECORD)
    assert event.low <= event.stress <= event.high


def test_principal_strain_takes_shear_as_engineering_shear(make_hole):
    """Made of a tensor turned by 30 degrees; half of the shear as recorded belongs in it."""
    run = HoleRun(Run(make_hole("hole_r25.0")))
    row = int(np.searchsorted(run.stress[:400], 3.0))
    assert run.gauges["crown"].strain[row] == pytest.approx(45e-6 * run.stress[row])
    assert run.gauges["sidewall_left"].strain[row] == pytest.approx(-140e-6 * run.stress[row])


def test_exhaustion_is_the_record_without_strength(make_hole):
    """Strength fades over 8 MPa from the kink; 1 % of it counts as none."""
    event = events(make_hole("hole_r25.0"))["primary", "exhaustion"]
    assert event.stress == pytest.approx(4.0 + 0.99 * 8.0, abs=1.5 * RECORD)
    assert event.high - event.low == pytest.approx(RECORD)


def test_strength_that_is_left_is_said(make_hole):
    event = events(make_hole("hole_r25.0", kinks={"primary": 20.0}))["primary", "exhaustion"]
    assert np.isnan(event.stress)
    assert event.note == "not used up"


def test_wake_of_a_primary_crack_is_no_remote_event(make_hole):
    """The gauge bends first but its rock stays whole."""
    found = events(make_hole("hole_r25.0", wake=("remote_01",)))["remote", "curvature"]
    assert found.probe == "remote_02"
    assert found.stress == pytest.approx(8.5, abs=0.05)
    none = events(make_hole("hole_r16.3", wake=("remote_01", "remote_02")))["remote", "curvature"]
    assert (none.probe, none.note) == ("", "no element softens")


def test_bend_of_the_fan_counts_only_once_its_element_has_begun_to_soften(make_hole):
    """Both gauges bend at 8 and 8.5 MPa; one begins to soften at 20 MPa, far behind its bend."""
    folder = make_hole("hole_r25.0", wake=("remote_01", "remote_02"))
    probes = pd.read_parquet(folder / "probes.parquet")
    late = (probes["probe"] == "remote_01") & (probes["time_s"] >= 20.0 / 24.0)
    probes.loc[late, "tensile_strength_1_MPa"] = 1.0
    probes.to_parquet(folder / "probes.parquet")
    event = events(folder)["remote", "curvature"]
    assert np.isnan(event.stress)
    assert event.note == "bends without softening"


def test_first_crack_of_each_zone_is_told_by_its_place(make_hole):
    cracks = [
        (12.0, 0.05, 1.1, "tensile"),
        (13.0, 0.9, 1.3, "compressive_dilation"),
        (14.0, -0.9, 1.4, "tensile"),
        (15.0, 0.0, 1.2, "tensile"),
        (16.0, 1.1, 0.1, "compressive_dilation"),
        (17.0, 6.0, 0.2, "tensile"),
    ]
    found = events(make_hole("hole_r25.0", cracks=cracks))
    stresses = [found[zone, "crack"].stress for zone in ("primary", "remote", "sidewall")]
    assert stresses == pytest.approx([12.0, 14.0, 16.0], abs=1e-6)


def test_shear_bands_are_neither_primary_nor_remote(make_hole):
    cracks = [(12.0, 0.05, 1.1, "compressive_dilation"), (13.0, 0.9, 1.3, "compressive_dilation")]
    found = events(make_hole("hole_r25.0", cracks=cracks))
    assert [found[zone, "crack"].note for zone in ("primary", "remote")] == ["no crack"] * 2


def test_event_of_a_failed_block_is_marked(make_hole):
    """The block falls from 24 MPa to nothing in the last tenth."""
    cracks = [(24.0 * 1.05, 0.0, 1.1, "tensile")]
    event = events(make_hole("hole_r25.0", cracks=cracks))["primary", "crack"]
    assert event.note == AFTER
    assert event.stress == pytest.approx(12.0, abs=0.7)


def test_elastic_run_has_no_event(make_hole):
    found = events(make_hole("hole_elastic_r25.0", whole=True))
    assert all(np.isnan(event.stress) for event in found.values())
    assert found["primary", "crack"].note == "continuum"


@pytest.mark.parametrize(
    ("name", "series", "seed"),
    [
        ("hole_r06.4", "similar", 1),
        ("hole_r06.4@seed3", "similar", 3),
        ("hole_mesh1mm_r06.4", "mesh1mm", 1),
        ("hole_block150_r06.4@seed2", "block150", 2),
        ("hole_null_r06.4", "null", 1),
        ("hole_r25.0_fine", "fine", 1),
        ("hole_r25.0_slow", "slow", 1),
        ("my_hole", "other", 1),
    ],
)
def test_series_and_realisation_are_read_off_the_name(make_hole, name, series, seed):
    run = HoleRun(Run(make_hole(name, radius_mm=6.4)))
    assert (run.series, run.seed, run.radius_mm) == (series, seed, 6.4)


def test_other_scenes_are_no_hole_runs(make_run, make_hole):
    assert is_hole(Run(make_hole("hole_r25.0")))
    assert not is_hole(Run(make_run("sandstone_triaxial_p00")))
