"""The check of chunks that have never yielded lets nothing through (virgin_forces)."""

import numpy as np
import pytest
from models import problem

from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.problem import Mesh

CHUNK = 128  # elements that share the check (fortran/mechanics/chunks.f90)
CORNERS = 1e-3 * np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 0.9]])


def limits(material, stress):
    """Factors that bring stresses (n, 4) to Mohr-Coulomb and to the tensile strength."""
    xx, yy, zz, xy = stress.T
    mean, radius = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    high, low = np.maximum(mean + radius, zz), np.minimum(mean - radius, zz)
    _, cohesion, friction, _ = material.table[:, 0]
    shear = (high - low) / 2 + (high + low) / 2 * np.sin(friction)
    with np.errstate(divide="ignore"):
        to_shear = np.where(shear > 0, cohesion * np.cos(friction) / shear, np.inf)
        to_tension = np.where(high > 0, material.tensile_strength / high, np.inf)
    return to_shear, to_tension


def loaded(material, strain, axisymmetric):
    """State of single elements with these strains (n, 4), each alone in a chunk at rest."""
    n = CHUNK * len(strain)
    nodes = np.tile(CORNERS, (n, 1)) + np.repeat(np.arange(n), 3)[:, None] * [0.0, 2e-3]
    triangles = np.arange(3 * n, dtype=np.int32).reshape(-1, 3)
    mesh = Mesh(nodes, triangles, np.zeros(n, np.int32), ("rock",), {})
    xx, yy, zz, xy = strain.T
    stretch = np.array([[xx, xy / 2], [xy / 2, yy]]).transpose(2, 0, 1)
    chosen = CHUNK * np.arange(len(strain)) + np.arange(len(strain)) % CHUNK
    displacement = np.zeros((n, 3, 2))
    displacement[chosen] = CORNERS @ stretch
    if axisymmetric:  # a shift along the radius makes the hoop strain
        shift = zz * CORNERS[:, 0].mean() - displacement[chosen, :, 0].mean(axis=1)
        displacement[chosen, :, 0] += shift[:, None]
    run = Run(problem(mesh, material, axisymmetric=axisymmetric))
    run.set_motion(displacement.reshape(-1, 2), np.zeros_like(nodes))
    run.advance(0)
    return run.elements(chosen)


@pytest.mark.verification
@pytest.mark.parametrize("axisymmetric", [False, True])
@pytest.mark.parametrize("rock", ["quartzite", "sandstone", "tyndall_limestone"])
def test_one_element_beyond_its_strength_is_found_among_a_chunk_at_rest(
    rock, axisymmetric, n_random
):
    material, rng = Material.load(rock), np.random.default_rng(8)
    strain = rng.normal(size=(n_random(400), 4)) * [1, 1, axisymmetric, 1]
    shear = material.young / (2 * (1 + material.poisson))
    lame = 2 * shear * material.poisson / (1 - 2 * material.poisson)
    stress = lame * strain[:, :3].sum(1)[:, None] * [1, 1, 1, 0] + shear * strain * [2, 2, 2, 1]
    to_shear, to_tension = limits(material, stress)
    assert np.isfinite(to_shear).any() and (to_tension < to_shear).any()
    edge = np.minimum(to_shear, to_tension)
    ends = np.isfinite(edge)  # confinement from all sides may know no end
    strain, stress, edge = strain[ends], stress[ends], edge[ends]
    for factor, beyond in ((1 - 1e-6, False), (1 + 1e-6, True)):
        scale = (factor * edge)[:, None]
        found = loaded(material, scale * strain, axisymmetric)
        off = abs(found.stress - scale * stress).max(axis=1) / abs(scale * stress).max(axis=1)
        changed = (found.plastic_strain > 0) | (found.fracturing_strain > 0).any(axis=1)
        np.testing.assert_array_equal(changed, beyond)
        np.testing.assert_allclose(off, 0.0, atol=1e-4 if beyond else 1e-9)
