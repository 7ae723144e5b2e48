"""Which module makes which kind of scene."""

from lithofrac.config.case import Case
from lithofrac.config.contact import ROCK
from lithofrac.config.errors import ConfigError
from lithofrac.config.fit import too_large
from lithofrac.config.scene import SIZE_KEYS
from lithofrac.problem import Mesh, Problem
from lithofrac.scenes import (
    bar,
    brazilian,
    hole,
    hole_quarter,
    plane_strain,
    punch,
    single_element,
    triaxial,
)
from lithofrac.scenes._fit import misfit

SCENES = {
    "single_element": single_element,
    "triaxial": triaxial,
    "plane_strain": plane_strain,
    "hole_quarter": hole_quarter,
    "hole": hole,
    "bar": bar,
    "punch": punch,
    "brazilian": brazilian,
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
    material = case.material
    areas = mesh.areas()[mesh.body == mesh.body_names.index(ROCK)]
    width = float(material.band_width_of(areas.max()))
    why = too_large(material, width)
    if why:
        key = SIZE_KEYS.get(case.scene.kind, "element_size_mm")
        value = getattr(case.scene, key)
        raise ConfigError(f"scene.{key} = {value:g}: {why}")
    return SCENES[case.scene.kind].problem(case, mesh)
