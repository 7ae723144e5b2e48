"""Quarter of a square block with a central hole, loaded from above (Klerck 2004, Fig. 13)."""

from lithofrac.config.case import Case
from lithofrac.problem import Mesh, Problem
from lithofrac.scenes._common import roller, settings, top_load, top_measures
from lithofrac.scenes._finish import finished
from lithofrac.scenes._gmsh import mesh_from
from lithofrac.scenes._size import jittered


def mesh(case: Case, seed: int) -> Mesh:
    """Elements grow in proportion to the distance from the wall, up to the far size."""
    scene = case.scene
    radius, half = scene.radius, scene.height / 2
    wall, far = scene.wall_size, scene.element_size
    slope = (far - wall) / (half - radius)
    grown = f"({wall!r} + {slope!r}*(Sqrt(x*x + y*y) - {radius!r}))"
    size = f"0.5*({grown} + {far!r} - Fabs({grown} - {far!r}))"  # the smaller of the two
    raw = mesh_from(
        f"""\
Point(1) = {{0, 0, 0}};
Point(2) = {{{radius!r}, 0, 0}};
Point(3) = {{{half!r}, 0, 0}};
Point(4) = {{{half!r}, {half!r}, 0}};
Point(5) = {{0, {half!r}, 0}};
Point(6) = {{0, {radius!r}, 0}};
Line(1) = {{2, 3}};
Line(2) = {{3, 4}};
Line(3) = {{4, 5}};
Line(4) = {{5, 6}};
Circle(5) = {{6, 1, 2}};
Curve Loop(1) = {{1, 2, 3, 4, 5}};
Plane Surface(1) = {{1}};
Physical Curve("bottom") = {{1}};
Physical Curve("right") = {{2}};
Physical Curve("top") = {{3}};
Physical Curve("left") = {{4}};
Physical Curve("hole") = {{5}};
Physical Surface("rock") = {{1}};
{jittered(size, wall, seed)}"""
    )
    return finished(raw.nodes, raw.triangles, raw.lines, raw.body, raw.body_names)


def problem(case: Case, mesh: Mesh) -> Problem:
    """Symmetry below and at the left, load on top; crown and sidewall of the hole are probed."""
    scene = case.scene
    half = scene.height / 2
    velocities, pressures, end_time = top_load(case, mesh, half)
    return Problem(
        axisymmetric=False,
        velocity_loads=(roller(mesh, "bottom", 1), roller(mesh, "left", 0), *velocities),
        pressure_loads=pressures,
        end_time=end_time,
        measures=top_measures(case, half, half),
        **settings(case, mesh, {"crown": (0.0, scene.radius), "sidewall": (scene.radius, 0.0)}),
    )
