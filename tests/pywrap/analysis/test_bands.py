"""Angles of shear bands and cracks to the load axis (analysis/bands.py)."""

import numpy as np
import pandas as pd
import pytest

from lithofrac.analysis.bands import (
    angle_to_axis,
    band_of,
    crack_angles,
    find_band,
    near_axis_share,
)
from lithofrac.analysis.runs import Run

pytestmark = pytest.mark.no_core
WIDTH, HEIGHT, THICKNESS = 10.0, 30.0, 1.0  # of a block and of a band in it [mm]


@pytest.fixture
def points():
    """Centroids of equal elements that fill a block, (m, 2)."""
    x, y = np.meshgrid(np.arange(0.125, WIDTH, 0.25), np.arange(0.125, HEIGHT, 0.25))
    return np.column_stack([x.ravel(), y.ravel()])


def in_band(points, angle_deg):
    """Points less than half a thickness from a line through the middle of the block."""
    angle = np.radians(angle_deg)
    offset = points - [WIDTH / 2, HEIGHT / 2]
    return np.abs(offset @ [np.cos(angle), -np.sin(angle)]) < THICKNESS / 2


def band(points, strain):
    return band_of(points, np.asarray(strain, dtype=float), np.full(len(points), 0.0625))


@pytest.mark.parametrize("angle", [-40.0, -25.0, 5.0, 20.0, 30.0, 40.0])
def test_angle_of_a_band_across_a_block_is_found(points, angle):
    """Its ends are cut off by the sides of the block, which turns the axis by up to a degree."""
    found = band(points, 0.05 * in_band(points, angle))
    assert found.note == ""
    assert found.angle_deg == pytest.approx(abs(angle), abs=1.5)


def test_uniform_part_of_the_strain_does_not_turn_the_axis(points):
    """A block that hardens everywhere by a tenth of what its band strains."""
    alone = band(points, 0.05 * in_band(points, 30.0))
    hardened = band(points, 0.005 + 0.05 * in_band(points, 30.0))
    assert hardened.angle_deg == pytest.approx(alone.angle_deg, abs=1e-9)
    assert hardened.note == ""


def test_strain_spread_over_the_block_is_no_band(points):
    noise = np.random.default_rng(1).uniform(0.8, 1.2, len(points))
    found = band(points, 0.01 * noise)
    assert found.spread > 0.95
    assert found.note == "spread out"


def test_uniform_strain_is_no_band(points):
    found = band(points, np.full(len(points), 0.01))
    assert found.spread == pytest.approx(1.0)
    assert found.note == "uniform"


def test_round_cloud_is_no_band(points):
    offset = points - [WIDTH / 2, HEIGHT / 2]
    found = band(points, np.hypot(*offset.T) < 2.0)
    assert found.elongation == pytest.approx(1.0, abs=0.02)
    assert found.note == "no single axis"


def test_two_bands_that_cross_are_no_band(points):
    """Their common axis lies along the load, which would be taken for splitting."""
    found = band(points, in_band(points, 25.0) | in_band(points, -25.0))
    assert found.angle_deg == pytest.approx(0.0, abs=1e-6)
    assert found.note == "no single axis"


def test_without_plastic_strain_there_is_no_band(points):
    found = band(points, np.zeros(len(points)))
    assert np.isnan(found.angle_deg)
    assert found.note == "no plastic strain"


def test_small_elements_weigh_by_their_area(points):
    """A block meshed four times as finely on its left half has the same band."""
    left = points[:, 0] < WIDTH / 2
    shift = 0.0625 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    fine = (points[left][:, None] + shift).reshape(-1, 2)
    graded = np.concatenate([fine, points[~left]])
    area = np.repeat([0.0625 / 4, 0.0625], [len(fine), np.count_nonzero(~left)])
    found = band_of(graded, 0.05 * in_band(graded, 30.0), area)
    alone = band(points, 0.05 * in_band(points, 30.0))
    assert found.angle_deg == pytest.approx(alone.angle_deg, abs=0.2)
    assert found.spread == pytest.approx(alone.spread, rel=0.05)


def test_band_of_a_frame_leaves_out_bodies_that_do_not_yield(make_cracked_run):
    """Strain in the two columns of the rock beside x = 2 mm takes a quarter of the rock."""
    found = find_band(Run(make_cracked_run("sandstone_soft_p00")).last_frame)
    assert found.spread == pytest.approx(0.25)


@pytest.mark.parametrize(
    ("direction", "angle"), [([0, 1], 0), ([0, -2], 0), ([1, 1], 45), ([-1, 1], 45), ([3, 0], 90)]
)
def test_angle_to_the_load_axis_ignores_sense_and_side(direction, angle):
    assert angle_to_axis(np.array(direction)) == pytest.approx(angle)


def segments(angles, lengths):
    """Cracks that start at (0, 0), by angle to the load axis [degrees] and length."""
    x, y = np.sin(np.radians(angles)) * lengths, np.cos(np.radians(angles)) * lengths
    return pd.DataFrame({"x1_mm": 0.0, "y1_mm": 0.0, "x2_mm": x, "y2_mm": y, "length_mm": lengths})


def test_share_near_the_axis_counts_length():
    cracks = segments([0.0, 10.0, 50.0, -85.0], [3.0, 1.0, 2.0, 2.0])
    np.testing.assert_allclose(crack_angles(cracks), [0.0, 10.0, 50.0, 85.0])
    assert near_axis_share(cracks) == pytest.approx(0.5)


def test_segments_without_a_preferred_direction_have_the_share_of_the_angle():
    cracks = segments(np.linspace(-90.0, 90.0, 3601), np.ones(3601))
    assert near_axis_share(cracks) == pytest.approx(20.0 / 90.0, abs=1e-3)


def test_no_cracks_have_no_share():
    assert np.isnan(near_axis_share(segments([], np.zeros(0))))
