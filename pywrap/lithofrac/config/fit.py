"""Whether the sections of a case fit together: one sentence for each thing that does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lithofrac.config.base import MM
from lithofrac.config.contact import PLATEN, ROCK
from lithofrac.config.element_count import MOST_ELEMENTS, element_count, platen_count
from lithofrac.config.gmsh_file import BoundaryLoading, GmshFile
from lithofrac.config.loading import TractionLoading
from lithofrac.config.material import Material
from lithofrac.config.scene import SIZE_KEYS, Brazilian, Hole, PlaneStrain, Punch

if TYPE_CHECKING:
    from lithofrac.config.case import Case

WITH_PLATENS = ("plane_strain", "punch", "brazilian", "hole")
UNCONFINED = ("hole_quarter", "hole", "bar", "brazilian")


def misfits(case: Case) -> list[str]:
    """Sentences, each beginning with the key that is wrong."""
    if isinstance(case.scene, GmshFile) or isinstance(case.loading, BoundaryLoading):
        return _own_geometry_problems(case)
    return [
        *_loading_problems(case),
        *_platen_problems(case),
        *_contact_problems(case),
        *_fracture_problems(case),
        *_size_problems(case),
        *_count_problems(case),
        *case.guards.problems(),
    ]


def _own_geometry_problems(case: Case) -> list[str]:
    """What can be said of a geometry of one's own before its file is read."""
    scene, loading = case.scene, case.loading
    if not isinstance(scene, GmshFile):
        return [f"loading.kind = boundaries: the scene {scene.kind} has none, expected gmsh_file"]
    if not isinstance(loading, BoundaryLoading):
        return [f"loading.kind = {loading.kind}: the scene gmsh_file expects boundaries"]
    problems = _fracture_problems(case)
    if case.platens is not None:
        problems.append("platens: the scene gmsh_file has none but its own bodies, leave it out")
    return [*problems, *scene.seed_problems(case.mesh.seed)]


def too_large(material: Material, width: float) -> str:
    """Why elements of crack band width `width` [m] are refused, or nothing if they are not."""
    if not width < material.compressive_width_limit:
        return (
            f"crack band width {width / MM:.4g} mm of the largest element is not below the limit "
            f"of {material.compressive_width_limit / MM:.4g} mm for material.reference_size_mm = "
            f"{material.reference_size_mm:g}, above which compressive softening is steeper than "
            "elastic unloading"
        )
    if width < material.band_width_limit:
        return ""
    return (
        f"crack band width {width / MM:.4g} mm of the largest element is not below the limit of "
        f"{material.band_width_limit / MM:.4g} mm, 2 Gf E / ((1 + nu) ft^2), above which softening "
        "has no unique answer"
    )


def _loading_problems(case: Case) -> list[str]:
    """Keys of the loading that the scene has no place for."""
    kind, loading = case.scene.kind, case.loading
    if isinstance(loading, TractionLoading):
        if kind in ("hole_quarter", "bar"):
            return []
        return [f"loading.kind = traction: the scene {kind} is loaded by velocity only"]
    problems = []
    if loading.confinement_MPa > 0 and kind in UNCONFINED:
        problems.append(
            f"loading.confinement_MPa = {loading.confinement_MPa:g}: the scene {kind} has no "
            "confined faces, expected 0"
        )
    if loading.lateral_stiffness_over_young > 0 and kind != "plane_strain":
        what = "springs on its lateral platens" if kind == "punch" else "lateral platens"
        problems.append(
            f"loading.lateral_stiffness_over_young = {loading.lateral_stiffness_over_young:g}: "
            f"the scene {kind} has no {what}, expected 0"
        )
    if loading.sense == "stretch" and case.platens is not None:
        problems.append("loading.sense = stretch: platens only push, expected shorten")
    elif loading.sense == "stretch" and loading.confinement_MPa > 0:
        problems.append(
            "loading.sense = stretch: the ends cannot follow a confinement first, expected shorten"
        )
    return problems


def _platen_problems(case: Case) -> list[str]:
    """Platens that the scene lacks, has no place for, or that do not fit."""
    scene, platens = case.scene, case.platens
    if platens is None:
        if isinstance(scene, (Punch, Brazilian, Hole)):
            return [f"platens: missing key, the scene {scene.kind} is loaded by platens"]
        if isinstance(scene, PlaneStrain) and scene.lateral_platens:
            return ["scene.lateral_platens = True: expected a section platens: that describes them"]
        return []
    if scene.kind not in WITH_PLATENS:
        known = ", ".join(WITH_PLATENS)
        return [f"platens: the scene {scene.kind} has no platens, expected one of: {known}"]
    problems = []
    if case.contact is None:
        problems.append("platens: they touch the rock by contact, expected a section contact:")
    over = f"platens.overhang_mm = {platens.overhang_mm:g}"
    if platens.overhang <= -loaded_width(scene) / 2:
        problems.append(
            f"{over}: leaves nothing of a loaded face of {loaded_width(scene) / MM:g} mm, expected "
            f"above {-loaded_width(scene) / MM / 2:g}"
        )
    if isinstance(scene, PlaneStrain) and scene.lateral_platens and platens.overhang >= 0:
        problems.append(
            f"{over}: the loading platens would run into the lateral ones, expected below 0"
        )
    return problems


def loaded_width(scene: PlaneStrain | Punch | Brazilian | Hole) -> float:
    """Width of the face that a loading platen presses on [m]."""
    if isinstance(scene, Punch):
        return scene.strip_width
    if isinstance(scene, Hole):
        return scene.height
    return scene.width if isinstance(scene, PlaneStrain) else scene.flat_width


def _contact_problems(case: Case) -> list[str]:
    """Friction of surfaces that the scene does not have."""
    if case.contact is None:
        return []
    return case.contact.problems([ROCK] if case.platens is None else [PLATEN, ROCK])


def _fracture_problems(case: Case) -> list[str]:
    """Reasons why no crack could be inserted."""
    if not case.fracture.on:
        return []
    key, scene = f"fracture.mode = {case.fracture.mode}", case.scene
    problems = []
    if scene.kind == "triaxial" or getattr(scene, "axisymmetric", False):
        problems.append(
            f"{key}: the scene {scene.kind} is axisymmetric, where cracks along the hoop cannot "
            "be inserted, expected off"
        )
    if case.contact is None:
        problems.append(f"{key}: faces of cracks need a section contact:, expected it or off")
    materials = [case.material, *getattr(scene, "materials", {}).values()]
    if all(material.elastic for material in materials):
        problems.append(f"{key}: the material is elastic, nothing in it can fail, expected off")
    return problems


def _size_problems(case: Case) -> list[str]:
    """Refuse elements above the limits of unique softening, by their nominal size."""
    nominal = case.scene.element_size
    width = case.material.band_width_of(0.5 * nominal**2)
    why = too_large(case.material, width)
    key = SIZE_KEYS.get(case.scene.kind, "element_size_mm")
    return [f"scene.{key} = {getattr(case.scene, key):g}: {why}"] if why else []


def _count_problems(case: Case) -> list[str]:
    """Refuse meshes that would take hours or all memory, before gmsh is started."""
    scene, platens = case.scene, case.platens
    count = element_count(scene)
    if count <= MOST_ELEMENTS:
        if platens is None or scene.kind not in WITH_PLATENS:
            return []
        count = platen_count(scene, platens)
        if count <= MOST_ELEMENTS:
            return []
        return [
            f"platens.element_size_over_rock = {platens.element_size_over_rock:g}: about "
            f"{count:.2g} elements of platens, expected at most {MOST_ELEMENTS}"
        ]
    key = FINEST_KEYS.get(scene.kind, "element_size_mm")
    return [
        f"scene.{key} = {getattr(scene, key):g}: about {count:.2g} elements, expected at most "
        f"{MOST_ELEMENTS}"
    ]


FINEST_KEYS = {
    "hole_quarter": "wall_elements_per_radius",
    "hole": "wall_elements_per_radius",
    "punch": "strip_element_size_mm",
}  # key that sets the size of the smallest elements, where it is not `element_size_mm`
