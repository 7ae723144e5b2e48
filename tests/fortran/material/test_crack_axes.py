"""Strength axes that follow the stress, and eq. 13 (fortran/material/crack_axes.f90)."""

import numpy as np
import pytest
from return_reference import packed

from lithofrac import kernels, point


def doubled(degrees):
    angle = np.radians(2.0 * np.asarray(degrees, dtype=float))
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def stress_at(degrees, high=2.0, low=-1.0, zz=0.3):
    """Stress whose larger in-plane principal value points at `degrees`."""
    c, s = doubled(degrees)
    return np.array(
        [0.5 * (high + low) + 0.5 * (high - low) * c, 0.5 * (high + low) - 0.5 * (high - low) * c,
         zz, 0.5 * (high - low) * s]
    )  # fmt: skip


def follow(stress, axis):
    return kernels.axes_follow([stress], [axis])[0]


@pytest.mark.parametrize(
    ("turn", "first"),
    [(0, 0), (10, 10), (44.9, 44.9), (45.1, -44.9), (90, 0), (134.9, 44.9), (180, 0), (-30, -30)],
)
def test_first_axis_is_the_nearest_modulo_180_degrees(turn, first):
    # The strength of the larger stress is thus kept below 45 degrees of turn, swapped above.
    axis = follow(stress_at(20 + turn), doubled(20))
    np.testing.assert_allclose(axis, doubled(20 + first), atol=1e-12)


def test_equal_principal_stresses_keep_the_old_axes():
    for value in (0.0, 5e6, -3e8):
        stress = np.array([value, value, 1.0, 1e-13 * value])
        np.testing.assert_array_equal(follow(stress, doubled(17)), doubled(17))


def test_a_relative_difference_above_rounding_counts():
    axis = follow(np.array([1e6, 1e6, 0.0, 1e-5]), doubled(30))
    np.testing.assert_allclose(axis, doubled(45), atol=1e-9)


def test_strengths_stay_with_their_axes():
    # Crack along y (normal x), then pull along an axis 30 and 60 degrees away from x.
    rock = packed("sandstone")
    law = kernels.rock_scales(rock)
    for turn, uses_old_crack in ((30.0, True), (60.0, False)):
        state = point.State.virgin(point_rock(), 1)
        state, _ = point.step(point_rock(), [[2e-3, 0.0, 0.0, 0.0]], state)
        cracked = state.tensile_strength[0, 0]
        assert cracked < state.tensile_strength[0, 1]
        pull = 3.0 * stress_at(turn, high=1.0, low=-0.2, zz=0.0) * 4e6
        strain = strain_of(pull - state.stress[0], law)
        state, info = point.step(point_rock(), [strain], state)
        along = 0 if uses_old_crack else 1
        assert info.inelastic_strain[0, along] > 0.0
        assert info.inelastic_strain[0, along] == info.inelastic_strain[0, :2].max()


def point_rock():
    from return_reference import material

    return material("sandstone")


def strain_of(stress, scales):
    mean = stress[:3].sum() / (3 * scales.lame + 2 * scales.shear)
    strain = (stress - scales.lame * mean) / (2 * scales.shear)
    strain[3] = stress[3] / scales.shear
    return strain


def test_average_direction_is_exact_for_three_directions():
    angles = np.array([10.0, 25.0, 60.0])
    weights = np.array([0.2, 0.1, 0.05])
    damage = np.column_stack([weights, np.zeros(3)])
    cracks = kernels.crack_turn(damage, doubled(angles))
    exact = np.cumsum(weights[:, None] * doubled(angles), axis=0)
    np.testing.assert_allclose(cracks, exact, atol=1e-16)


def test_damage_across_the_axis_counts_along_the_other_one():
    cracks = kernels.crack_turn([[0.0, 0.3]], [doubled(20)])
    np.testing.assert_allclose(cracks[0], 0.3 * doubled(110), atol=1e-16)


def test_directions_170_and_10_degrees_average_to_zero():
    cracks = kernels.crack_turn([[0.1, 0.0], [0.1, 0.0]], doubled([170, 10]))
    assert np.arctan2(cracks[1, 1], cracks[1, 0]) == pytest.approx(0.0, abs=1e-14)


def test_a_history_of_three_directions_turns_the_crack_as_equation_13_says():
    """Stretch a point along three directions; unload and reload between: the band stays."""
    rock = point_rock()
    state = point.State.virgin(rock)
    total = np.zeros(2)
    for degrees in (0.0, 20.0, 55.0):
        before = state
        strain = 1.2e-3 * np.array(
            [np.cos(np.radians(degrees)) ** 2, np.sin(np.radians(degrees)) ** 2, 0.0,
             np.sin(np.radians(2 * degrees))]
        )  # fmt: skip
        state, _ = point.step(rock, [strain], state)
        damage = (before.tensile_strength[0] - state.tensile_strength[0]) / rock.tensile_strength
        axis = doubled(np.degrees(state.axis_angle[0]))
        assert damage[:2].max() > 0.0
        total += (damage[0] - damage[1]) * axis
        np.testing.assert_allclose(state.crack[0], total, atol=1e-15)
        expected = 0.5 * np.arctan2(total[1], total[0])
        assert state.crack_direction[0] == pytest.approx(expected, abs=1e-14)

        loaded = state
        for share in (-0.3, -0.3, 0.3, 0.3):  # of the elastic strain: no damage on this path
            elastic = strain_of(loaded.stress[0], kernels.rock_scales(rock))
            state, info = point.step(rock, [share * elastic], state)
            assert info.active[0] == 0
            assert state.crack_direction[0] == loaded.crack_direction[0]
            np.testing.assert_array_equal(state.tensile_strength, loaded.tensile_strength)


def test_a_point_without_damage_has_no_crack_direction():
    assert np.isnan(point.State.virgin(point_rock(), 3).crack_direction).all()
