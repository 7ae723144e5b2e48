"""Strengths at their limits, huge stresses and strains: never NaN, never a wrong stress taken for
a right one (fortran/material)."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from return_reference import ROCKS, material, packed
from test_stress_update import Batch, check_batch, check_idempotent

from lithofrac import kernels, point

LIMITS = {
    "Tresca": {"friction": 0.0, "dilation": 0.0},
    "friction of 1e-9": {"friction": 1e-9, "dilation": 0.0},
    "associated": {"friction": np.radians(40.0), "dilation": np.radians(40.0)},
    "no dilation": {"dilation": 0.0},
    "sand": {"cohesion": 0.0},
    "cohesion of 1 Pa": {"cohesion": 1.0},
    "apex inside the tension planes": {"cohesion": 0.5e6, "friction": np.radians(45.0)},
    "apex outside them": {"cohesion": 20e6, "friction": np.radians(10.0)},
}


def with_strength(rock, strength):
    """The rock with another tensile strength [Pa]."""
    constants = rock.constants.copy()
    constants[3] = strength
    return replace(rock, constants=constants)


@pytest.mark.parametrize("limit", LIMITS)
@pytest.mark.parametrize("name", ROCKS)
def test_every_limit_of_the_compressive_strength_is_consistent(name, limit, n_random):
    batch = Batch(packed(name, **LIMITS[limit]), n_random(4000), seed=21)
    check_idempotent(batch, check_batch(batch, Counter()))


@pytest.mark.parametrize("strength", [1e-6, 1.0, 1e9])
@pytest.mark.parametrize("name", ROCKS)
def test_hardly_any_and_huge_tensile_strength_are_consistent(name, strength, n_random):
    """At 1e9 Pa the apex of the pyramid lies before the tension planes, which are never met."""
    batch = Batch(with_strength(packed(name), strength), n_random(4000), seed=22)
    check_idempotent(batch, check_batch(batch, Counter()))


@pytest.mark.parametrize("dilation", [0.0, 45.0, 89.0])
@pytest.mark.parametrize("name", ROCKS)
def test_friction_of_89_degrees_is_never_left_unnoticed(name, dilation, n_random):
    rock = packed(name, friction=np.radians(89.0), dilation=np.radians(dilation))
    batch = Batch(rock, n_random(4000), seed=23)
    stress, e, *_, code = batch.step()
    assert not code.any()
    assert np.isfinite(stress).all()
    principal = np.linalg.eigvalsh(full(stress))
    size = abs(batch.stress).max(axis=1) + batch.law.g2 * abs(batch.strain).max(axis=1)
    beyond = batch.law.yields(principal, e).max(axis=1)
    assert (beyond <= 1e-9 * batch.law.scale + 1e-12 * size).all()


def full(tensors):
    """(n, 3, 3) of xx, yy, zz, xy."""
    xx, yy, zz, xy = tensors.T
    zero = np.zeros_like(xx)
    return np.stack([xx, xy, zero, xy, yy, zero, zero, zero, zz], axis=-1).reshape(-1, 3, 3)


@pytest.mark.parametrize("name", ROCKS)
def test_a_table_of_one_row_holds_for_every_strain(name, n_random):
    rock = packed(name)
    batch = Batch(replace(rock, table=rock.table[:, :1].copy(order="F")), n_random(4000), seed=24)
    batch.e = np.random.default_rng(1).choice([0.0, 1e-3, 1.0, 1e3], batch.n)
    check_batch(batch, Counter())


@pytest.mark.parametrize("name", ROCKS)
def test_beyond_the_last_row_the_last_values_hold(name, n_random):
    rock = packed(name)
    last = kernels.strength_eval(rock, rock.table[0, -1:])
    far = kernels.strength_eval(rock, np.array([1.0, 1e3, 1e6]))
    for one, other in zip(last, far, strict=True):
        np.testing.assert_array_equal(other, np.broadcast_to(one, 3))
    batch = Batch(rock, n_random(4000), seed=25)
    residual = Batch(replace(rock, table=rock.table[:, -1:].copy(order="F")), batch.n, seed=25)
    batch.e = residual.e = np.full(batch.n, 10.0)
    batch.stress, batch.axis = residual.stress, residual.axis
    batch.ft, batch.strain = residual.ft, residual.strain
    check_batch(batch, Counter())


@pytest.mark.parametrize("name", ROCKS)
def test_a_confinement_of_10_gpa_and_strain_steps_of_1_return_or_say_so(name, n_random):
    """Stresses of 10^3 strengths: a return that is taken is as consistent as any other."""
    batch = Batch(packed(name), n_random(4000), seed=26)
    rng = np.random.default_rng(2)
    batch.stress = np.tile([-10e9, -10e9, -10e9, 0.0], (batch.n, 1))
    batch.strain = rng.choice([1e-3, 0.1, 1.0], (batch.n, 1)) * rng.normal(size=(batch.n, 4))
    check_batch(batch, Counter())


@pytest.mark.parametrize("name", ROCKS)
def test_a_fracture_energy_of_1e6_keeps_the_strength_and_one_of_nearly_none_is_refused(name):
    rock = material(name)
    tough = rock.model_copy(update={"fracture_energy_J_m2": 1e6})
    curve = point.drive(tough, "tension", end_strain=0.01)
    assert np.isfinite(curve.to_numpy(dtype=float)).all()
    strength = rock.tensile_strength / 1e6
    assert curve["tensile_strength_axial_MPa"].iloc[-1] == pytest.approx(strength, rel=2e-3)
    brittle = rock.model_copy(update={"fracture_energy_J_m2": 1e-9})
    with pytest.raises(ValueError, match="use smaller elements or a larger fracture energy"):
        point.drive(brittle, "tension", end_strain=0.01)
    narrow = 0.5 * brittle.band_width_limit
    end = 4 * brittle.fracture_energy / (narrow * brittle.tensile_strength)
    curve = point.drive(brittle, "tension", end_strain=end, length_m=narrow)
    assert curve["tensile_strength_axial_MPa"].iloc[-1] == 0.0
    assert np.isfinite(curve.to_numpy(dtype=float)).all()
