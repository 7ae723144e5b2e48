"""What a run will take, for a scheduler; of a geometry from a file by meshing it first."""

from __future__ import annotations

from lithofrac.config.case import Case
from lithofrac.config.cost import Cost, predicted
from lithofrac.config.gmsh_file import GmshFile
from lithofrac.plan import plan
from lithofrac.problem import Mesh
from lithofrac.scenes import make_mesh, make_problem

Geometry = tuple  # path, length unit and seed of a mesh


def meshed_cost(case: Case, meshes: dict[Geometry, Mesh]) -> Cost:
    """Elements, steps and time of the case.

    Parameters
    ----------
    case : of any scene; those of our own are not meshed, see `config.cost.predicted`
    meshes : of geometries from files, made so far; a mesh that is made is added

    Raises
    ------
    ConfigError, CoreError
        Where a geometry or its problem is refused, as the run would be.
    """
    if not isinstance(case.scene, GmshFile):
        return predicted(case)
    geometry = case.scene.path.resolve(), case.scene.length_unit, case.mesh.seed
    if geometry not in meshes:
        meshes[geometry] = make_mesh(case)
    expected = plan(make_problem(case, meshes[geometry]))
    return Cost(expected["elements"], expected["steps"], expected["expected_seconds"])
