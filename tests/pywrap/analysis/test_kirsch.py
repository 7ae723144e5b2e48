"""Kirsch's plate (analysis/kirsch.py)."""

import numpy as np
import pytest

from lithofrac.analysis.kirsch import infinite_plate

pytestmark = pytest.mark.no_core


def test_concentration_is_minus_one_at_the_crown_and_three_at_the_sidewall():
    crown, side = infinite_plate(np.array([[0.0, 2.0], [2.0, 0.0]]), 2.0)
    np.testing.assert_allclose(crown, [-1.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(side, [0.0, 3.0, 0.0], atol=1e-15)


def test_wall_is_free_of_traction():
    angle = np.linspace(0.0, np.pi, 17)
    normal = np.column_stack([np.cos(angle), np.sin(angle)])
    xx, yy, xy = infinite_plate(normal, 1.0).T
    traction = [xx * normal[:, 0] + xy * normal[:, 1], xy * normal[:, 0] + yy * normal[:, 1]]
    np.testing.assert_allclose(traction, 0.0, atol=1e-14)


def test_stress_far_away_is_the_remote_stress():
    far = infinite_plate(np.array([[3e4, 4e4]]), 1.0)[0]
    np.testing.assert_allclose(far, [0.0, 1.0, 0.0], atol=1e-8)


def test_stress_is_in_equilibrium():
    """Divergence by central differences of second order."""
    step, point = 1e-4, np.array([1.3, 0.9])
    dx, dy = ((infinite_plate([point + d], 1.0) - infinite_plate([point - d], 1.0))[0] / (2 * step)
              for d in (np.array([step, 0.0]), np.array([0.0, step])))  # fmt: skip
    assert dx[0] + dy[2] == pytest.approx(0.0, abs=1e-7)
    assert dx[2] + dy[1] == pytest.approx(0.0, abs=1e-7)
