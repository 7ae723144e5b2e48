"""Brazilian test: a disc split along its loaded diameter between two platens.

Choice: two small flats give the platens a hold. The axial stress is 2 P / (pi D), the tensile
stress across the loaded diameter of a disc under two point loads.
"""

import numpy as np

from lithofrac.config.case import Case
from lithofrac.problem import Measures, Mesh, Problem
from lithofrac.scenes._common import settings, transit
from lithofrac.scenes._finish import finished
from lithofrac.scenes._gmsh import mesh_from
from lithofrac.scenes._join import flattened, joined
from lithofrac.scenes._platens import name_of, platen, pushed
from lithofrac.scenes._size import jittered
from lithofrac.scenes._timing import velocity_timing


def mesh(case: Case, seed: int) -> Mesh:
    """The disc about the origin, and the platens below and above it."""
    scene = case.scene
    reach = scene.flat_width / 2 + case.platens.overhang
    half, size = scene.height / 2, scene.element_size
    return joined(
        {
            "rock": _disc(case, seed),
            name_of("bottom"): platen(case, "bottom", (-reach, reach), -half, size),
            name_of("top"): platen(case, "top", (-reach, reach), half, size),
        }
    )


def _disc(case: Case, seed: int) -> Mesh:
    """Elements of one size."""
    scene = case.scene
    x, y, radius = scene.flat_width / 2, scene.height / 2, scene.radius
    raw = mesh_from(
        f"""\
Point(1) = {{0, 0, 0}};
Point(2) = {{{-x!r}, {-y!r}, 0}};
Point(3) = {{{x!r}, {-y!r}, 0}};
Point(4) = {{{radius!r}, 0, 0}};
Point(5) = {{{x!r}, {y!r}, 0}};
Point(6) = {{{-x!r}, {y!r}, 0}};
Point(7) = {{{-radius!r}, 0, 0}};
Line(1) = {{2, 3}};
Circle(2) = {{3, 1, 4}};
Circle(3) = {{4, 1, 5}};
Line(4) = {{5, 6}};
Circle(5) = {{6, 1, 7}};
Circle(6) = {{7, 1, 2}};
Curve Loop(1) = {{1, 2, 3, 4, 5, 6}};
Plane Surface(1) = {{1}};
Physical Curve("bottom") = {{1}};
Physical Curve("right") = {{2, 3}};
Physical Curve("top") = {{4}};
Physical Curve("left") = {{5, 6}};
Physical Surface("rock") = {{1}};
{jittered(repr(scene.element_size), scene.element_size, seed)}"""
    )
    made = finished(raw.nodes, raw.triangles, raw.lines, raw.body, raw.body_names)
    return flattened(made, {"bottom": (1, -y), "top": (1, y)})


def problem(case: Case, mesh: Mesh) -> Problem:
    """Both platens at a constant speed."""
    scene, loading = case.scene, case.loading
    half = scene.height / 2
    timing = velocity_timing(
        loading.speed / half, loading.ramp_transits * transit(case), loading.end_strain
    )
    return Problem(
        axisymmetric=False,
        velocity_loads=(
            *pushed(case, mesh, "bottom", "bottom", loading.speed, timing.ends),
            *pushed(case, mesh, "top", "top", -loading.speed, timing.ends),
        ),
        pressure_loads=(),
        end_time=timing.end_time,
        measures=Measures(axial_load="top", area=np.pi * scene.radius, length=half),
        **settings(case, mesh, {"centre": (0.0, 0.0)}),
    )
