"""What a run will take, of a geometry from a file by its mesh (pywrap/lithofrac/meshed_cost.py)."""

import pytest

import lithofrac.meshed_cost
from lithofrac.config import find_case, load_case, predicted
from lithofrac.config.errors import ConfigError
from lithofrac.meshed_cost import meshed_cost
from lithofrac.plan import plan
from lithofrac.scenes import make_mesh, make_problem

HOLES = "configs/examples/two_holes.yaml"


def test_a_scene_of_ours_is_not_meshed(monkeypatch):
    monkeypatch.delattr(lithofrac.meshed_cost, "make_mesh")
    case = find_case("punch_discrete", None)
    assert meshed_cost(case, {}) == predicted(case)


@pytest.mark.parametrize("mode", ["inter_element", "intra_element"])
def test_own_geometry_takes_what_check_expects(mode):
    """The step of a run that may cut elements is that of cut ones from its start."""
    case = load_case(HOLES, {"fracture.mode": mode})
    expected = plan(make_problem(case, make_mesh(case)))
    cost = meshed_cost(case, {})
    assert (cost.elements, cost.steps) == (expected["elements"], expected["steps"])
    assert cost.seconds == expected["expected_seconds"]


def test_a_geometry_is_meshed_once_for_all_its_cases(monkeypatch):
    made = []
    monkeypatch.setattr(
        lithofrac.meshed_cost, "make_mesh", lambda case: made.append(case) or make_mesh(case)
    )
    meshes = {}
    for friction in (0.2, 0.4):
        meshed_cost(load_case(HOLES, {"contact.default_friction": friction}), meshes)
    assert len(made) == 1
    meshed_cost(load_case(HOLES, {"mesh.seed": 7}), meshes)
    assert len(made) == 2


def test_a_geometry_that_gmsh_cannot_read_is_refused(tmp_path):
    (tmp_path / "bad.geo").write_text("Point(1) = {0, 0\n")
    text = open(HOLES).read().replace("two_holes.geo", "bad.geo")
    (tmp_path / "bad.yaml").write_text(text)
    with pytest.raises(ConfigError, match=r"bad\.geo"):
        meshed_cost(load_case(tmp_path / "bad.yaml"), {})
