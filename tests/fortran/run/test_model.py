"""Building a run: what is refused, in words (fortran/run/model.f90)."""

import numpy as np
import pytest
from models import Elastic, hold, problem, rectangle

from lithofrac.core import Run
from lithofrac.errors import CoreError
from lithofrac.problem import PressureLoad

MESH = rectangle(2, 2)


def refused(words, **changes):
    with pytest.raises(CoreError, match=words):
        Run(problem(MESH, **changes))


def test_component_prescribed_twice_is_refused():
    loads = (hold("a", [0, 1], 1), hold("b", [1, 2], 1, 0.1))
    refused("prescribed twice", velocity_loads=loads)


def test_component_beyond_the_plane_is_refused():
    refused("component is 1 or 2", velocity_loads=(hold("a", [0], 2),))


@pytest.mark.parametrize("nodes", [[99], [-1], []])
def test_velocity_on_no_node_is_refused(nodes):
    refused("a node does not exist", velocity_loads=(hold("a", nodes, 0),))


def test_pressure_on_no_edge_is_refused():
    edges = np.array([[0, 99]], np.int32)
    refused("names a node that does not exist", pressure_loads=(PressureLoad("p", edges, 1.0),))


def test_negative_radius_is_refused():
    mesh = rectangle(2, 2)
    mesh.nodes[:, 0] -= 0.5
    with pytest.raises(CoreError, match="a radius is negative"):
        Run(problem(mesh, axisymmetric=True))


def test_one_material_a_body_is_asked():
    refused("one material a body", materials=(Elastic(), Elastic()))


def test_motion_is_set_before_the_first_step_only():
    run = Run(problem(MESH))
    run.advance(1)
    with pytest.raises(CoreError, match="the run has started"):
        run.set_motion(np.zeros_like(MESH.nodes), np.zeros_like(MESH.nodes))


def test_negative_steps_and_no_threads_are_refused():
    run = Run(problem(MESH))
    for steps, threads in ((-1, 1), (1, 0)):
        with pytest.raises(CoreError, match="steps >= 0 and threads >= 1"):
            run.advance(steps, threads)


def test_many_runs_come_and_go():
    """Slots are given back: more runs than there are slots, one after another."""
    for _ in range(200):
        Run(problem(MESH)).advance(1)


def test_too_many_open_runs_are_refused():
    with pytest.raises(CoreError, match="too many runs are open"):
        _ = [Run(problem(MESH)) for _ in range(65)]


def test_two_bodies_move_on_their_own():
    """Two squares in one mesh, one pushed: the other stays at rest to the bit."""
    from dataclasses import replace

    nodes = np.vstack([MESH.nodes, MESH.nodes + [5.0, 0.0]])
    triangles = np.vstack([MESH.triangles, MESH.triangles + len(MESH.nodes)]).astype(np.int32)
    body = np.repeat([0, 1], len(MESH.triangles)).astype(np.int32)
    mesh = replace(MESH, nodes=nodes, triangles=triangles, body=body, body_names=("a", "b"))
    push = PressureLoad("left", MESH.edge_sets["left"], 1e6)
    run = Run(problem(mesh, materials=(Elastic(), Elastic(young=1e9)), pressure_loads=(push,)))
    run.advance(50)
    u = run.nodes()[0]
    assert abs(u[: len(MESH.nodes)]).max() > 1e-9
    assert abs(u[len(MESH.nodes) :]).max() == 0.0
