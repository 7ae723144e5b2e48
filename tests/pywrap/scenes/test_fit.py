"""Meshes of built-in scenes are those of their cases (pywrap/lithofrac/scenes/_fit.py)."""

import pytest
from fuzz_bases import CASES, MATERIALS

from lithofrac.config import load_case
from lithofrac.mesh_flaws import flaw
from lithofrac.problem import Mesh
from lithofrac.scenes import make_mesh, make_problem
from lithofrac.scenes._fit import misfit

pytestmark = pytest.mark.no_core


@pytest.mark.parametrize("name", CASES)
def test_a_scene_fits_its_own_mesh_after_a_way_through_a_file(tmp_path, name):
    for file, text in MATERIALS.items():
        (tmp_path / file).write_text(text)
    (tmp_path / "case.yaml").write_text(CASES[name])
    case = load_case(tmp_path / "case.yaml")
    mesh = make_mesh(case)
    assert misfit(case, mesh) == ""
    assert not flaw(mesh.nodes, mesh.triangles, mesh.body, mesh.body_names, mesh.edge_sets)
    mesh.save(tmp_path / "mesh.npz")
    problem = make_problem(case, Mesh.load(tmp_path / "mesh.npz"))
    for load in problem.velocity_loads:
        assert len(load.nodes)
    for load in problem.pressure_loads:
        assert len(load.edges)
