"""Mobilised strength and the constants of a rock (fortran/material/{mohr_coulomb,rock}.f90)."""

from dataclasses import replace

import numpy as np
import pytest
from return_reference import ROCKS, packed

from lithofrac import kernels
from lithofrac.errors import CoreError


@pytest.mark.parametrize("name", ROCKS)
def test_strength_is_that_of_table_1(name):
    rock = packed(name)
    strain, cohesion, friction, _ = rock.table
    sin_phi, c_cos_phi = kernels.strength_eval(rock, strain)
    np.testing.assert_allclose(sin_phi, np.sin(friction), rtol=1e-15)
    np.testing.assert_allclose(c_cos_phi, cohesion * np.cos(friction), rtol=1e-15)


def test_the_angle_is_interpolated_and_not_its_sine():
    rock = packed("sandstone")
    sin_phi, c_cos_phi = kernels.strength_eval(rock, 0.00125)
    assert sin_phi[0] == pytest.approx(np.sin(np.radians(46.5)), rel=1e-14)
    assert c_cos_phi[0] == pytest.approx(17.5e6 * np.cos(np.radians(46.5)), rel=1e-14)


def test_a_rock_without_compressive_planes_never_yields_in_compression():
    sin_phi, c_cos_phi = kernels.strength_eval(packed("quartzite", compression=0), [0.0, 0.01])
    np.testing.assert_array_equal(sin_phi, 0.0)
    assert c_cos_phi.min() > 1e20


def test_moduli_follow_from_young_and_poisson():
    scales = kernels.rock_scales(packed("sandstone"))  # 28 GPa, 0.25
    assert scales.shear == pytest.approx(11.2e9, rel=1e-15)
    assert scales.lame == pytest.approx(11.2e9, rel=1e-14)
    assert scales.bulk == pytest.approx(28e9 / 1.5, rel=1e-15)


def test_strength_scale_is_positive_even_for_a_rock_of_sand_or_steel():
    sand = packed("sandstone", cohesion=0.0)
    steel = replace(sand, options=np.array([0, 0, 1, 0], dtype=np.int32))
    steel = replace(steel, constants=np.array([210e9, 0.3, 7850.0, 0.0, 0.0, 0.0]))
    for rock in (sand, steel):
        scales = kernels.rock_scales(rock)
        assert scales.strength_scale > 0.0
        assert scales.yield_tolerance == pytest.approx(1e-10 * scales.strength_scale)


def test_planes_that_no_stress_reaches_set_no_scale():
    """At 1e30 Pa they are as if they were not there: the tensile strength alone sets it."""
    rock = packed("sandstone", cohesion=1e30)
    assert kernels.rock_scales(rock).strength_scale == rock.constants[3]
    rock = packed("sandstone", cohesion=1e29)
    assert kernels.rock_scales(rock).strength_scale == 1e29


@pytest.mark.parametrize(
    ("position", "value", "message"),
    [
        (0, -1.0, "Young's modulus must be positive"),
        (0, np.nan, "Young's modulus must be positive"),
        (1, 0.5, "Poisson's ratio must lie between -1 and 0.5"),
        (1, np.nan, "Poisson's ratio must lie between -1 and 0.5"),
        (2, 0.0, "density must be positive"),
        (3, 0.0, "tensile strength must be positive"),
        (4, np.inf, "fracture energy must be positive"),
    ],
)
def test_constants_that_make_no_sense_are_refused(position, value, message):
    rock = packed("sandstone")
    rock.constants[position] = value
    with pytest.raises(CoreError, match=f"^rock: {message}$"):
        kernels.rock_scales(rock)


@pytest.mark.parametrize(
    ("row", "value", "message"),
    [
        (1, -1.0, "rock: cohesion must not be negative"),
        (2, 0.5 * np.pi, "rock: friction must be at least 0 and below 90 degrees"),
        (3, -0.1, "rock: dilation must be at least 0 and below 90 degrees"),
        (0, 0.0005, "table: x must increase strictly"),
        (2, np.nan, "table: every number must be finite"),
    ],
)
def test_tables_that_make_no_sense_are_refused(row, value, message):
    rock = packed("sandstone")
    rock.table[row, 2] = value
    with pytest.raises(CoreError, match=f"^{message}$"):
        kernels.rock_scales(rock)


def test_an_option_is_zero_or_one():
    rock = replace(packed("sandstone"), options=np.array([2, 0, 1, 1], dtype=np.int32))
    with pytest.raises(CoreError, match="every option must be 0 or 1"):
        kernels.rock_scales(rock)
