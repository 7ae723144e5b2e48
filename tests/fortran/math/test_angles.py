"""Sine and cosine of the core (fortran/math/angles.f90), by way of the strength of a rock."""

from dataclasses import replace

import numpy as np
from return_reference import packed

from lithofrac import kernels

ROUNDING = np.finfo(float).eps


def of(angles):
    """(sine, cosine) of angles (n,) [rad], as friction of a rock whose cohesion is 1 Pa."""
    rock = packed("sandstone")
    strain = np.arange(len(angles), dtype=float)
    ones = np.ones(len(angles))
    sine, cosine = [], []
    for some in np.array_split(np.arange(len(angles)), -(-len(angles) // 60)):
        table = np.array([strain[some], ones[some], angles[some], 0.0 * angles[some]])
        found = kernels.strength_eval(replace(rock, table=np.asfortranarray(table)), strain[some])
        sine.append(found[0])
        cosine.append(found[1])
    return np.concatenate(sine), np.concatenate(cosine)


def test_sine_and_cosine_are_off_by_a_few_roundings():
    angles = np.concatenate([np.linspace(0.0, np.radians(89.99), 3001), np.logspace(-300, 0, 200)])
    sine, cosine = of(np.sort(angles))
    angles = np.sort(angles)
    assert np.abs(sine / np.maximum(np.sin(angles), 1e-320) - 1.0)[1:].max() < 3 * ROUNDING
    assert np.abs(cosine - np.cos(angles)).max() < 2 * ROUNDING


def test_no_angle_is_exact():
    assert of(np.zeros(1)) == (0.0, 1.0)


def test_squares_add_up_to_one():
    sine, cosine = of(np.random.default_rng(1).uniform(0.0, 0.5 * np.pi, 1000))
    assert np.abs(sine**2 + cosine**2 - 1.0).max() < 4 * ROUNDING
