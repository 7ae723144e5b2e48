"""What a run is expected to take, before it is meshed (pywrap/lithofrac/config/cost.py)."""

import pytest

from lithofrac.config import find_case, load_case, load_suite, predicted
from lithofrac.config.cost import (
    BASE_MB,
    MOST_THREADS,
    RECORD_SECONDS,
    START_MINUTES,
    Cost,
    run_seconds,
)
from lithofrac.plan import plan
from lithofrac.scenes.make import make_mesh, make_problem

QUICK = "configs/suite_quick.yaml"
SCENES = [
    "single_element_sandstone",
    "sandstone_triaxial_p10",
    "sandstone_plane_strain_k02_p10",
    "sandstone_plane_strain_p10",
    "punch_discrete",
    "hole_r25.0",
    "kirsch",
    "bar_wave",
    "brazilian",
]


@pytest.mark.parametrize("name", SCENES)
def test_prediction_is_near_the_plan_of_the_mesh(name):
    """Elements to 25 % and steps to a factor of 1.5, coarse as these meshes are."""
    case = load_suite(QUICK).case(name)
    told, planned = predicted(case), plan(make_problem(case, make_mesh(case)))
    assert told.elements == pytest.approx(planned["elements"], rel=0.25, abs=2)
    assert 1 / 1.5 < told.steps / planned["steps"] < 1.5


@pytest.mark.parametrize("name", SCENES)
def test_check_and_the_scheduler_predict_by_the_same_rates(name):
    """Their elements and steps differ, and with them their seconds, by no more than these."""
    case = load_suite(QUICK).case(name)
    told, planned = predicted(case), plan(make_problem(case, make_mesh(case)))
    work = told.elements * told.steps / (planned["elements"] * planned["steps"])
    few = told.elements / planned["elements"]
    factors = [1.0, work, told.steps / planned["steps"], few]
    ratio = told.seconds / planned["expected_seconds"]
    assert 0.99 * min(factors) < ratio < 1.01 * max(factors)


def test_records_cost_only_where_there_are_steps():
    many = run_seconds(1, 50_000, 1000, 0, 1e9) - run_seconds(1, 50_000, 500, 0, 1e9)
    assert many == pytest.approx(500 * RECORD_SECONDS)
    assert run_seconds(1, 100, 1000, 0, 1e9) == run_seconds(1, 100, 100, 0, 1e9)


def test_half_the_edge_length_is_nearly_eight_times_the_work():
    one, other = (
        predicted(find_case("sandstone_triaxial_p10", None, {"scene.element_size_mm": size}))
        for size in (0.5, 0.25)
    )
    assert other.elements == pytest.approx(4 * one.elements)
    assert other.steps == pytest.approx(2 * one.steps)
    assert 6 < other.seconds / one.seconds < 8  # as a step has a price of its own


def test_every_run_of_the_suite_can_be_asked_for():
    """Whole numbers, as schedulers want them, and modest ones: all of it runs on a laptop."""
    suite = load_suite("configs/suite.yaml")
    for name in suite.names:
        cost = predicted(suite.case(name))
        assert cost.threads == 1
        assert isinstance(cost.mem_mb, int)
        assert isinstance(cost.runtime, int)
        assert BASE_MB < cost.mem_mb < 2 * BASE_MB
        assert START_MINUTES < cost.runtime < 30


def test_cracks_through_elements_take_more_steps():
    one, other = (
        predicted(find_case("hole_r25.0", None, {"fracture.mode": mode}))
        for mode in ("inter_element", "intra_element")
    )
    assert other.elements == one.elements
    assert 2.0 < other.steps / one.steps < 2.5


def test_large_run_asks_for_more():
    large = Cost(elements=1e6, steps=1e5, seconds=2e4)
    assert large.threads == MOST_THREADS
    assert large.mem_mb == BASE_MB + 2000
    assert large.runtime > large.seconds / 60
    assert large.group is None


def test_own_geometry_gets_an_ample_guess():
    cost = predicted(load_case("configs/examples/stope.yaml"))
    assert (cost.threads, cost.group) == (1, None)
    assert cost.runtime > 60
