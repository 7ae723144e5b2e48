"""Loads, measures and probes of the scenes (pywrap/lithofrac/scenes/)."""

import numpy as np
import pytest

from lithofrac.config import ConfigError, find_case
from lithofrac.config.suite import load_suite
from lithofrac.problem import Mesh
from lithofrac.scenes import make_mesh, make_problem

pytestmark = pytest.mark.no_core

QUICK = load_suite("configs/suite_quick.yaml")


def load(loads, name):
    return next(load for load in loads if load.name == name)


@pytest.mark.parametrize("name", QUICK.cases)
def test_no_component_of_a_node_is_prescribed_twice(name):
    case = QUICK.case(name)
    problem = make_problem(case, make_mesh(case))
    held = [(int(n), load.component) for load in problem.velocity_loads for n in load.nodes]
    assert len(held) == len(set(held))


def test_half_and_whole_cylinder_measure_the_same_strain(problem_of):
    _, half = problem_of("sandstone_triaxial_p10", scene__element_size_mm=2.0)
    _, whole = problem_of(
        "sandstone_triaxial_p10", scene__element_size_mm=2.0, scene__whole_height=True
    )
    assert half.measures == whole.measures
    assert half.end_time == whole.end_time
    assert half.measures.length == 15e-3
    assert half.measures.area == pytest.approx(0.5 * 5e-3**2)  # per radian
    bottom = load(whole.velocity_loads, "bottom")
    assert bottom.speed == -load(whole.velocity_loads, "top").speed == 0.1
    assert load(half.velocity_loads, "bottom").speed == 0.0


def test_the_axis_of_the_cylinder_stays_on_the_axis(problem_of):
    _, problem = problem_of("sandstone_triaxial_p10", scene__element_size_mm=2.0)
    axis = load(problem.velocity_loads, "left")
    assert (axis.component, axis.speed) == (0, 0.0)
    assert (problem.mesh.nodes[axis.nodes, 0] == 0.0).all()


def test_ramps_last_at_least_five_transits(problem_of):
    case, problem = problem_of("sandstone_triaxial_p10", scene__element_size_mm=2.0)
    transit = 30e-3 / case.material.wave_speed
    for ramp in (problem.velocity_loads[2].ramp, problem.pressure_loads[0].ramp):
        assert ramp.duration >= 5 * transit * (1 - 1e-12)


def test_soft_pressure_has_no_spring_and_is_the_confinement(problem_of):
    _, problem = problem_of("sandstone_triaxial_p10", scene__element_size_mm=2.0)
    (lateral,) = problem.pressure_loads
    assert (lateral.pressure, lateral.stiffness) == (10e6, 0.0)


def test_the_spring_holds_the_confinement_at_the_start_of_axial_loading(problem_of):
    case, problem = problem_of("sandstone_plane_strain_k02_p10", scene__element_size_mm=2.0)
    (lateral,) = problem.pressure_loads
    young, poisson = case.material.young, case.material.poisson
    moved = -(1 + poisson) * (1 - 2 * poisson) * 10e6 / young * 5e-3  # inwards, isotropic in plane
    assert lateral.pressure + lateral.stiffness * moved == pytest.approx(10e6, rel=1e-12)


def test_spring_gives_k_times_young_per_lateral_strain(problem_of):
    case, problem = problem_of("sandstone_plane_strain_k02_p10", scene__element_size_mm=2.0)
    (lateral,) = problem.pressure_loads
    strain = 1e-3
    rise = lateral.stiffness * strain * problem.measures.lateral_length
    assert rise == pytest.approx(0.02 * case.material.young * strain, rel=1e-12)


def test_lateral_load_of_plane_strain_is_both_faces(problem_of):
    _, problem = problem_of("sandstone_plane_strain_k02_p10", scene__element_size_mm=2.0)
    x = problem.mesh.nodes[problem.pressure_loads[0].edges, 0]
    assert sorted(set(np.round(x.ravel(), 9))) == [0.0, 0.01]


def test_one_element_is_measured_by_its_apex_unless_confined(problem_of):
    _, free = problem_of("single_element_sandstone")
    assert free.measures.area == pytest.approx(0.5e-3**2 / 6)  # per radian
    _, confined = problem_of("single_element_sandstone", loading__confinement_MPa=5.0)
    assert confined.measures is None
    assert confined.pressure_loads[0].pressure == 5e6


def test_the_hole_is_probed_at_crown_and_sidewall(problem_of):
    _, problem = problem_of("kirsch")
    centre = problem.mesh.centroids()[[problem.probes["crown"], problem.probes["sidewall"]]]
    assert np.abs(centre - [[0, 25e-3], [25e-3, 0]]).max() < 25e-3 / 12


def test_the_hole_is_loaded_on_top_with_symmetry_below_and_at_the_left(problem_of):
    _, problem = problem_of("kirsch")
    assert [(v.name, v.component) for v in problem.velocity_loads] == [("bottom", 1), ("left", 0)]
    (top,) = problem.pressure_loads
    assert top.pressure == 1e6
    assert problem.mesh.nodes[top.edges, 1] == pytest.approx(0.1)


def test_a_probe_far_outside_is_refused(problem_of):
    case, _ = problem_of("sandstone_triaxial_p10")
    outside = case.scene.diameter_mm / 2
    mesh = make_mesh(case)
    size = case.scene.element_size_mm
    for away, accepted in ((0.5 * size, True), (3.0 * size, False)):
        near = {"probes.far": {"x_mm": outside + away, "y_mm": 10.0}}
        moved = find_case("sandstone_triaxial_p10", None, near)
        if accepted:
            assert "far" in make_problem(moved, mesh).probes
            continue
        with pytest.raises(ConfigError, match=r"^probes\.far = .* mm outside of the body"):
            make_problem(moved, mesh)


def test_a_case_may_add_probes(problem_of):
    _, problem = problem_of("bar_wave")
    assert set(problem.probes) == {"centre", "middle"}


def test_stretching_turns_the_speed_round(problem_of):
    _, problem = problem_of(
        "sandstone_triaxial_p00", scene__element_size_mm=2.0, loading__sense="stretch"
    )
    assert load(problem.velocity_loads, "top").speed == 0.1


def test_a_mesh_with_elements_above_the_limit_is_refused():
    case = find_case("single_element_sandstone")
    mesh = make_mesh(case)
    large = Mesh(mesh.nodes * 600, mesh.triangles, mesh.body, mesh.body_names, mesh.edge_sets)
    with pytest.raises(ConfigError) as caught:
        make_problem(case, large)
    assert str(caught.value) == (
        "scene.size_mm = 0.5: crack band width 300 mm of the largest element is not below the "
        "limit of 280 mm, 2 Gf E / ((1 + nu) ft^2), above which softening has no unique answer"
    )
