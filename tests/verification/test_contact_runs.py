"""Contact in a run: threads, bundles of steps, restart, place."""

import numpy as np
import pytest
from contact_models import contact_problem, crushed_rubble, join, moved
from models import hold, rectangle

from lithofrac.core import CoreError, Run
from lithofrac.problem import Damping, PressureLoad, Ramp

pytestmark = pytest.mark.verification


def moving_scene(shift=0.0, **changes):
    """Non-matching blocks that hit, slide and stick on a driven plate."""
    block = moved(rectangle(5, 5, jitter=0.2), (0.3 + shift, 0.31 + shift))
    plate = moved(rectangle(11, 2, 2.0, 0.3), (shift, shift))
    mesh = join(block=block, plate=plate)
    bottom = mesh.nodes_of("plate.bottom")
    loads = (hold("x", bottom, 0, 0.01, ramp=Ramp(0.0, 5.0)), hold("y", bottom, 1))
    return Run(
        contact_problem(
            mesh,
            friction=0.4,
            velocity_loads=loads,
            pressure_loads=(PressureLoad("p", mesh.edge_sets["block.top"], 2e-3),),
            **({"damping": Damping(fraction=0.1)} | changes),
        )
    )


def state_bits(run):
    return run.save().tobytes()


def many_islands():
    """Pairs of plates that hit each other at different speeds, far from other pairs."""
    plate = rectangle(16, 1, 1.0, 0.1)
    parts = {
        f"plate{i}_{k}": moved(plate, (0.013 * k, 0.4 * i + 0.101 * k))
        for i in range(20)
        for k in (0, 1)
    }
    mesh = join(**parts)
    run = Run(contact_problem(mesh, friction=0.4))
    height = mesh.nodes[:, 1]
    velocity = np.zeros_like(mesh.nodes)
    upper = height % 0.4 > 0.1005
    velocity[upper, 1] = -2e-3 * (1 + height[upper])
    velocity[upper, 0] = 1e-3
    run.set_motion(0 * velocity, velocity)
    return run


@pytest.mark.parametrize(
    "scene", [moving_scene, many_islands, lambda: crushed_rubble(0.9, speed=5.0, jitter=0.2, n=12)]
)
def test_the_bits_do_not_depend_on_the_number_of_threads(scene):
    """Few pairs, that are not worth threads; many islands; one large island."""
    runs = [scene() for _ in range(3)]
    for threads, run in enumerate(runs, start=1):
        run.advance(400, threads)
    assert runs[0].contact_statistics().pairs_max > 5
    assert runs[0].contact_statistics() == runs[1].contact_statistics()
    assert state_bits(runs[0]) == state_bits(runs[1]) == state_bits(runs[2])
    runs[0].advance(50, 3)
    runs[2].advance(50, 1)
    assert state_bits(runs[0]) == state_bits(runs[2])


def test_the_bits_do_not_depend_on_how_steps_are_bundled():
    one, other = moving_scene(), moving_scene()
    one.advance(300)
    for _ in range(100):
        other.advance(3)
    assert state_bits(one) == state_bits(other)


@pytest.mark.restart
@pytest.mark.parametrize("stop", [0, 30, 217])
def test_a_restart_in_contact_is_bitwise(stop):
    unbroken, first, second = moving_scene(), moving_scene(), moving_scene()
    unbroken.advance(400)
    first.advance(stop)
    second.restore(first.save())
    second.advance(400 - stop)
    assert state_bits(second) == state_bits(unbroken)
    assert second.contact_statistics() == unbroken.contact_statistics()
    assert second.energy() == unbroken.energy()


@pytest.mark.restart
def test_a_checkpoint_of_another_model_is_refused():
    with pytest.raises(CoreError, match="another model"):
        moving_scene().restore(crushed_rubble(0.9).save())


def test_far_from_the_origin_contact_is_as_exact():
    """Coordinates of 1e6 sizes: reference positions keep 1e-10, gaps lose nothing more."""
    near, far = (moving_scene(shift, damping=Damping()) for shift in (0.0, 1e6))
    for run in (near, far):
        run.advance(300)
    u, u_far = near.nodes()[0], far.nodes()[0]
    assert abs(u - u_far).max() < 1e-5 * abs(u).max()
