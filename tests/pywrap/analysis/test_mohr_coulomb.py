"""Closed-form strength of a hardening table (analysis/mohr_coulomb.py)."""

from pathlib import Path

import numpy as np
import pytest

from lithofrac.analysis.mohr_coulomb import (
    first_yield,
    peak_line,
    peak_strength,
    residual_strength,
    yield_stress,
)
from lithofrac.config.material import Material

pytestmark = pytest.mark.no_core
MATERIALS = Path(__file__).parents[3] / "configs" / "materials"


def table_of(rock):
    return Material.load(MATERIALS / f"{rock}.yaml").table


@pytest.mark.parametrize(
    ("rock", "peak", "strain", "first"),
    [
        ("quartzite", 175.3, 0.0015, 115.7),
        ("sandstone", 100.2, 0.0015, 54.1),
        ("tyndall_limestone", 42.6, 0.002, 30.2),
    ],
)
def test_uniaxial_peak_and_first_yield_of_table_1(rock, peak, strain, first):
    stress, at = peak_strength(table_of(rock), 0.0)
    assert stress / 1e6 == pytest.approx(peak, abs=0.05)  # printed to one decimal
    assert at == strain
    assert first_yield(table_of(rock), 0.0) / 1e6 == pytest.approx(first, abs=0.05)


@pytest.mark.parametrize(("confinement", "peak"), [(5, 143.6), (10, 186.9), (20, 273.7)])
def test_confined_peaks_of_sandstone(confinement, peak):
    found = peak_strength(table_of("sandstone"), 1e6 * confinement)[0]
    assert found / 1e6 == pytest.approx(peak, abs=0.05)


@pytest.mark.parametrize(
    ("rock", "intercept", "slope"),
    [("quartzite", 49.5, 6.126), ("sandstone", 0.0, 8.678), ("tyndall_limestone", 14.0, 3.049)],
)
def test_residual_line_of_table_1(rock, intercept, slope):
    low, high = (residual_strength(table_of(rock), 1e6 * p) / 1e6 for p in (0.0, 10.0))
    assert low == pytest.approx(intercept, abs=0.05)
    assert (high - low) / 10 == pytest.approx(slope, abs=5e-4)


def test_peak_between_two_rows_is_found():
    """Quartzite at 4.5 MPa: larger than at any row, and flat there."""
    table = table_of("quartzite")
    stress, at = peak_strength(table, 4.5e6)
    assert stress > yield_stress(table, 4.5e6, table[0]).max()
    fine = yield_stress(table, 4.5e6, np.linspace(0.0, 0.004, 400001))
    assert stress == pytest.approx(fine.max(), rel=1e-9)
    assert 0.0015 < at < 0.002


def test_line_of_a_constant_table_is_straight():
    """c = 10 MPa, phi = 30 degrees: N = 3, q = 2 c sqrt 3."""
    table = np.array([[0.0, 0.01], [10e6, 10e6], [np.pi / 6] * 2, [0.0, 0.0]])
    line = peak_line(table, np.array([0.0, 10e6, 30e6]))
    exact = 20e6 * np.sqrt(3) + 3 * np.array([0.0, 10e6, 30e6])
    np.testing.assert_allclose(line, exact, rtol=1e-12)
