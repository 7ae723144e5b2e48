"""Which module makes which kind of scene."""

from lithofrac.config.case import Case
from lithofrac.config.errors import ConfigError
from lithofrac.config.fit import too_large
from lithofrac.config.gmsh_file import GmshFile
from lithofrac.config.scene import SIZE_KEYS
from lithofrac.problem import Mesh, Problem
from lithofrac.scenes import (
    bar,
    brazilian,
    gmsh_file,
    hole,
    hole_quarter,
    plane_strain,
    punch,
    single_element,
    triaxial,
)
from lithofrac.scenes._fit import misfit, unmerged

SCENES = {
    "single_element": single_element,
    "triaxial": triaxial,
    "plane_strain": plane_strain,
    "hole_quarter": hole_quarter,
    "hole": hole,
    "bar": bar,
    "punch": punch,
    "brazilian": brazilian,
    "gmsh_file": gmsh_file,
}


def make_mesh(case: Case, seed: int | None = None) -> Mesh:
    """Mesh of a case.

    Parameters
    ----------
    seed : realisation, default the one of the case

    Raises
    ------
    MeshError
        When gmsh gives none.
    """
    return SCENES[case.scene.kind].mesh(case, case.mesh.seed if seed is None else seed)


def make_problem(case: Case, mesh: Mesh) -> Problem:
    """All that a run of the case on that mesh needs, in SI units.

    Raises
    ------
    ConfigError
        When the mesh is of another case, or the largest element of the rock is above a limit of
        unique softening (eq. 16, or a stretched hardening table).
    """
    why = misfit(case, mesh)
    if why:
        raise ConfigError(why)
    problem = SCENES[case.scene.kind].problem(case, mesh)
    for number, (body, material) in enumerate(zip(mesh.body_names, problem.materials, strict=True)):
        width = float(material.band_width_of(mesh.areas()[mesh.body == number].max()))
        why = too_large(material, width)
        if why:
            raise ConfigError(f"{_size_key(case, body)}: {why}")
    why = unmerged(mesh) if case.contact is None else ""
    if why:
        raise ConfigError(why)
    return problem


def _size_key(case: Case, body: str) -> str:
    """Key and value that set the size of the largest elements of a body."""
    if isinstance(case.scene, GmshFile):
        return f"scene.file = {case.scene.file}: physical surface {body!r}"
    key = SIZE_KEYS.get(case.scene.kind, "element_size_mm")
    return f"scene.{key} = {getattr(case.scene, key):g}"
