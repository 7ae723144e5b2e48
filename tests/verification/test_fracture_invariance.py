"""The same punch turned, mirrored or with other numbers cracks at the same places."""

from dataclasses import replace

import numpy as np
import pytest

from lithofrac.config import find_case
from lithofrac.core import Run
from lithofrac.problem import Mesh
from lithofrac.scenes import make_mesh, make_problem

pytestmark = [pytest.mark.verification, pytest.mark.slow]
COARSE = {
    "scene.strip_element_size_mm": 2.0,
    "scene.element_size_mm": 6.0,
    "loading.speed_m_s": 0.3,
}
CRACKS = 5
QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
MIRROR = np.array([[-1.0, 0.0], [0.0, 1.0]])


def moved_problem(problem, turn, node_order, element_order):
    """The problem with positions `turn @ x`; new node i is old node `node_order[i]`.

    `turn` maps axes on axes, because loads hold one component each. A mirror turns the corners
    of every triangle and the ends of every edge around.
    """
    mesh, number = problem.mesh, np.argsort(node_order).astype(np.int32)
    flips = np.linalg.det(turn) < 0

    def renumbered(rows):
        return number[rows][:, ::-1] if flips else number[rows]

    component = np.argmax(abs(turn), axis=0)  # where each old component goes
    sign = turn[component, [0, 1]]
    new_mesh = Mesh(
        mesh.nodes[node_order] @ turn.T,
        renumbered(mesh.triangles[element_order]),
        mesh.body[element_order],
        mesh.body_names,
        {name: renumbered(edges) for name, edges in mesh.edge_sets.items()},
    )
    velocities = tuple(
        replace(
            load,
            nodes=number[load.nodes],
            component=int(component[load.component]),
            speed=sign[load.component] * load.speed,
        )
        for load in problem.velocity_loads
    )
    pressures = tuple(replace(p, edges=renumbered(p.edges)) for p in problem.pressure_loads)
    return replace(
        problem, mesh=new_mesh, velocity_loads=velocities, pressure_loads=pressures, probes={}
    )


def cracked(problem, every=50):
    """Ledger at every `every` steps up to the fifth crack, and the edges of the first five."""
    run, ledger = Run(problem), []
    while run.sizes().cracks < CRACKS:
        assert run.step * run.dt < problem.end_time, "too few cracks"
        run.advance(every)
        energy = run.energy()
        ledger.append([energy.kinetic, energy.elastic, energy.fracture, energy.compressive])
    assert abs(energy.residual) < 1e-6
    edges = run.cracks()
    return np.array(ledger), edges[edges[:, 1] <= CRACKS]


@pytest.fixture(scope="module")
def punch():
    case = find_case("punch_discrete", None, COARSE)
    problem = make_problem(case, make_mesh(case))
    return problem, *cracked(problem)


@pytest.mark.parametrize(
    ("turn", "seed"),
    [(np.eye(2), 7), (QUARTER, None), (QUARTER @ QUARTER, None), (MIRROR, None), (MIRROR, 8)],
    ids=["renumbered", "quarter turn", "half turn", "mirrored", "mirrored and renumbered"],
)
def test_the_first_five_cracks_of_the_punch_do_not_depend_on_how_it_is_laid(punch, turn, seed):
    """Where, in which order, how far failed; positions to 1e-9 of the block, energies to 1e-6."""
    problem, ledger, edges = punch
    mesh = problem.mesh
    node_order, element_order = np.arange(len(mesh.nodes)), np.arange(len(mesh.triangles))
    if seed is not None:
        rng = np.random.default_rng(seed)
        node_order, element_order = rng.permutation(node_order), rng.permutation(element_order)
    other, other_edges = cracked(moved_problem(problem, turn, node_order, element_order))

    assert other.shape == ledger.shape
    difference = abs(other - ledger).max() / ledger.sum(axis=1).max()
    print(f"energies differ by {difference:.1e}")
    assert difference < 1e-6
    size = np.ptp(mesh.nodes)
    back = [other_edges[:, [2 * k, 2 * k + 1]] @ turn for k in (1, 2)]  # turn is orthogonal
    own = [edges[:, [2 * k, 2 * k + 1]] for k in (1, 2)]
    assert len(other_edges) == len(edges)
    # the arms of one crack have no order
    for crack in range(1, CRACKS + 1):
        mine = np.column_stack([p[edges[:, 1] == crack] for p in own])
        theirs = np.column_stack([p[other_edges[:, 1] == crack] for p in back])
        distance = abs(mine[:, None] - theirs[None]).max(axis=2)
        assert distance.min(axis=1).max() < 1e-9 * size
        assert distance.min(axis=0).max() < 1e-9 * size
    np.testing.assert_allclose(other_edges[:, 8], edges[:, 8], rtol=1e-6)
