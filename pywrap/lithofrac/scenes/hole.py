"""Upper half of a block with a hole, pressed by a platen (Klerck 2004, section 3.3, Fig. 13).

Lengths of the mesh are radii until the end, so that blocks of any radius have the same mesh: what
differs between radii is then never the mesh.
"""

from dataclasses import replace

import numpy as np

from lithofrac.config.case import Case
from lithofrac.config.scene import Hole
from lithofrac.problem import Measures, Mesh, Problem
from lithofrac.scenes._common import roller, settings, transit
from lithofrac.scenes._finish import finished
from lithofrac.scenes._gmsh import mesh_from
from lithofrac.scenes._join import flattened, joined
from lithofrac.scenes._platens import name_of, platen, pushed
from lithofrac.scenes._size import jittered
from lithofrac.scenes._timing import velocity_timing

# Fan of gauges for remote fractures: radii over that of the hole, degrees from the load axis.
FAN_RADII = (1.3, 1.6, 2.0, 2.5, 3.0)
FAN_ANGLES = (20.0, 30.0, 40.0, 50.0, 60.0, 70.0)


def mesh(case: Case, seed: int) -> Mesh:
    """Half a block with the hole about the origin, and the platen on top."""
    reach = case.scene.height / 2 + case.platens.overhang
    return joined(
        {
            "rock": _block(case, seed),
            name_of("top"): platen(
                case, "top", (-reach, reach), case.scene.height / 2, case.scene.element_size
            ),
        }
    )


def _block(case: Case, seed: int) -> Mesh:
    """Elements grow in proportion to the distance from the wall, up to the far size."""
    scene = case.scene
    half = scene.block_over_radius / 2
    wall, far = (size / scene.radius for size in (scene.wall_size, scene.element_size))
    slope = (far - wall) / (half - 1.0)
    grown = f"({wall!r} + {slope!r}*(Sqrt(x*x + y*y) - 1))"
    size = f"0.5*({grown} + {far!r} - Fabs({grown} - {far!r}))"  # the smaller of the two
    raw = mesh_from(
        f"""\
Point(1) = {{0, 0, 0}};
Point(2) = {{1, 0, 0}};
Point(3) = {{{half!r}, 0, 0}};
Point(4) = {{{half!r}, {half!r}, 0}};
Point(5) = {{{-half!r}, {half!r}, 0}};
Point(6) = {{{-half!r}, 0, 0}};
Point(7) = {{-1, 0, 0}};
Point(8) = {{0, 1, 0}};
Line(1) = {{2, 3}};
Line(2) = {{3, 4}};
Line(3) = {{4, 5}};
Line(4) = {{5, 6}};
Line(5) = {{6, 7}};
Circle(6) = {{7, 1, 8}};
Circle(7) = {{8, 1, 2}};
Curve Loop(1) = {{1, 2, 3, 4, 5, 6, 7}};
Plane Surface(1) = {{1}};
Physical Curve("bottom") = {{1, 5}};
Physical Curve("right") = {{2}};
Physical Curve("top") = {{3}};
Physical Curve("left") = {{4}};
Physical Curve("hole") = {{6, 7}};
Physical Surface("rock") = {{1}};
{jittered(size, wall, seed)}"""
    )
    made = finished(raw.nodes, raw.triangles, raw.lines, raw.body, raw.body_names)
    made = replace(made, nodes=made.nodes * scene.radius)
    return flattened(made, {"bottom": (1, 0.0), "top": (1, scene.height / 2)})


def problem(case: Case, mesh: Mesh) -> Problem:
    """The platen moves down, the plane of symmetry stays; gauges at the hole and about it."""
    scene, loading = case.scene, case.loading
    half = scene.height / 2
    timing = velocity_timing(
        loading.speed / half, loading.ramp_transits * transit(case), loading.end_strain
    )
    return Problem(
        axisymmetric=False,
        velocity_loads=(
            roller(mesh, "bottom", 1),
            *pushed(case, mesh, "top", "top", -loading.speed, timing.ends),
        ),
        pressure_loads=(),
        end_time=timing.end_time,
        measures=Measures(axial_load="top", area=scene.height, length=half),
        **settings(case, mesh, _gauges(scene)),
    )


def _gauges(scene: Hole) -> dict[str, tuple[float, float]]:
    """Name -> place [m]: crown, both sidewalls, and the fan on both sides of the load axis.

    (0, R) itself is a node: which of its elements is nearest would be chance, so the gauge of the
    crown lies half an element above it. The primary crack opens between the elements there and
    relieves one of them before its strength is used up: both sides are recorded as well. What of
    the fan a small block has no room for is left out.
    """
    radius, size = scene.radius, scene.wall_size
    fan = [
        (side * r * radius * np.sin(np.radians(angle)), r * radius * np.cos(np.radians(angle)))
        for side in (1.0, -1.0)
        for r in FAN_RADII
        for angle in FAN_ANGLES
    ]
    return {
        "crown": (0.0, radius + 0.5 * size),
        "crown_right": (0.5 * size, radius + 0.25 * size),
        "crown_left": (-0.5 * size, radius + 0.25 * size),
        "sidewall_right": (radius, 0.0),
        "sidewall_left": (-radius, 0.0),
        **{
            f"remote_{i:02d}": place
            for i, place in enumerate(fan, start=1)
            if max(map(abs, place)) < 0.5 * scene.height
        },
    }
