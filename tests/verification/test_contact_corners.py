"""Sharp corners, and what a pair leaves behind when it has parted."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import contact_problem, join, moved
from models import rectangle

from lithofrac.core import Run
from lithofrac.kernels import boundary_of, contact_candidates

pytestmark = pytest.mark.verification


def two_triangles(first, second):
    """Two single triangles, each a body, corners counter-clockwise."""
    return replace(
        rectangle(1, 1),
        nodes=np.array([*first, *second], dtype=float),
        triangles=np.array([[0, 1, 2], [3, 4, 5]], np.int32),
        body=np.array([0, 1], np.int32),
        body_names=("splinter", "tip"),
        edge_sets={},
    )


@pytest.mark.parametrize("turn", np.linspace(0.0, 6.0, 7))
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_node_at_one_face_of_a_splinter_is_not_pushed_out_of_the_other(friction, turn):
    """It stands under a tip of 10 degrees, closer to the upper face than that face reaches in."""
    rise, at = np.tan(np.radians(10.0)), 0.006
    mesh = two_triangles(
        [[0, 0], [-1, rise], [-1, 0]], [[-at, 0], [-at - 0.5, -1], [-at + 0.5, -1]]
    )
    mesh = moved(mesh, turn=turn)
    shortest = boundary_of(mesh)[1]
    behind = at * np.sin(np.radians(10.0))
    assert behind < 0.01 * shortest < at / 2, "within reach of the upper face, not of the tip"
    run = Run(contact_problem(mesh, friction=friction))
    run.advance(100)
    print(f"largest velocity {abs(run.nodes()[1]).max():.1e}")
    assert not run.contact_forces().any()
    assert abs(run.nodes()[1]).max() < 1e-12


def test_a_pair_that_has_parted_leaves_no_impulse_behind():
    """Two blocks rebound; a stale first guess would push them together or apart again."""
    block = rectangle(4, 2, 1.0, 0.5)
    mesh = join(low=block, high=moved(block, (0.0, 0.5)))
    velocity = np.zeros_like(mesh.nodes)
    velocity[len(block.nodes) :, 1] = -1e-4
    run = Run(contact_problem(mesh, friction=0.3))
    run.set_motion(0 * velocity, velocity)
    candidates = sum(map(len, contact_candidates(mesh, 0 * velocity)))
    pushed, apart = 0, 0
    while apart < 20:
        assert run.step < 2000, "they do not part"
        run.advance(1)
        touching = run.contact_forces().any()
        pushed += touching
        apart = 0 if touching else apart + 1
        impulses = run.save()[-2 * candidates :]  # a checkpoint ends with them
        assert impulses.any() == touching
        apart = apart if pushed else 0
    assert run.contact_statistics().lists == 1
    assert pushed > 3
