"""Cohesive cracks from a hole (analysis/hole_cohesive.py)."""

import numpy as np
import pytest

from lithofrac.analysis import hole_cohesive as cohesive
from lithofrac.analysis.hole_theory import plane_modulus, primary_coupled

pytestmark = pytest.mark.no_core
FT, E, NU, GF = 1.5e6, 21e9, 0.3, 9.0  # Tyndall limestone (Klerck 2004, section 3.3)


def pressure(radius, ft=FT, gf=GF):
    return cohesive.primary_cohesive(ft, E, NU, gf, radius)[0]


@pytest.mark.parametrize("x", [-1.0, 1.0])
def test_dislocation_leaves_the_hole_free_of_traction(x):
    """Radial stress at the wall."""
    phi, dphi, psi = cohesive.potentials(x, 1.7)
    assert 2 * phi - x * dphi - psi == pytest.approx(0.0, abs=1e-13)


def test_short_crack_is_an_edge_crack():
    """1.1215 times the hoop stress of Kirsch."""
    assert cohesive.stress_intensity(1e-3) == pytest.approx(1.1215, rel=0.01)


def test_long_crack_opens_like_one_without_a_hole():
    """4 sigma c / E' at the middle of a crack of half-length c = 31 R under equal tension."""
    line = cohesive.CrackLine(30.0, 200)
    load = 1 + 1 / line.x**2
    density = np.linalg.solve(np.vstack([line.stress, line.at_wall]), np.append(-load, 0.0))
    assert line.mouth @ density == pytest.approx(4 * 31.0, rel=0.01)


def test_number_of_points_does_not_matter(monkeypatch):
    coarse = cohesive._at_length(0.9, 0.14)
    line = cohesive.CrackLine
    monkeypatch.setattr(cohesive, "CrackLine", lambda length: line(length, 160))
    cohesive._at_length.cache_clear()
    assert cohesive._at_length(0.9, 0.14) == pytest.approx(coarse, rel=2e-3)
    cohesive._at_length.cache_clear()


def test_large_holes_start_at_the_tensile_strength():
    assert pressure(20.0) / FT == pytest.approx(1.0, abs=0.05)
    assert pressure(0.2) > pressure(2.0) > pressure(20.0)


def test_small_holes_need_a_pressure_nearly_as_one_over_the_radius():
    slope = np.log(pressure(2e-3) / pressure(1e-3)) / np.log(2.0)
    assert -1.0 < slope < -0.85


@pytest.mark.parametrize("radius", [6.4e-3, 25e-3])
def test_pressure_depends_on_fracture_energy_over_radius_alone(radius):
    assert pressure(10 * radius, gf=10 * GF) == pytest.approx(pressure(radius), rel=1e-6)


def test_mouth_opens_at_the_critical_way():
    """The length found gives w_c = 2 Gf / ft at the wall."""
    p, length = cohesive.primary_cohesive(FT, E, NU, GF, 25e-3)
    brittleness = FT * 25e-3 / (plane_modulus(E, NU) * 2 * GF / FT)
    again, mouth = cohesive._at_length(length / 25e-3, brittleness)
    assert mouth == pytest.approx(1.0, rel=1e-6)
    assert again * FT == pytest.approx(p)


def test_open_mouth_takes_more_than_energy_alone():
    """Finite fracture mechanics lets the crack jump; the cohesive one must be forced open."""
    for radius in (6.4e-3, 25e-3):
        assert pressure(radius) > primary_coupled(FT, E, NU, GF, radius)[0]
