"""Crack band and softening of the tension planes (fortran/material/tension_planes.f90)."""

import pytest
from return_reference import ROCKS, packed

from lithofrac import kernels

LEG = 0.5e-3  # of a right isosceles triangle [m]
AREA = 0.5 * LEG**2


def soften(rock, area=AREA, strength=4e6, increment=0.0, **scale):
    width, modulus, left = kernels.planes_soften(rock, [area], [strength], [increment], **scale)
    return width[0], modulus[0], left[0]


def test_band_width_is_the_leg_of_the_right_isosceles_triangle():
    assert soften(packed("sandstone"))[0] == pytest.approx(LEG, rel=1e-14)
    assert soften(packed("sandstone"), scale=1.0)[0] == pytest.approx(LEG / 2**0.5, rel=1e-14)


def test_softening_modulus_is_equation_16():
    modulus = soften(packed("sandstone"))[1]
    assert modulus == pytest.approx(-LEG * (4e6) ** 2 / (2 * 100.0), rel=1e-14)


def test_strength_is_gone_at_the_critical_fracturing_strain():
    critical = 2 * 100.0 / (LEG * 4e6)  # eq. 15
    rock = packed("sandstone")
    assert soften(rock, increment=0.5 * critical)[2] == pytest.approx(2e6, rel=1e-12)
    assert soften(rock, increment=critical)[2] == pytest.approx(0.0, abs=1e-8)
    assert soften(rock, increment=2 * critical)[2] == 0.0


def test_compressive_strain_leaves_the_strength():
    assert soften(packed("sandstone"), strength=1.5e6, increment=-1.0)[2] == 1.5e6


def test_softening_goes_on_from_the_strength_that_is_left():
    rock = packed("sandstone")
    once = soften(rock, increment=0.03)[2]
    half = soften(rock, increment=0.015)[2]
    assert soften(rock, strength=half, increment=0.015)[2] == pytest.approx(once, rel=1e-12)


@pytest.mark.parametrize("name", ROCKS)
def test_limit_of_the_band_width_is_twice_the_shear_modulus(name):
    rock = packed(name)
    limit = kernels.rock_scales(rock).band_width_limit
    _, modulus, _ = soften(rock, area=0.5 * limit**2)
    young, poisson = rock.constants[:2]
    assert -modulus == pytest.approx(young / (1.0 + poisson), rel=1e-12)


def test_limits_of_the_three_rocks_are_the_known_ones():
    limits = {name: kernels.rock_scales(packed(name)).band_width_limit for name in ROCKS}
    gf = packed("quartzite").constants[4]
    assert limits["quartzite"] == pytest.approx(0.1595e-3 * gf, rel=1e-3)
    assert limits["sandstone"] == pytest.approx(280e-3, rel=1e-3)
    assert limits["tyndall_limestone"] == pytest.approx(129e-3, rel=3e-3)
