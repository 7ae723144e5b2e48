"""What the guards look at, against a look at every node and element (fortran/run/watch.f90)."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import ROCK, UNIT, contact_problem, crushed_rubble, join, moved
from models import hold, problem, rectangle

from lithofrac.core import Run
from lithofrac.errors import CoreError
from lithofrac.problem import Mesh


def at_motion(given, displacement, velocity=None):
    run = Run(given)
    run.set_motion(displacement, 0.0 * displacement if velocity is None else velocity)
    return run


@pytest.mark.parametrize("axisymmetric", [False, True])
def test_the_smallest_area_is_found(axisymmetric):
    mesh = rectangle(9, 15, jitter=0.2)  # three chunks
    given = problem(mesh, UNIT, axisymmetric=axisymmetric)
    displacement = 0.01 * np.random.default_rng(3).normal(size=mesh.nodes.shape)
    ratio = replace(mesh, nodes=mesh.nodes + displacement).areas() / mesh.areas()
    sight = at_motion(given, displacement).watch()
    assert sight.area == pytest.approx(ratio.min(), rel=1e-12)
    assert sight.area_element == ratio.argmin()


def test_a_turn_and_a_stretch_change_no_area_but_by_their_determinant():
    mesh = rectangle(3, 3, jitter=0.2)
    matrix = np.array([[0.6, -0.8], [0.8, 0.6]]) @ np.diag([2.0, 0.25])
    displacement = mesh.nodes @ (matrix - np.eye(2)).T
    assert at_motion(problem(mesh, UNIT), displacement).watch().area == pytest.approx(0.5)


def test_an_element_inside_out_ends_the_run_at_its_start():
    mesh = rectangle(3, 3)
    displacement = np.zeros_like(mesh.nodes)
    displacement[5] = [2.0, 0.0]
    with pytest.raises(CoreError, match=r"step 0, .*, element \d+: it has turned inside out; try"):
        at_motion(problem(mesh, UNIT), displacement).advance(0)


def test_speed_is_relative_to_the_body():
    """The faster node stands in the stiffer body, and is the slower one for it."""
    mesh = join(soft=rectangle(2, 2), stiff=moved(rectangle(2, 2), (2.0, 0.0)))
    stiff = replace(UNIT, young=100.0)
    given = problem(mesh, materials=(UNIT, stiff))
    velocity = np.zeros_like(mesh.nodes)
    velocity[3], velocity[12] = [0.03, 0.04], [0.3, 0.0]
    sight = at_motion(given, 0.0 * velocity, velocity).watch()
    assert sight.speed == pytest.approx(0.05 / np.sqrt(UNIT.modulus))
    assert sight.speed_node == 3


def deepest(mesh, x, h):
    """Deepest boundary node in an element, node and element, by brute force."""
    found = (0.0, -1, -1)
    for element, corners in enumerate(mesh.triangles):
        corner = x[corners]
        along = np.roll(corner, -1, axis=0) - corner
        along /= np.hypot(*along.T)[:, None]
        arm = x[:, None] - corner
        depth = (along[:, 0] * arm[..., 1] - along[:, 1] * arm[..., 0]).min(axis=1)
        depth[corners] = 0.0
        if depth.max() / h > found[0]:
            found = (depth.max() / h, int(depth.argmax()), element)
    return found


@pytest.mark.parametrize("seed", range(4))
def test_no_overlap_is_missed_however_deep(seed):
    """Single triangles that are thrown about, far over the depth at which contact lets go."""
    run = crushed_rubble(0.9, jitter=0.2, n=5)
    mesh = run.problem.mesh
    rng = np.random.default_rng(seed)
    scatter = 10.0 ** rng.uniform(-5.0, -2.5)
    shift = scatter * rng.normal(size=(len(mesh.triangles), 2))
    displacement = np.zeros_like(mesh.nodes)
    displacement[mesh.triangles] = (shift * (mesh.body == 0)[:, None])[:, None]
    run.set_motion(displacement, 0.0 * displacement)
    edges = mesh.nodes[np.roll(mesh.triangles, -1, axis=1)] - mesh.nodes[mesh.triangles]
    shortest = np.hypot(*np.moveaxis(edges, -1, 0))[mesh.body == 0].min()
    sight = run.watch()
    depth, node, element = deepest(mesh, mesh.nodes + displacement, shortest)
    assert sight.overlap == pytest.approx(depth, rel=1e-9)
    assert (sight.overlap_node, sight.overlap_element) == (node, element)
    assert depth > 0.0


def test_parts_without_contact_may_overlap_and_faces_that_touch_do_not():
    bar = rectangle(4, 4, jitter=0.2)
    apart = join(a=bar, b=moved(bar, (1.0, 0.0)))
    inside = np.zeros_like(apart.nodes)
    inside[len(bar.nodes) :, 0] = -0.3
    both = (UNIT, UNIT)
    assert at_motion(problem(apart, materials=both), inside).watch().overlap == 0.0
    sight = at_motion(contact_problem(apart), inside).watch()
    assert sight.overlap > 0.05
    assert at_motion(contact_problem(apart), 0.0 * inside).watch().overlap < 1e-12


@pytest.mark.parametrize("load", ["pull", "squeeze"])
def test_pieces_of_cut_elements_have_the_step_that_the_core_would_give_them(cracking, load):
    model = cracking(load, "intra_element")
    run = model.start()
    while run.watch().step_element < 0:
        assert run.step < 4000, "no element is cut"
        run.advance(20)
    run.advance(200)
    nodes, triangles, body, alive = run.mesh()
    names = run.problem.mesh.body_names
    living = Mesh(nodes, triangles[alive], body[alive], names, {})
    alone = replace(
        model.problem, fracture=None, contact=None, velocity_loads=(), pressure_loads=()
    )
    now, element = Run(replace(alone, mesh=living)).critical_step
    start, _ = Run(alone).critical_step
    sight = run.watch()
    assert sight.step == pytest.approx(min(1.0, now / start), rel=1e-9)
    if sight.step < 1.0:
        assert sight.step_element == np.flatnonzero(alive)[element]
    assert sight.step > 0.4 - 1e-9


def test_cracks_along_edges_leave_the_step_alone(cracking):
    run = cracking("pull", "inter_element").start()
    while run.sizes().cracks == 0:
        run.advance(20)
    assert (run.watch().step, run.watch().step_element) == (1.0, -1)


def spoiled(place):
    """A run of one chunk whose state has NaN at a place of its checkpoint."""
    mesh = rectangle(3, 3)
    run = Run(problem(mesh, UNIT))
    run.advance(1)
    state = run.save()
    state[1] = 1.0  # the chunk counts as one that has yielded
    state[place(len(mesh.nodes))] = np.nan
    run.restore(state)
    return run.watch()


def test_a_node_that_is_nowhere_is_named():
    sight = spoiled(lambda nodes: 2 + 2 * 7)
    assert (sight.bad_node, sight.bad_element) == (7, -1)


def test_an_element_that_has_lost_its_plastic_strain_is_named():
    """Nothing that is computed from such a value ever compares as too large."""
    sight = spoiled(lambda nodes: 2 + 8 * nodes + 4 * 128 + 5)
    assert (sight.bad_node, sight.bad_element) == (-1, 5)


@pytest.mark.restart
@pytest.mark.parametrize("mode", ["inter_element", "intra_element"])
def test_a_look_changes_no_bit(cracking, mode):
    one, other = (cracking("squeeze", mode).start() for _ in range(2))
    for _ in range(30):
        one.advance(20)
        one.watch()
        other.advance(20)
    assert one.sizes().cracks > 0
    assert np.array_equal(one.save().view(np.int64), other.save().view(np.int64))


def test_a_whole_body_at_rest_has_nothing_to_say():
    mesh = rectangle(3, 3, jitter=0.2)
    run = Run(contact_problem(mesh, ROCK, velocity_loads=(hold("x", [0], 0),)))
    run.advance(10)
    sight = run.watch()
    assert (sight.area, sight.speed, sight.step, sight.overlap) == (1.0, 0.0, 1.0, 0.0)
    assert (sight.bad_node, sight.bad_element) == (-1, -1)
