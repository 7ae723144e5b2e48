"""Which module makes which kind of scene."""

from lithofrac.config.case import Case, too_large
from lithofrac.config.errors import ConfigError
from lithofrac.config.scene import SIZE_KEYS
from lithofrac.problem import Mesh, Problem
from lithofrac.scenes import bar, hole_quarter, plane_strain, single_element, triaxial

SCENES = {
    "single_element": single_element,
    "triaxial": triaxial,
    "plane_strain": plane_strain,
    "hole_quarter": hole_quarter,
    "bar": bar,
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
        When the largest element is above the limit of unique softening (eq. 16).
    """
    material = case.material
    width = float(material.band_width_of(mesh.areas().max()))
    if not width < material.band_width_limit:
        key = SIZE_KEYS.get(case.scene.kind, "element_size_mm")
        value = getattr(case.scene, key)
        raise ConfigError(f"scene.{key} = {value:g}: {too_large(material, width)}")
    return SCENES[case.scene.kind].problem(case, mesh)
