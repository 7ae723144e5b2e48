"""One element in the core against the point bench, fed with the element's own strain."""

import numpy as np
import pytest
from models import hold, problem

from lithofrac import point
from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.problem import Mesh, PressureLoad, Ramp

NODES = 1e-3 * np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 0.9]])
MESH = Mesh(NODES, np.array([[0, 1, 2]], np.int32), np.zeros(1, np.int32), ("rock",), {})


@pytest.mark.verification
@pytest.mark.parametrize("rock", ["quartzite", "sandstone", "tyndall_limestone"])
@pytest.mark.parametrize("axisymmetric", [False, True])
@pytest.mark.parametrize("speed", [-2.0, 0.5])
def test_element_and_bench_agree_on_the_same_strain(rock, axisymmetric, speed):
    material = Material.load(rock)
    mesh = MESH if not axisymmetric else Mesh(NODES + [2e-3, 0], *list(vars(MESH).values())[1:])
    edge = PressureLoad("side", np.array([[1, 2]], np.int32), 3e6, 0.0, Ramp(0.0, 1e-5))
    run = Run(
        problem(
            mesh,
            material,
            axisymmetric=axisymmetric,
            velocity_loads=(
                hold("base", [0, 1], 1),
                hold("top", [2], 1, speed, ramp=Ramp(0.0, 1e-5)),
                hold("corner", [0], 0),
            ),
            pressure_loads=(edge,),
        )
    )
    run.advance(0)
    band_width = np.sqrt(2.0 * mesh.areas()[0])
    state = point.State.virgin(material, 1)
    before, scale, yielded = np.zeros((1, 4)), 0.0, False
    for _ in range(400):
        run.advance(1)
        element = run.elements([0])
        state, info = point.step(material, element.strain - before, state, length_m=band_width)
        before = element.strain
        assert info.code[0] == 0
        yielded = yielded or info.active[0] != 0
        scale = max(scale, abs(element.stress).max())
        np.testing.assert_allclose(element.stress, state.stress, atol=1e-8 * scale)
        np.testing.assert_allclose(element.plastic_strain, state.plastic_strain, atol=1e-10)
        np.testing.assert_allclose(
            element.tensile_strength, state.tensile_strength, atol=1e-8 * scale
        )
    assert yielded
