"""The constant-strain triangle: patch test, objectivity, work, critical step."""

import numpy as np
import pytest
from models import Elastic, element_path, one_triangle, problem, rectangle

from lithofrac.config import Material
from lithofrac.core import Run

TRIANGLE = 1e-3 * np.array([[0.0, 0.0], [1.0, 0.2], [0.3, 0.9]])
ROUNDING = 1e-10  # of Young's modulus
NEEDLES = {nu: Elastic(young=1.0, poisson=nu, density=1.0) for nu in (0.0, 0.25, 0.49, 0.4999)}


def rotation(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def displacements(nodes, deformation):
    """Nodal displacements of a homogeneous deformation gradient."""
    return nodes @ (deformation - np.eye(2)).T


@pytest.mark.verification
@pytest.mark.parametrize("poisson", [0.0, 0.2, 0.4, 0.499, 0.4999])
@pytest.mark.parametrize("stretch", [(1e-4, 0, 0), (0, -2e-4, 0), (1e-4, 1e-4, 3e-4)])
def test_uniform_strain_is_exact_on_a_distorted_mesh(poisson, stretch):
    material = Elastic(poisson=poisson)
    mesh = rectangle(6, 5, 1.3, 0.7, jitter=0.35)
    exx, eyy, gxy = stretch
    stretch_tensor = np.array([[1 + exx, gxy / 2], [gxy / 2, 1 + eyy]])
    run = Run(problem(mesh, material))
    run.set_motion(displacements(mesh.nodes, stretch_tensor), np.zeros_like(mesh.nodes))
    run.advance(0)
    state = run.elements(np.arange(len(mesh.triangles)))
    shear = material.young / (2 * (1 + poisson))
    lame = material.modulus - 2 * shear
    trace = lame * (exx + eyy)
    exact = np.array([trace + 2 * shear * exx, trace + 2 * shear * eyy, trace, shear * gxy])
    scale = material.modulus * max(map(abs, stretch))
    np.testing.assert_allclose(state.stress - exact, 0.0, atol=1e-12 * scale)


@pytest.mark.verification
def test_inner_nodes_of_a_patch_are_in_equilibrium():
    mesh = rectangle(6, 5, 1.3, 0.7, jitter=0.35)
    run = Run(problem(mesh))
    run.set_motion(mesh.nodes @ [[1e-4, 2e-4], [2e-4, -1e-4]], np.zeros_like(mesh.nodes))
    run.advance(0)
    _, velocity, mass = run.nodes()
    force = mass[:, None] * velocity / (0.5 * run.dt)
    border = np.unique(np.concatenate(list(mesh.edge_sets.values())))
    inner = np.setdiff1d(np.arange(len(mass)), border)
    assert abs(force[inner]).max() < 1e-12 * abs(force).max()


@pytest.mark.verification
def test_ten_turns_leave_no_stress():
    angles = np.linspace(0.0, 20 * np.pi, 2001)
    path = [displacements(TRIANGLE, rotation(a)) for a in angles]
    state, forces, *_ = element_path(Elastic(), TRIANGLE, path)
    assert abs(state.stress).max() < ROUNDING * Elastic().young
    assert abs(forces).max() < ROUNDING * Elastic().young * 1e-3


@pytest.mark.verification
def test_stress_turns_with_the_element():
    stretch = np.array([[1.004, 0.001], [0.001, 0.997]])
    angles = np.linspace(0.0, 20 * np.pi, 501)
    path = [displacements(TRIANGLE, rotation(a) @ stretch) for a in angles]
    state, forces, *_ = element_path(Elastic(), TRIANGLE, path)
    assert np.ptp(state.stress, axis=0).max() < ROUNDING * Elastic().young
    turned = np.array([f @ rotation(a) for f, a in zip(forces, angles, strict=True)])
    assert np.ptp(turned, axis=0).max() < ROUNDING * Elastic().young * 1e-3


@pytest.mark.verification
def test_closed_cycle_of_strain_and_rotation_returns_to_no_stress():
    t = np.linspace(0.0, 1.0, 1001)
    strain = 0.005 * np.column_stack(
        [np.sin(2 * np.pi * t), np.sin(4 * np.pi * t), 1 - np.cos(2 * np.pi * t)]
    )
    path = []
    for (exx, eyy, exy), turn in zip(strain, np.pi * np.sin(2 * np.pi * t), strict=True):
        path.append(displacements(TRIANGLE, rotation(turn) @ [[1 + exx, exy], [exy, 1 + eyy]]))
    state, *_ = element_path(Elastic(), TRIANGLE, path)
    assert abs(state.stress).max() > 1e-3 * Elastic().young
    assert abs(state.stress[-1]).max() < ROUNDING * Elastic().young


@pytest.mark.verification
@pytest.mark.parametrize("axisymmetric", [False, True])
def test_nodal_forces_are_the_gradient_of_the_energy(axisymmetric):
    """P : dF = T : dU, by central differences of the elastic energy."""
    nodes = TRIANGLE + [2e-3, 0.0]
    rng = np.random.default_rng(3)
    base = displacements(nodes, rotation(0.7) @ [[1.004, 0.003], [0.003, 0.995]])
    material, step = Elastic(), 1e-9

    def energy(u):
        state, *_ = element_path(material, nodes, [u], axisymmetric)
        b, c = nodes[1] - nodes[0], nodes[2] - nodes[0]
        volume = 0.5 * (b[0] * c[1] - b[1] * c[0])
        volume *= nodes[:, 0].mean() if axisymmetric else 1.0
        return 0.5 * volume * (state.stress * state.strain).sum()

    _, forces, *_ = element_path(material, nodes, [base], axisymmetric)
    for _ in range(5):
        way = rng.normal(size=(3, 2))
        slope = (energy(base + step * way) - energy(base - step * way)) / (2 * step)
        assert (forces[0] * way).sum() == pytest.approx(slope, rel=1e-7)


@pytest.mark.verification
def test_nodal_forces_are_the_gradient_of_the_energy_after_it_has_yielded():
    """Stress and strain have other axes then, so a moment is left that the rotation takes up."""
    sandstone = Material.load("sandstone")
    peak = displacements(TRIANGLE, rotation(0.2) @ [[0.99, 0.004], [0.004, 1.003]])
    base = displacements(TRIANGLE, rotation(0.9) @ [[0.991, 0.002], [0.002, 1.002]])
    rng, step = np.random.default_rng(3), 1e-10
    b, c = TRIANGLE[1] - TRIANGLE[0], TRIANGLE[2] - TRIANGLE[0]
    volume = 0.5 * (b[0] * c[1] - b[1] * c[0])
    state, forces, *_ = element_path(sandstone, TRIANGLE, [peak, base])
    assert state.plastic_strain[1] > 1e-3
    for _ in range(5):
        way = rng.normal(size=(3, 2))
        path = [peak, base, base + step * way, base - step * way]
        state, *_ = element_path(sandstone, TRIANGLE, path)
        assert np.ptp(state.plastic_strain) == 0.0, "elastic from the peak on"
        work = 0.5 * (state.stress[2] + state.stress[3]) @ (state.strain[2] - state.strain[3])
        assert (forces[1] * way).sum() == pytest.approx(volume * work / (2 * step), rel=1e-6)


@pytest.mark.verification
@pytest.mark.parametrize("axisymmetric", [False, True])
def test_critical_step_is_that_of_the_stiffness_matrix(axisymmetric):
    """2/omega against numpy's eigenvalues of a stiffness made by differences of forces."""
    rng = np.random.default_rng(5)
    material = Elastic(poisson=0.3)
    for _ in range(20):
        nodes = 1e-3 * (rng.normal(size=(3, 2)) * [1.0, rng.choice([0.05, 1.0])] + [9.0, 0.0])
        b, c = nodes[1] - nodes[0], nodes[2] - nodes[0]
        area = 0.5 * (b[0] * c[1] - b[1] * c[0])
        if area < 0:
            nodes, area = nodes[[0, 2, 1]], -area
        step = 1e-8 * np.sqrt(area)
        path = [step * e.reshape(3, 2) for e in np.concatenate([np.eye(6), -np.eye(6)])]
        _, forces, _, critical = element_path(material, nodes, path, axisymmetric)
        stiffness = (forces[:6] - forces[6:]).reshape(6, 6) / (2 * step)
        radius = nodes[:, 0]
        mass = np.full(3, area / 3)
        if axisymmetric:
            mass = area * (radius + radius.sum()) / 12
        mass = np.repeat(mass * material.density, 2)
        omega = np.sqrt(np.linalg.eigvals(stiffness / mass[:, None]).real.max())
        assert critical == pytest.approx(2.0 / omega, rel=1e-6)


@pytest.mark.verification
def test_critical_step_of_needles_is_that_of_an_eigenvalue_solver(n_random):
    """10^5 random triangles of aspect up to 10^4, Poisson's ratio up to 0.4999."""
    rng = np.random.default_rng(7)
    n = n_random(100_000)
    nodes = rng.normal(size=(n, 3, 2))
    nodes[:, :, 1] *= 10.0 ** rng.uniform(-4, 0, (n, 1))
    b, c = nodes[:, 1] - nodes[:, 0], nodes[:, 2] - nodes[:, 0]
    area = 0.5 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    nodes = nodes[abs(area) > 1e-4]
    n = len(nodes)
    turn = rng.uniform(0, 2 * np.pi, n)
    nodes = np.einsum("nij,nkj->nki", np.moveaxis(rotation(turn), -1, 0), nodes)
    b, c = nodes[:, 1] - nodes[:, 0], nodes[:, 2] - nodes[:, 0]
    area = 0.5 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    nodes[area < 0] = nodes[area < 0][:, [0, 2, 1]]
    poisson = rng.choice([0.0, 0.25, 0.49, 0.4999], n)
    steps = []
    for corners, nu in zip(nodes, poisson, strict=True):
        *_, step = element_path(NEEDLES[nu], corners, [np.zeros((3, 2))])
        steps.append(step)
    ahead, behind = np.roll(nodes, -1, axis=1), np.roll(nodes, 1, axis=1)
    slope = (ahead - behind)[..., ::-1] * [1, -1] / (2 * abs(area))[:, None, None]
    operator = np.zeros((n, 3, 6))  # of the strain
    operator[:, 0, 0::2] = operator[:, 2, 1::2] = slope[..., 0]
    operator[:, 1, 1::2] = operator[:, 2, 0::2] = slope[..., 1]
    shear = 1 / (2 * (1 + poisson))
    lame = 2 * shear * poisson / (1 - 2 * poisson)
    stiff = np.zeros((n, 3, 3))
    stiff[:, :2, :2] = lame[:, None, None]
    stiff[:, [0, 1], [0, 1]] += 2 * shear[:, None]
    stiff[:, 2, 2] = shear
    product = 3 * np.einsum("nai,nab,nbj->nij", operator, stiff, operator)
    exact = 2 / np.sqrt(np.linalg.eigvalsh(product)[:, -1])
    print(f"largest aspect {(np.ptp(nodes, axis=1).max(axis=1) ** 2 / abs(area)).max():.0f}")
    np.testing.assert_allclose(steps, exact, rtol=1e-9)


@pytest.mark.verification
@pytest.mark.parametrize(("factor", "bounded"), [(0.999, True), (1.001, False)])
def test_free_element_is_stable_exactly_below_its_critical_step(factor, bounded):
    mesh = one_triangle()
    run = Run(problem(mesh, time_step_factor=factor))
    rng = np.random.default_rng(2)
    velocity = 1e-6 * rng.normal(size=(3, 2))
    run.set_motion(np.zeros((3, 2)), velocity)
    run.advance(0)
    start = run.energy()
    largest = 0.0
    try:
        for _ in range(100):
            run.advance(10_000)
            largest = max(largest, run.energy().elastic)
    except RuntimeError as error:
        assert "not finite" in str(error)
        largest = np.inf
    # at 0.999 the highest mode is amplified by about 1/(1 - 0.999^2), and no more
    assert (largest < 2e3 * start.kinetic) is bounded
