"""Failed zone, axial crack and shares beneath the punch (analysis/punch_pattern.py)."""

from dataclasses import replace

import numpy as np
import pytest
from punch_runs import CRACKS, block

from lithofrac.analysis.frames import frame_times
from lithofrac.analysis.inelastic import Inelastic, load_inelastic
from lithofrac.analysis.punch_pattern import (
    Strip,
    axial_extent,
    compressive_share_below,
    failed_zone,
    open_cracks,
    pattern,
    pattern_time,
)
from lithofrac.analysis.runs import Run
from lithofrac.analysis.stages import find_stages

pytestmark = pytest.mark.no_core


@pytest.fixture
def run(make_punch_run):
    return Run(make_punch_run("punch_discrete", cracks=CRACKS))


def test_strip_stands_on_the_middle_of_the_block(run):
    strip = Strip.of(run)
    assert (strip.axis, strip.width, strip.top, strip.height) == (4.0, 2.0, 8.0, 8.0)
    points = np.array([[3.0, 8.0], [5.0, 7.0], [4.0, 8.0]])
    np.testing.assert_allclose(strip.to_edge(points), [0.0, 1.0, 1.0])


def test_pattern_is_that_of_stage_d(run):
    history = run.history
    stages = find_stages(history["axial_strain"], history["axial_stress_MPa"])
    assert pattern_time(run) == history["time_s"].iloc[stages.d]
    assert pattern(run).frame.time_s >= pattern_time(run)


@pytest.mark.parametrize("slope", [0.25, 0.0])
def test_taper_is_that_of_straight_flanks(run, slope):
    """From 1 mm beside the axis down to 4 mm, where they meet or stay; 0.2 mm wide.

    95 % of the area reach 3.8 mm, a little less where flanks that meet share theirs. Means of a
    straight line are its values at a quarter and at three quarters.
    """
    mesh = block(160)
    x, y = 1e3 * mesh.centroids().T
    flank = (np.abs(np.abs(x - 4.0) - (1.0 - slope * (8.0 - y))) < 0.1) & (y > 4.0)
    whole = pattern(run).frame
    nodes = 1e3 * mesh.nodes
    frame = replace(
        whole, nodes=nodes, displacement=0.0 * nodes, triangles=mesh.triangles, body=mesh.body,
        plastic_strain=0.1 * flank,
    )  # fmt: skip
    zone = failed_zone(run, Inelastic(frame, np.zeros((len(x), 2, 2)), np.zeros((len(x), 3))))
    assert zone.depth_mm == pytest.approx(3.8, abs=0.1)
    upper, lower = (1.0 - slope * part * zone.depth_mm for part in (0.25, 0.75))
    assert zone.taper == pytest.approx(upper / lower, rel=0.03)


def test_whole_frame_has_no_failed_zone(run):
    zone = failed_zone(run, load_inelastic(run, *frame_times(run.folder)[0]))
    assert zone.depth_mm == 0.0 and np.isnan(zone.taper)


def test_axial_extent_counts_a_height_once_and_only_steep_cracks_near_the_axis(run):
    """Cracks from 6 to 3 and from 4 to 1 mm cover 5 of 8 mm; the others are level or far."""
    assert axial_extent(run, pattern_time(run)) == pytest.approx(5.0 / 8.0)
    assert axial_extent(run, 0.0) == 0.0


def test_cracks_that_open_later_are_left_out(run):
    assert len(open_cracks(run, 0.0)) == 0
    table = open_cracks(run, pattern_time(run))
    np.testing.assert_allclose(table[["x_mm", "y_mm"]].iloc[2], [2.5, 7.5])


def test_strain_below_the_zone_is_extension_alone(run):
    assert compressive_share_below(run, pattern(run)) == pytest.approx(0.0, abs=1e-12)
