"""Meshes are checked once, before anything builds on them (fortran/mesh/mesh.f90)."""

from dataclasses import replace

import numpy as np
import pytest
from models import problem, rectangle

from lithofrac.core import Run
from lithofrac.errors import CoreError

MESH = rectangle(2, 2)


def refusal(**changes):
    with pytest.raises(CoreError) as caught:
        Run(problem(replace(MESH, **changes)))
    return str(caught.value)


def test_clockwise_element_is_named():
    triangles = MESH.triangles.copy()
    triangles[4] = triangles[4, ::-1]
    assert refusal(triangles=triangles) == "mesh: element 5 has no positive area"


def test_node_that_does_not_exist_is_refused():
    triangles = MESH.triangles.copy()
    triangles[0, 0] = 99
    assert refusal(triangles=triangles) == "mesh: a triangle names a node that does not exist"


def test_node_without_an_element_is_named():
    nodes = np.vstack([MESH.nodes, [[9.0, 9.0]]])
    assert refusal(nodes=nodes) == "mesh: node 10 belongs to no element"


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_position_that_is_not_finite_is_refused(value):
    nodes = MESH.nodes.copy()
    nodes[3, 1] = value
    assert refusal(nodes=nodes) == "mesh: a node position is not finite"


def test_body_without_a_number_is_refused():
    body = MESH.body.copy()
    body[0] = -1
    assert refusal(body=body) == "mesh: bodies are numbered from 1"
