"""Softening scaled by the width of the band (fortran/material/regularise.f90)."""

from dataclasses import replace

import numpy as np
import pytest
from return_reference import ROCKS, material, packed

from lithofrac import kernels, point
from lithofrac.config import Material
from lithofrac.config.regularise import softening_onset
from lithofrac.errors import CoreError

REFERENCE = 2e-3  # [m]
SIZES = (0.5e-3, 1e-3, 2e-3)  # [m]
TESTS = [("triaxial", 0.0), ("triaxial", 10.0), ("plane_strain", 10.0)]


def regularised(name: str, reference=REFERENCE) -> Material:
    """A rock of the paper whose table holds in bands of `reference` [m]."""
    return material(name).model_copy(update={"reference_size_mm": 1e3 * reference})


def onset_of(rock: Material) -> float:
    """Plastic strain where softening starts."""
    return rock.table[0, softening_onset(rock.table)]


def work_per_area(rock: Material, test: str, confinement: float, size: float) -> float:
    """What a band as wide as the element uses up from the peak to the last but one row [J/m2]."""
    curve = point.drive(rock, test, confinement, end_strain=0.12, steps=2000, length_m=size)
    ends = onset_of(rock), rock.table_of_band(size)[0, -2]
    assert curve["plastic_strain"].iloc[-1] > ends[1]
    first, last = np.interp(ends, curve["plastic_strain"], curve["dissipated_J_m3"])
    return size * (last - first)


@pytest.mark.verification
@pytest.mark.parametrize("name", ROCKS)
@pytest.mark.parametrize(("test", "confinement"), TESTS)
def test_a_band_uses_up_the_same_per_area_in_every_element(name, test, confinement):
    rock = regularised(name)
    work = np.array([work_per_area(rock, test, confinement, size) for size in SIZES])
    # Exact but for what the tension planes use up, and for a step where they are used up.
    np.testing.assert_allclose(work, work[-1], rtol=0.01)


def test_without_a_reference_it_falls_with_the_element():
    work = [work_per_area(material("sandstone"), "triaxial", 0.0, size) for size in SIZES]
    np.testing.assert_allclose(work, np.array(SIZES) / SIZES[-1] * work[-1], rtol=0.01)


@pytest.mark.parametrize("name", ROCKS)
def test_the_peak_does_not_depend_on_the_element(name):
    for confinement in (0.0, 20.0):
        peaks = [
            point.drive(regularised(name), "triaxial", confinement, 0.02, length_m=size)[
                "axial_stress_MPa"
            ].max()
            for size in SIZES
        ]
        # Quartzite and limestone peak inside a segment under confinement: to the step.
        np.testing.assert_allclose(peaks, peaks[-1], rtol=1e-4)


def paths(rng, n):
    """Strain increments (steps, n, 4) that shorten y and go past the peak."""
    steps = rng.normal(0.0, 2e-5, (60, n, 4))
    steps[:, :, 1] -= 2e-4
    steps[:, :, 0] += 1e-4
    return steps


def walk(rock, steps, size):
    state = point.State.virgin(rock, steps.shape[1])
    for increment in steps:
        state, info = point.step(rock, increment, state, length_m=size)
        assert not info.code.any()
    return state


@pytest.mark.parametrize("name", ROCKS)
@pytest.mark.parametrize("hardening", ["compressive", "total"])
def test_an_element_of_the_reference_size_has_the_same_bits_as_without(name, hardening, n_random):
    steps = paths(np.random.default_rng(1), n_random(2000))
    plain = material(name).model_copy(update={"hardening": hardening})
    scaled = plain.model_copy(update={"reference_size_mm": 1e3 * REFERENCE})
    one, other = walk(plain, steps, REFERENCE), walk(scaled, steps, REFERENCE)
    assert one.plastic_strain.max() > onset_of(scaled)
    for key, value in vars(one).items():
        np.testing.assert_array_equal(value, getattr(other, key))


@pytest.mark.parametrize("name", ROCKS)
def test_a_stretched_table_is_that_of_a_rock_with_stretched_rows(name, n_random):
    """What the core makes of the reference against a table that is stretched by hand."""
    size = 0.7e-3
    steps = paths(np.random.default_rng(2), n_random(2000))
    scaled = regularised(name)
    by_hand = material(name).model_copy(
        update={"plastic_strain": tuple(scaled.table_of_band(size)[0])}
    )
    one, other = walk(scaled, steps, size), walk(by_hand, steps, size)
    assert one.plastic_strain.max() > onset_of(scaled)
    np.testing.assert_allclose(one.plastic_strain, other.plastic_strain, rtol=1e-9)
    np.testing.assert_allclose(one.stress, other.stress, atol=1e-8 * scaled.tensile_strength)


def test_up_to_the_peak_the_reference_changes_no_bit():
    rock = regularised("sandstone")
    steps = paths(np.random.default_rng(3), 100)[:16]
    for size in SIZES:
        plain, scaled = walk(material("sandstone"), steps, size), walk(rock, steps, size)
        assert 1e-4 < scaled.plastic_strain.max() <= onset_of(rock)
        np.testing.assert_array_equal(plain.stress, scaled.stress)


def test_a_vanishing_element_flows_at_its_peak_for_ever():
    rock = regularised("sandstone")
    curve = point.drive(rock, "triaxial", 0.0, 0.02, length_m=1e-9)
    after = curve["axial_stress_MPa"][curve["plastic_strain"] > onset_of(rock)]
    np.testing.assert_allclose(after, after.max(), rtol=1e-5)


@pytest.mark.parametrize("name", ROCKS)
def test_the_curve_of_an_element_stands_upright_at_the_limit_of_the_width(name):
    """At a share of the limit the steepest fall in plane strain is share/(1 - share) times E'."""
    rock, share = regularised(name, 1e-3), 0.95
    limit = rock.compressive_width_limit
    curve = point.drive(rock, "plane_strain", 0.0, 0.012, steps=4000, length_m=share * limit)
    fall = 1e6 * np.diff(curve["axial_stress_MPa"]) / np.diff(curve["axial_strain"])
    expected = share / (1.0 - share) * rock.young / (1.0 - rock.poisson**2)
    assert -fall.min() == pytest.approx(expected, rel=0.06)  # a step covers some of the segment
    with pytest.raises(ValueError, match="steeper than elastic unloading"):
        point.drive(rock, "plane_strain", 0.0, 0.012, length_m=1.001 * limit)


@pytest.mark.parametrize(
    ("reference", "changes", "message"),
    [
        (-1e-3, {}, "must be 0 or positive"),
        (np.nan, {}, "must be 0 or positive"),
        (np.inf, {}, "must be 0 or positive"),
        (1e-3, {"compression": 0}, "needs Mohr-Coulomb planes"),
        (1e-3, {"cohesion": 1e6, "friction": 0.5}, "needs a table that softens"),
    ],
)
def test_a_reference_that_makes_no_sense_is_refused(reference, changes, message):
    rock = packed("sandstone", **changes)
    rock = replace(rock, constants=np.append(rock.constants[:5], reference))
    with pytest.raises(CoreError, match=message):
        kernels.rock_scales(rock)
