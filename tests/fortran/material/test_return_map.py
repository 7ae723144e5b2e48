"""Return mapping in principal space (fortran/material/{return_map,fixed_strength,...}.f90)."""

import numpy as np
import pytest
from return_reference import (
    EXPLICIT,
    IMPLICIT,
    ROCKS,
    TOTAL,
    Law,
    least_increment,
    packed,
    random_returns,
    violations,
)

from lithofrac import kernels

TOLERANCE = 1e-9  # of the strength scale, for every condition


def returned(rock, softening, trial, ft, e_old):
    """One return; (plastic strain, dep (3,), Mohr-Coulomb part (3,), stress (3,), planes)."""
    e, dep, compressive, active, code = kernels.return_principal(
        rock, [softening], [trial], [ft], [e_old]
    )
    assert code[0] == 0
    stress = Law(rock).stress(np.array([trial]), dep)[0]
    return e[0], dep[0], compressive[0], stress, planes_of(active[0])


def planes_of(mask):
    """Names of the planes in an active mask."""
    return {name for bit, name in enumerate(kernels.ACTIVE_PLANES) if mask >> bit & 1}


def assert_consistent(law, softening, trial, ft, e_old, results, checked_strength=None):
    e, dep, compressive, _, code = results
    assert not code.any()
    found = violations(law, softening, trial, ft, e_old, e, dep, compressive, checked_strength)
    for condition, worst in found.items():
        assert worst.max() <= TOLERANCE, (condition, trial[worst.argmax()])


@pytest.mark.parametrize("name", ROCKS)
def test_a_state_on_the_surface_is_elastic(name):
    rock = packed(name)
    sin_phi, k = (float(value[0]) for value in kernels.strength_eval(rock, 0.001))
    uniaxial = -2.0 * k / (1.0 - sin_phi)
    for stress in ([0.0, 0.0, uniaxial], [rock.constants[3], 0.0, 0.0]):
        e, dep, _, _, planes = returned(rock, -1e6, stress, [rock.constants[3]] * 3, 0.001)
        assert e == 0.001
        assert not dep.any()
        assert not planes


def test_uniaxial_strain_beyond_the_tensile_strength_softens_by_the_closed_form():
    rock = packed("sandstone")
    law, h = Law(rock), -2e9
    stiff = law.g2 + law.lame
    trial = np.array([6e6, 6e6 * law.lame / stiff, 6e6 * law.lame / stiff])
    e, dep, _, stress, planes = returned(rock, h, trial, [4e6] * 3, 0.0)
    exact = (6e6 - 4e6) / (stiff + h)
    assert planes == {"T1"}
    assert e == 0.0
    np.testing.assert_allclose(dep, [exact, 0.0, 0.0], rtol=1e-12)
    assert stress[0] == pytest.approx(4e6 + h * exact, rel=1e-12)


def test_main_plane_return_is_exact_where_the_table_is_flat():
    rock = packed("quartzite")  # beyond 0.008: c = 10 MPa, phi = 46, psi = 20 degrees
    law = Law(rock)
    trial = np.array([-5e6, -60e6, -150e6])
    e, dep, compressive, _, planes = returned(rock, 0.0, trial, [27e6] * 3, 0.01)
    sin_phi, sin_psi = np.sin(np.radians(46.0)), np.sin(np.radians(20.0))
    f = 0.5 * 145e6 - 0.5 * 155e6 * sin_phi - 10e6 * np.cos(np.radians(46.0))
    multiplier = f / (0.5 * law.g2 * (1 + sin_phi * sin_psi) + law.lame * sin_phi * sin_psi)
    flow = multiplier * 0.5 * np.array([1 + sin_psi, 0.0, sin_psi - 1])  # eq. 19
    assert planes == {"M13"}
    np.testing.assert_allclose(dep, flow, rtol=1e-12)
    np.testing.assert_array_equal(dep, compressive)
    assert e - 0.01 == pytest.approx(multiplier * np.sqrt((1 + sin_psi**2) / 3), rel=1e-12)


def test_apex_at_the_origin_takes_all_stress():
    rock = packed("sandstone")  # beyond 0.01: no cohesion
    _, dep, compressive, stress, planes = returned(rock, 0.0, [1e6, 1e6, 1e6], [4e6] * 3, 0.012)
    assert planes == {"apex"}
    np.testing.assert_allclose(stress, 0.0, atol=1e-6)
    np.testing.assert_array_equal(dep, compressive)


def test_an_exhausted_rock_at_the_origin_opens_cracks_without_compressive_flow():
    rock = packed("sandstone")
    e, _, compressive, stress, planes = returned(rock, 0.0, [3e6, 2.8e6, 2.6e6], [0.0] * 3, 0.012)
    assert planes == {"T1", "T2", "T3"}
    assert e == 0.012
    assert not compressive.any()
    np.testing.assert_allclose(stress, 0.0, atol=1e-6)


def test_axes_may_come_in_any_order():
    law = Law(packed("quartzite"))
    softening, trial, ft, e_old = random_returns(law, np.random.default_rng(3), 300)
    rock = packed("quartzite")
    e, dep, compressive, _, _ = kernels.return_principal(rock, softening, trial, ft, e_old)
    for order in ([1, 2, 0], [2, 1, 0], [0, 2, 1]):
        other = kernels.return_principal(rock, softening, trial[:, order], ft[:, order], e_old)
        np.testing.assert_allclose(other[0], e, rtol=1e-9)
        np.testing.assert_allclose(other[1], dep[:, order], rtol=1e-7, atol=1e-12)
        assert np.linalg.norm(other[2], axis=1) == pytest.approx(
            np.linalg.norm(compressive, axis=1), rel=1e-7, abs=1e-12
        )


@pytest.mark.parametrize("hardening", ["compressive", "total"])
@pytest.mark.parametrize("name", ROCKS)
def test_no_admissible_return_has_a_smaller_plastic_strain(name, hardening, n_random):
    """Brute force over all groups of planes at the strain found and at strains before it."""
    rock = packed(name, hardening=int(hardening == "total"))
    law = Law(rock)
    problem = random_returns(law, np.random.default_rng(11), n_random(500, least=40))
    softening, trial, ft, e_old = problem
    results = kernels.return_principal(rock, *problem[:3], e_old)
    assert_consistent(law, softening, trial, ft, e_old, results)
    grown = results[0] - e_old
    near = 1e-9 * law.scale / law.g2 + 1e-7 * grown
    least = least_increment(law, softening, trial, ft, results[0])
    # The brute force knows only corners of what is admissible: its split may be the larger one.
    assert np.all(grown <= least + near)
    if hardening == "total":
        np.testing.assert_array_less(np.abs(grown - least), near)
    for share in (0.0, 0.15, 0.4, 0.7, 0.9):
        before = least_increment(law, softening, trial, ft, e_old + share * grown)
        assert np.all((share * grown < before + near) | (grown < 1e3 * near))


def test_the_first_of_three_roots_is_taken():
    # Tyndall limestone, one huge confined step: roots at 0.0188, 0.0209 and 0.0248.
    rock = packed("tyndall_limestone")
    e, *_, planes = returned(rock, 0.0, [-192.5e6, -1494e6, -45.9e6], [1.5e6] * 3, 0.0005)
    assert e == pytest.approx(0.0188, abs=5e-5)
    assert planes == {"M12", "M32"}
    # Sandstone: F has a pair of roots inside one segment before the one at 0.0057.
    trial = [-27.52436251e6, 172.54310887e6, -62.17026388e6]
    rock = packed("sandstone")
    e, *_ = returned(rock, 0.0, trial, [2.60719526e6, 0.0, 0.39267742e6], 0.0005)
    assert e == pytest.approx(0.003174, abs=1e-6)


def test_two_exhausted_planes_share_the_flow_of_an_edge_evenly():
    rock = packed("quartzite")
    law = Law(rock)
    trial = np.array([100e6, 100e6, -60e6])
    e, dep, compressive, stress, planes = returned(rock, 0.0, trial, [0.0, 0.0, 27e6], 0.01)
    assert planes == {"T1", "T2", "M13", "M23"}
    np.testing.assert_allclose(stress[:2], 0.0, atol=1e-5)
    assert compressive[0] == pytest.approx(compressive[1], rel=1e-12)
    one_sided = np.array([compressive[0] + compressive[1], 0.0, compressive[2]])
    assert e - 0.01 < np.sqrt(2 / 3) * np.linalg.norm(one_sided)
    assert law.yields(stress[None, :], np.array([e])).max() <= TOLERANCE * law.scale
    assert dep[0] >= compressive[0]


@pytest.mark.parametrize("name", ROCKS)
def test_explicit_coupling_checks_planes_against_the_old_strength(name, n_random):
    rock = packed(name, coupling=EXPLICIT)
    law = Law(rock)
    softening, trial, ft, e_old = random_returns(law, np.random.default_rng(7), n_random(3000))
    results = kernels.return_principal(rock, softening, trial, ft, e_old)
    assert_consistent(law, softening, trial, ft, e_old, results, checked_strength=ft)
    implicit = kernels.return_principal(packed(name), softening, trial, ft, e_old)
    # The implicit return is one of the explicit ones, and the smallest strain wins.
    assert np.all(results[0] <= implicit[0] * (1 + 1e-9) + 1e-12)


@pytest.mark.parametrize("name", ROCKS)
def test_coupling_plays_no_part_where_no_plane_is_met(name, n_random):
    law = Law(packed(name))
    softening, trial, ft, e_old = random_returns(law, np.random.default_rng(10), n_random(20_000))
    implicit, explicit = (
        kernels.return_principal(packed(name, coupling=coupling), softening, trial, ft, e_old)
        for coupling in (IMPLICIT, EXPLICIT)
    )
    below = law.stress(trial, implicit[1]) < law.softened(ft, softening, implicit[1])
    alone = below.all(axis=1) & (trial < ft).all(axis=1) & (implicit[3] > 0)
    assert alone.sum() > 0.05 * len(alone)
    for one, other in zip(implicit, explicit, strict=True):
        np.testing.assert_allclose(one[alone], other[alone], rtol=1e-9, atol=1e-15)


def test_two_sets_that_share_their_stress_are_mixed():
    # The apex falls onto an open tension plane at one strain; F jumps across zero there.
    rock = packed("quartzite")
    trial, ft = [145.48699385e6, 247.51066663e6, 121.29131064e6], [27e6, 27e6, 15.98625295e6]
    e, dep, compressive, stress, planes = returned(rock, -0.5e9, trial, ft, 0.004)
    assert planes == {"T3", "apex", "mixture"}
    np.testing.assert_allclose(stress, stress[2], rtol=1e-9)
    assert e - 0.004 == pytest.approx(np.sqrt(2 / 3) * np.linalg.norm(compressive), rel=1e-12)
    assert dep[2] > compressive[2]


def test_explicit_coupling_leaves_a_plane_above_its_new_strength():
    # Main-plane flow opens axis 1: its plane is met at the old strength, not at the new one.
    names = ("quartzite", "sandstone", "tyndall_limestone")
    differ = 0
    for name in names:
        rock = packed(name, hardening=TOTAL, coupling=EXPLICIT)
        law = Law(rock)
        softening, trial, ft, e_old = random_returns(law, np.random.default_rng(8), 3000)
        _, dep, _, _, code = kernels.return_principal(rock, softening, trial, ft, e_old)
        assert not code.any()
        stress = law.stress(trial, dep)
        excess = (stress - law.softened(ft, softening, dep)).max(axis=1)
        differ += np.count_nonzero(excess > 1e-6 * law.scale)
        assert (stress - ft).max() <= TOLERANCE * law.scale
    assert differ > 0


def test_without_compressive_planes_only_cracks_open():
    rock = packed("quartzite", compression=0)
    law = Law(rock)
    softening, trial, ft, e_old = random_returns(law, np.random.default_rng(9), 2000)
    e, dep, compressive, active, code = kernels.return_principal(rock, softening, trial, ft, e_old)
    assert not code.any()
    assert not compressive.any()
    assert (active < 8).all()
    np.testing.assert_array_equal(e, e_old)
    softened = law.softened(ft, softening, dep)
    stress = law.stress(trial, dep)
    assert (stress - softened).max() <= TOLERANCE * law.scale
    assert np.abs(np.where(dep > 1e-12, stress - softened, 0.0)).max() <= TOLERANCE * law.scale


def test_friction_of_89_degrees_gives_finite_returns():
    rock = packed("sandstone", friction=np.radians(89.0))
    law = Law(rock)
    softening, trial, ft, e_old = random_returns(law, np.random.default_rng(10), 2000)
    results = kernels.return_principal(rock, softening, trial, ft, e_old)
    assert all(np.isfinite(result).all() for result in results)
    assert not results[4].any()
