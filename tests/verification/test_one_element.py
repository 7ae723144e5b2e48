"""One element in the core against the point bench, fed with the element's own strain."""

import numpy as np
import pytest
from models import hold, problem

from lithofrac import kernels, point
from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.problem import Mesh, PressureLoad, Ramp

NODES = 1e-3 * np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 0.9]])
MESH = Mesh(NODES, np.array([[0, 1, 2]], np.int32), np.zeros(1, np.int32), ("rock",), {})


RING = Mesh(NODES + [2e-3, 0], *list(vars(MESH).values())[1:])


def follow(run, steps):
    """Lead the point bench along the strain of the element; yields (element, state, info).

    Both must agree in every step, in all that they remember.
    """
    material, mesh = run.problem.materials[0], run.problem.mesh
    band_width = np.sqrt(2.0 * mesh.areas()[0])
    state = point.State.virgin(material, 1)
    before, scale = np.zeros((1, 4)), 0.0
    run.advance(0)
    for _ in range(steps):
        run.advance(1)
        element = run.elements([0])
        state, info = point.step(material, element.strain - before, state, length_m=band_width)
        before = element.strain
        assert info.code[0] == 0
        scale = max(scale, abs(element.stress).max())
        np.testing.assert_allclose(element.stress, state.stress, atol=1e-8 * scale)
        np.testing.assert_allclose(element.plastic_strain, state.plastic_strain, atol=1e-10)
        np.testing.assert_allclose(
            element.tensile_strength, state.tensile_strength, atol=1e-8 * scale
        )
        np.testing.assert_allclose(element.fracturing_strain, state.opening, atol=1e-10)
        assert_same_crack(element, state)
        yield element, state, info


def assert_same_crack(element, state):
    """Normals are lines: the doubled angles are compared, where there is damage."""
    damage = np.hypot(*state.crack[0])
    if damage > 1e-6:
        turn = 2.0 * (element.crack_angle - state.crack_direction)
        np.testing.assert_allclose(np.sin(turn), 0.0, atol=1e-8 / damage)
        assert np.cos(turn) > 0.0
    elif damage == 0.0:
        assert element.crack_angle == 0.0


@pytest.mark.verification
@pytest.mark.parametrize("rock", ["quartzite", "sandstone", "tyndall_limestone"])
@pytest.mark.parametrize("axisymmetric", [False, True])
@pytest.mark.parametrize("speed", [-2.0, 0.5])
def test_element_and_bench_agree_on_the_same_strain(rock, axisymmetric, speed):
    mesh = RING if axisymmetric else MESH
    edge = PressureLoad("side", np.array([[1, 2]], np.int32), 3e6, 0.0, Ramp(0.0, 1e-5))
    run = Run(
        problem(
            mesh,
            Material.load(rock),
            axisymmetric=axisymmetric,
            velocity_loads=(
                hold("base", [0, 1], 1),
                hold("top", [2], 1, speed, ramp=Ramp(0.0, 1e-5)),
                hold("corner", [0], 0),
            ),
            pressure_loads=(edge,),
        )
    )
    yielded, damage = False, 0.0
    for _, state, info in follow(run, 400):
        yielded = yielded or info.active[0] != 0
        damage = np.hypot(*state.crack[0])
    assert yielded
    if speed > 0.0:
        assert damage > 1e-3, "stretching opens a crack band in the plane"


@pytest.mark.verification
@pytest.mark.parametrize("reference_mm", [0.8, 2.0])
def test_element_and_bench_agree_on_softening_scaled_by_the_band(reference_mm):
    material = Material.load("sandstone").model_copy(update={"reference_size_mm": reference_mm})
    loads = (
        hold("base", [0, 1], 1),
        hold("top", [2], 1, -10.0, ramp=Ramp(0.0, 1e-6)),
        hold("corner", [0], 0),
    )
    run = Run(problem(MESH, material, velocity_loads=loads))
    softened = 0.0015  # where it starts
    for element, _, _ in follow(run, 400):
        softened = max(softened, element.plastic_strain[0])
    assert softened > 0.01


@pytest.mark.verification
def test_a_ring_whose_hoop_strength_is_exhausted_closes_and_opens_again():
    """Thrown outwards against a spring: zz opens, is pushed shut, and is pulled open later.

    Only the strength of zz is met, so nothing but its own check can see that it opens again.
    """
    side = np.array([[1, 2]], np.int32)
    run = Run(
        problem(
            RING,
            Material.load("quartzite").model_copy(update={"compression": False}),
            axisymmetric=True,
            velocity_loads=(hold("plane", [0, 1, 2], 1),),
            pressure_loads=(
                PressureLoad("spring", side, 0.0, 3e12),
                PressureLoad("pull", side, -100e6, 0.0, Ramp(5e-5, 1e-5)),
            ),
        )
    )
    run.set_motion(np.zeros((3, 2)), np.tile([20.0, 0.0], (3, 1)))
    hoop = 1 << kernels.ACTIVE_PLANES.index("T3")
    phases = []  # of the exhausted ring: open or closed
    for element, state, info in follow(run, 1000):
        assert info.active[0] in (0, hoop)
        if state.tensile_strength[0, 2] == 0.0:
            phase = "open" if info.active[0] else "closed"
            if phase == "closed":
                assert element.stress[0, 2] < 0.0
            if phases[-1:] != [phase]:
                phases.append(phase)
    assert phases[:3] == ["open", "closed", "open"]
