"""Platens of the scenes: how they touch, are held, and press (pywrap/lithofrac/scenes/)."""

import numpy as np
import pytest

from lithofrac.core import Run

SANDSTONE = {"scene__element_size_mm": 2.0}
WITH_PLATENS = {
    "punch_gf60": {},
    "brazilian": {},
    "hole_r16.3": {},
    "sandstone_soft_p10": SANDSTONE,
    "sandstone_plane_strain_p10": SANDSTONE,
}


@pytest.fixture(params=WITH_PLATENS)
def problem(request, problem_of):
    return problem_of(request.param, **WITH_PLATENS[request.param])[1]


def load(loads, name):
    return next(load for load in loads if load.name == name)


def body_nodes(mesh, name):
    return np.unique(mesh.triangles[mesh.body == mesh.body_names.index(name)])


def test_bodies_share_no_node(problem):
    mesh = problem.mesh
    nodes = [body_nodes(mesh, name) for name in mesh.body_names]
    assert len(np.unique(np.concatenate(nodes))) == sum(map(len, nodes))


def test_faces_of_rock_and_platens_coincide_to_the_bit(problem):
    mesh = problem.mesh
    faces = {"left": "right", "right": "left", "top": "bottom", "bottom": "top"}
    for name in mesh.body_names[1:]:
        side = name.removesuffix("_platen")
        across = 1 if side in ("top", "bottom") else 0
        rock = mesh.nodes_of("strip" if "strip" in mesh.edge_sets and side == "top" else side)
        platen = mesh.nodes_of(f"{name}.{faces[side]}")
        assert len(set(mesh.nodes[rock, across]) | set(mesh.nodes[platen, across])) == 1


def test_the_rock_sets_the_time_step(problem):
    _, element = Run(problem).critical_step
    assert problem.mesh.body_names[problem.mesh.body[element]] == "rock"


def test_platens_are_steel_and_the_friction_is_that_of_the_case(problem_of):
    case, problem = problem_of("punch_gf60")
    assert problem.materials == (case.material, *3 * (case.platens.material,))
    table = problem.contact.table(problem.mesh)
    assert problem.contact.surfaces(problem.mesh) == list(problem.mesh.body_names)
    assert table[0] == pytest.approx([1.2, 0.005, 0.005, 0.005])
    assert (table[1:, 1:] == 0.0).all()


def test_keys_of_fracture_reach_the_problem(problem_of):
    assert problem_of("punch_gf60")[1].fracture is None
    _, problem = problem_of(
        "punch_discrete",
        fracture__weights="failure_factor",
        fracture__release_steps=7,
        fracture__reset="paper",
        fracture__interval_steps=3,
    )
    fracture = problem.fracture
    assert (fracture.mode, fracture.weights) == ("inter_element", "failure_factor")
    assert (fracture.release_steps, fracture.reset, fracture.interval) == (7, "paper", 3)


def test_the_punch_moves_when_the_confinement_is_complete_and_goes_one_millimetre(problem_of):
    _, problem = problem_of("punch_gf60")
    punch, lateral = load(problem.velocity_loads, "punch"), problem.pressure_loads[0]
    assert (punch.speed, punch.component, lateral.pressure) == (-0.1, 1, 4.5e6)
    assert punch.ramp.start == lateral.ramp.start + lateral.ramp.duration
    assert problem.measures.start_time == punch.ramp.start
    way = 0.1 * (problem.end_time - punch.ramp.start - punch.ramp.duration / 2)
    assert way == pytest.approx(1e-3, rel=1e-3)
    assert (problem.measures.area, problem.measures.length) == (10e-3, pytest.approx(81e-3))


@pytest.mark.parametrize("rigid", [True, False])
def test_a_rigid_platen_moves_as_a_whole_and_another_by_its_back(rigid, problem_of):
    _, problem = problem_of("sandstone_soft_p10", platens__rigid=rigid, **SANDSTONE)
    top, guide = (load(problem.velocity_loads, name) for name in ("top", "top_guide"))
    mesh = problem.mesh
    moved = body_nodes(mesh, "top_platen") if rigid else mesh.nodes_of("top_platen.top")
    assert np.array_equal(top.nodes, moved)
    assert np.array_equal(guide.nodes, moved)
    assert (top.component, guide.component, guide.speed) == (1, 0, 0.0)


def test_backs_of_lateral_platens_hold_the_confinement_at_the_start_of_axial_loading(problem_of):
    case, problem = problem_of("sandstone_plane_strain_p10", **SANDSTONE)
    (lateral,) = problem.pressure_loads
    x = problem.mesh.nodes[lateral.edges, 0]
    assert sorted(set(np.round(x.ravel(), 9))) == [-0.01, 0.02]
    young, poisson = case.material.young, case.material.poisson
    rock = (1 + poisson) * (1 - 2 * poisson) * 10e6 / young * 5e-3  # isotropic in plane
    steel = (1 - 0.3**2) * 10e6 / 210e9 * 10e-3
    at_start = lateral.pressure - lateral.stiffness * (rock + steel)
    assert at_start == pytest.approx(10e6, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "rigid", "across"),
    [
        ("sandstone_soft_p10", True, 0.01),
        ("sandstone_soft_p10", False, 0.02),
        ("sandstone_plane_strain_p10", True, 0.02),
    ],
)
def test_stress_is_the_confinement_when_it_is_complete_and_nearly_uniform(
    name, rigid, across, problem_of
):
    """Lateral stress to `across`: ends stick a little, platens bend a little."""
    _, problem = problem_of(name, platens__rigid=rigid, **SANDSTONE)
    run = Run(problem)
    run.advance(round(problem.measures.start_time / run.dt))
    rock = np.flatnonzero(problem.mesh.body == 0)
    stress = run.elements(rock).stress
    assert stress[:, 1].mean() == pytest.approx(-10e6, rel=0.04)  # inertia of the ends
    assert stress[:, 0].mean() == pytest.approx(-10e6, rel=0.02)
    assert stress[:, 1].std() < 0.02 * 10e6
    assert stress[:, 0].std() < across * 10e6
    assert abs(run.energy().residual) < 1e-9
    assert run.contact_statistics().max_penetration_over_h < 1e-5


def test_the_punch_is_carried_by_the_base(problem_of):
    """Forces of punch and base agree while nothing fails, and no contact opens."""
    sizes = {"scene__strip_element_size_mm": 2.0, "scene__element_size_mm": 8.0}
    _, problem = problem_of("punch_gf60", **sizes)
    run = Run(problem)
    names = [load.name for load in problem.velocity_loads]
    at = [names.index("punch"), names.index("bottom")]
    run.advance(round((problem.measures.start_time + 5e-4) / run.dt))
    forces = []
    for _ in range(50):
        run.advance(10)
        forces.append(run.loads()[at, 0])
    punch, base = np.array(forces).T
    assert -punch.mean() == pytest.approx(base.mean(), rel=0.01)
    assert (np.diff(-punch) > 0).all()  # the force rises without a jump back
    assert abs(run.energy().residual) < 1e-9
    assert run.contact_statistics().max_penetration_over_h < 1e-4
