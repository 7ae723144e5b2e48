"""Principal values and axes of plane tensors (fortran/math/principal.f90)."""

import numpy as np
import pytest

from lithofrac import kernels

ROUNDING = 4e-16


def random_tensors(n, seed=1):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, 4)) * 10.0 ** rng.uniform(-3, 9, (n, 1))


def test_values_agree_with_a_general_eigensolver():
    tensors = random_tensors(1000)
    centre, radius, _, _ = kernels.principal_axes(tensors)
    for tensor, high, low in zip(tensors, centre + radius, centre - radius, strict=True):
        exact = np.linalg.eigvalsh([[tensor[0], tensor[3]], [tensor[3], tensor[1]]])
        np.testing.assert_allclose([low, high], exact, atol=8 * ROUNDING * np.abs(tensor).max())


def test_axis_of_a_known_tensor_is_exact():
    _, radius, axis, _ = kernels.principal_axes([[3.0, -5.0, 7.0, 3.0]])
    assert radius[0] == 5.0
    np.testing.assert_array_equal(axis[0], [0.8, 0.6])  # cos and sin of twice the angle


def test_axis_is_a_unit_vector_and_gives_the_tensor_back():
    tensors = random_tensors(1000)
    _, _, axis, again = kernels.principal_axes(tensors)
    np.testing.assert_allclose(np.hypot(*axis.T), 1.0, atol=ROUNDING)
    scale = np.abs(tensors).max(axis=1, keepdims=True)
    np.testing.assert_allclose(again / scale, tensors / scale, atol=2 * ROUNDING)


def test_axis_turns_by_twice_the_angle_of_the_frame():
    angle = 0.3
    c, s = np.cos(2 * angle), np.sin(2 * angle)
    tensors = random_tensors(200)
    half, centre = 0.5 * (tensors[:, 0] - tensors[:, 1]), 0.5 * (tensors[:, 0] + tensors[:, 1])
    shear = tensors[:, 3]
    turned = tensors.copy()
    turned[:, 0], turned[:, 1] = (centre + sign * (c * half - s * shear) for sign in (1, -1))
    turned[:, 3] = s * half + c * shear
    old, new = (kernels.principal_axes(each)[2] for each in (tensors, turned))
    expected = np.column_stack([c * old[:, 0] - s * old[:, 1], s * old[:, 0] + c * old[:, 1]])
    np.testing.assert_allclose(new, expected, atol=1e-12)


@pytest.mark.parametrize("value", [0.0, 1.0, -3e8])
def test_equal_values_hand_back_the_fallback(value):
    _, radius, axis, again = kernels.principal_axes(
        [[value, value, 2.0, 0.0]], fallback=(0.6, -0.8)
    )
    assert radius[0] == 0.0
    np.testing.assert_array_equal(axis[0], [0.6, -0.8])
    np.testing.assert_array_equal(again[0], [value, value, 2.0, 0.0])


def test_nearly_equal_values_count_as_equal_below_the_given_radius():
    tensors = [[1.0, 1.0, 0.0, 1e-13], [1.0, 1.0, 0.0, 1e-11]]
    _, _, axis, _ = kernels.principal_axes(tensors, equality=1e-12, fallback=(1.0, 0.0))
    np.testing.assert_array_equal(axis, [[1.0, 0.0], [0.0, 1.0]])


def test_normal_components_along_the_own_axes_are_the_principal_values():
    tensors = random_tensors(300)
    centre, radius, axis, _ = kernels.principal_axes(tensors)
    exact = np.column_stack([centre + radius, centre - radius, tensors[:, 2]])
    scale = np.abs(tensors).max(axis=1, keepdims=True)
    normal = kernels.rotate_axes(tensors, axis)
    np.testing.assert_allclose(normal / scale, exact / scale, atol=4 * ROUNDING)
