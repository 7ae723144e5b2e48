"""Whether a mesh from a file is one of the case that is to run on it."""

from lithofrac.config.case import Case
from lithofrac.config.contact import ROCK
from lithofrac.config.gmsh_file import GmshFile
from lithofrac.mesh_flaws import coincident
from lithofrac.problem import Mesh
from lithofrac.scenes._platens import name_of

RECTANGLE = ("bottom", "right", "top", "left")
# Edge sets of the rock that a scene loads, and sides on which it has platens.
EDGE_SETS = {
    "single_element": ("bottom", "lateral", "left"),
    "triaxial": RECTANGLE,
    "plane_strain": RECTANGLE,
    "bar": RECTANGLE,
    "hole_quarter": ("bottom", "top", "left"),
    "hole": ("bottom",),
    "punch": ("bottom",),
    "brazilian": (),
}
PLATENS = {"hole": ("top",), "punch": ("top", "left", "right"), "brazilian": ("bottom", "top")}
AT_ONE_PLACE = 1e-6  # of the shortest edge


def misfit(case: Case, mesh: Mesh) -> str:
    """Why the mesh is not one of the case, or nothing; a mesh of a Gmsh file says so itself."""
    if isinstance(case.scene, GmshFile):
        return ""
    sides = _platens(case)
    bodies = (ROCK, *map(name_of, sides))
    if mesh.body_names != bodies:
        return f"the mesh has the bodies {', '.join(mesh.body_names)}, expected {', '.join(bodies)}"
    wanted = [*EDGE_SETS[case.scene.kind], *(f"{name_of(side)}.{side}" for side in sides)]
    for name in wanted:
        if not len(mesh.edge_sets.get(name, ())):
            return f"the mesh has no edge set {name!r}, expected a mesh of this case"
    return ""


def unmerged(mesh: Mesh) -> str:
    """Names two nodes at one place, between which parts would pass through each other."""
    found = coincident(mesh.nodes, mesh.triangles, AT_ONE_PLACE)
    if found is None:
        return ""
    first, second = (number + 1 for number in found)
    return (
        f"nodes {first} and {second} of the mesh are within {AT_ONE_PLACE:g} of its shortest edge "
        "of each other, expected one node there, or a section contact: that keeps the parts apart"
    )


def _platens(case: Case) -> tuple[str, ...]:
    """Sides of the rock on which the case has platens, in the order of its bodies."""
    if case.platens is None:
        return ()
    if case.scene.kind in PLATENS:
        return PLATENS[case.scene.kind]
    return ("bottom", "top", "left", "right") if case.scene.lateral_platens else ("bottom", "top")
