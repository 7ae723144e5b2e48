"""Same bits for any number of threads, after a resume, and for a repeated run."""

import numpy as np
import pytest
from models import hold, problem, rectangle

from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.problem import Damping, PressureLoad, Ramp


def yielding(axisymmetric=False):
    """A specimen that yields, softens and cracks within 600 steps."""
    mesh = rectangle(20, 40, 0.01, 0.02, jitter=0.3)
    return problem(
        mesh,
        Material.load("sandstone"),
        axisymmetric=axisymmetric,
        velocity_loads=(
            hold("axis", mesh.nodes_of("left"), 0),
            hold("bottom", mesh.nodes_of("bottom"), 1),
            hold("top", mesh.nodes_of("top"), 1, -20.0, ramp=Ramp(0.0, 5e-6)),
        ),
        pressure_loads=(PressureLoad("side", mesh.edge_sets["right"], 2e6, 1e11, Ramp(0.0, 5e-6)),),
        damping=Damping(fraction=0.3),
    )


@pytest.mark.restart
@pytest.mark.parametrize("axisymmetric", [False, True])
def test_threads_change_no_bit(axisymmetric):
    states = []
    for threads in (1, 2, 3, 8):
        run = Run(yielding(axisymmetric))
        run.advance(600, threads)
        states.append(run.save())
        assert run.elements(np.arange(1600)).plastic_strain.max() > 1e-3
    for other in states[1:]:
        np.testing.assert_array_equal(states[0].view(np.int64), other.view(np.int64))


# The Rayleigh quotient of the damping notes a reference at step 400 and uses it at step 410.
@pytest.mark.restart
@pytest.mark.parametrize("saved_at", [405, 437])
@pytest.mark.parametrize("axisymmetric", [False, True])
def test_a_resumed_run_has_the_same_bits(axisymmetric, saved_at):
    whole = Run(yielding(axisymmetric))
    whole.advance(saved_at)
    saved = whole.save()
    everything = np.arange(len(whole.problem.mesh.triangles))
    cracks = whole.elements(everything).crack_angle
    assert np.count_nonzero(cracks) > 20, "the saved state has damage to lose"
    whole.advance(500 - saved_at)
    whole.advance(100)
    resumed = Run(yielding(axisymmetric))
    resumed.restore(saved)
    resumed.advance(600 - saved_at)
    np.testing.assert_array_equal(whole.save().view(np.int64), resumed.save().view(np.int64))
    assert whole.energy() == resumed.energy()
    # `save` cannot show what it leaves out
    for name, values in vars(whole.elements(everything)).items():
        again = getattr(resumed.elements(everything), name)
        np.testing.assert_array_equal(values, again, err_msg=name)


@pytest.mark.restart
def test_a_state_of_another_model_is_refused():
    run = Run(yielding())
    with pytest.raises(RuntimeError, match="another model"):
        run.restore(np.zeros(7))
