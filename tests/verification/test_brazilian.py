"""Brazilian test: the tensile strength of a disc that splits along its loaded diameter."""

import numpy as np
import pytest

from lithofrac.config import find_case
from lithofrac.core import Run
from lithofrac.scenes import make_mesh, make_problem

pytestmark = pytest.mark.verification


def test_the_disc_splits_along_its_loaded_diameter_at_its_tensile_strength():
    """2 P / (pi D) at the first crack within 5 % of ft; it is upright and in the middle."""
    case = find_case("brazilian", None, {"scene.element_size_mm": 1.0})
    problem = make_problem(case, make_mesh(case))
    run = Run(problem)
    names = [load.name for load in problem.velocity_loads]
    stress = 0.0
    while run.sizes().cracks == 0:
        assert run.step * run.dt < problem.end_time, "no crack at all"
        run.advance(10)
        stress = -run.loads()[names.index("top"), 0] / problem.measures.area
    first = run.cracks()
    x, direction = first[:, 2], first[:, 7]
    print(f"{stress / case.material.tensile_strength:.4f} of ft, at x = {1e3 * x[0]:.2f} mm")
    assert stress == pytest.approx(case.material.tensile_strength, rel=0.05)
    assert abs(x).max() < 2e-3
    assert abs(np.cos(direction)).max() < np.sin(np.radians(15.0))

    run.advance(round(0.1 * (problem.end_time / run.dt)))  # the crack has run through
    ends = run.cracks()[:, [2, 3, 4, 5]].reshape(-1, 2)
    near = abs(ends[:, 0]) < 4e-3
    assert np.ptp(ends[near, 1]) > 0.7 * case.scene.height
    assert abs(run.energy().residual) < 1e-6
