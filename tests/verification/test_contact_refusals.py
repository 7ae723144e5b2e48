"""What contact refuses, and what it must not."""

import numpy as np
import pytest
from contact_models import UNIT, contact_problem, join, moved
from models import hold, problem, rectangle

from lithofrac.core import CoreError, Run
from lithofrac.problem import Contact

pytestmark = pytest.mark.verification


def test_prescribed_motions_that_collide_are_refused():
    mesh = join(low=rectangle(2, 2), high=moved(rectangle(2, 2), (0.1, 1.005)))
    low, high = (np.unique(mesh.triangles[mesh.body == body]) for body in (0, 1))
    loads = [
        hold(f"{name} {axis}", nodes, axis)
        for name, nodes in (("l", low), ("h", high))
        for axis in (0, 1)
    ]
    loads[-1] = hold("push", high, 1, -1e-3)
    run = Run(contact_problem(mesh, velocity_loads=tuple(loads)))
    with pytest.raises(
        CoreError, match=r"nodes .* and .*: contact: their prescribed motions collide"
    ):
        run.advance(1000)
    gap = 0.005 + run.nodes()[0][high, 1].mean()
    assert abs(gap) < 1e-3


def test_an_overlap_at_the_start_is_refused_with_its_place_and_depth():
    low, high = rectangle(4, 4), moved(rectangle(3, 3), (0.2, 0.99))
    with pytest.raises(CoreError, match=r"node \d+ at .* m stands 1.00E-02 m inside another part"):
        Run(contact_problem(join(low=low, high=high)))
    run = Run(contact_problem(join(low=low, high=moved(high, (0.0, 0.02)))))
    displacement = np.zeros((len(run.problem.mesh.nodes), 2))
    displacement[len(low.nodes) :, 1] = -0.05
    run.set_motion(displacement, 0 * displacement)
    with pytest.raises(CoreError, match="inside another part"):
        run.advance(1)


def test_faces_that_touch_are_no_overlap():
    Run(contact_problem(join(low=rectangle(4, 4), high=moved(rectangle(4, 4), (0.0, 1.0)))))


@pytest.mark.parametrize(
    ("contact", "words"),
    [
        (Contact({("rock", "platen"): 0.1}), "'platen' is neither a body nor an edge set"),
        (Contact({("rock", "rock"): -0.1}), "friction is a finite number >= 0"),
        (Contact(default_friction=np.nan), "friction is a finite number >= 0"),
        (Contact({("rock", "top"): 0.1, ("top", "rock"): 0.2}), "given twice"),
    ],
)
def test_a_bad_friction_table_is_refused(contact, words):
    with pytest.raises(CoreError, match=words):
        Run(problem(rectangle(2, 2), UNIT, contact=contact))


def test_bodies_too_fast_for_the_step_are_refused():
    bar = rectangle(4, 4)
    mesh = join(a=bar, b=moved(bar, (1.5, 0.3)))
    run = Run(contact_problem(mesh))
    velocity = np.zeros_like(mesh.nodes)
    velocity[: len(bar.nodes), 0] = 0.5
    run.set_motion(0 * velocity, velocity)
    with pytest.raises(CoreError, match="too fast for the step"):
        run.advance(200)


def test_without_contact_nothing_is_paid_and_parts_pass_through_each_other():
    bar = rectangle(4, 4)
    mesh = join(a=bar, b=moved(bar, (1.1, 0.0)))
    run = Run(problem(mesh, materials=(UNIT, UNIT)))
    velocity = np.zeros_like(mesh.nodes)
    velocity[: len(bar.nodes), 0] = 0.01
    run.set_motion(0 * velocity, velocity)
    run.advance(1000)
    assert run.contact_statistics().steps == 0
    assert run.energy().contact == run.energy().friction == 0.0
    assert run.nodes()[0][: len(bar.nodes), 0].min() > 0.2
