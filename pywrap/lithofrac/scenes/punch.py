"""Strip punch: a raised strip is pressed into its own block (Klerck 2004, section 3.1, Fig. 5).

The block stands on rollers between two lateral platens that are pressed on from behind. They are
loaded first; then the punch, which touches the strip from the start, is set in motion.
"""

import numpy as np

from lithofrac.config.case import Case
from lithofrac.problem import Measures, Mesh, PressureLoad, Problem, Ramp
from lithofrac.scenes._common import roller, settings, transit
from lithofrac.scenes._finish import finished
from lithofrac.scenes._gmsh import mesh_from
from lithofrac.scenes._join import flattened, joined
from lithofrac.scenes._platens import back_of, guided, name_of, platen, pushed
from lithofrac.scenes._size import jittered
from lithofrac.scenes._timing import velocity_timing
from lithofrac.scenes._worst import improved


def mesh(case: Case, seed: int) -> Mesh:
    """Block with its strip, punch, left and right platen."""
    scene, over = case.scene, case.platens.overhang
    middle, half = scene.width / 2, scene.strip_width / 2
    reach = (middle - half - over, middle + half + over)
    sides = (0.0, scene.block_height)
    beside = (scene.fine_size + scene.element_size) / 2
    return joined(
        {
            "rock": _block(case, seed),
            name_of("top"): platen(case, "top", reach, scene.height, scene.fine_size),
            name_of("left"): platen(case, "left", sides, 0.0, beside),
            name_of("right"): platen(case, "right", sides, scene.width, beside),
        }
    )


def _block(case: Case, seed: int) -> Mesh:
    """Elements grow with the distance from the foot of the strip."""
    scene = case.scene
    width, base, top = scene.width, scene.block_height, scene.height
    left, right = (width - scene.strip_width) / 2, (width + scene.strip_width) / 2
    fine, far, radius = scene.fine_size, scene.element_size, scene.fine_radius
    slope = (far - fine) / (base - radius)
    away = f"(Sqrt((x - {width / 2!r})^2 + (y - {base!r})^2) - {radius!r})"
    grown = f"({fine!r} + {slope!r}*0.5*({away} + Fabs({away})))"
    size = f"0.5*({grown} + {far!r} - Fabs({grown} - {far!r}))"  # the smaller of the two
    raw = mesh_from(
        f"""\
Point(1) = {{0, 0, 0}};
Point(2) = {{{width!r}, 0, 0}};
Point(3) = {{{width!r}, {base!r}, 0}};
Point(4) = {{{right!r}, {base!r}, 0}};
Point(5) = {{{right!r}, {top!r}, 0}};
Point(6) = {{{left!r}, {top!r}, 0}};
Point(7) = {{{left!r}, {base!r}, 0}};
Point(8) = {{0, {base!r}, 0}};
Line(1) = {{1, 2}};
Line(2) = {{2, 3}};
Line(3) = {{3, 4}};
Line(4) = {{4, 5}};
Line(5) = {{5, 6}};
Line(6) = {{6, 7}};
Line(7) = {{7, 8}};
Line(8) = {{8, 1}};
Curve Loop(1) = {{1, 2, 3, 4, 5, 6, 7, 8}};
Plane Surface(1) = {{1}};
Physical Curve("bottom") = {{1}};
Physical Curve("right") = {{2}};
Physical Curve("shoulders") = {{3, 7}};
Physical Curve("flanks") = {{4, 6}};
Physical Curve("strip") = {{5}};
Physical Curve("left") = {{8}};
Physical Surface("rock") = {{1}};
{jittered(size, fine, seed)}"""
    )
    boundary = np.unique(np.concatenate(list(raw.lines.values())))
    nodes = improved(raw.nodes, raw.triangles, boundary)
    made = finished(nodes, raw.triangles, raw.lines, raw.body, raw.body_names)
    faces = {"bottom": (1, 0.0), "right": (0, width), "strip": (1, top), "left": (0, 0.0)}
    return flattened(made, faces)


def problem(case: Case, mesh: Mesh) -> Problem:
    """Pressure on the backs of the lateral platens, then the punch at a constant speed."""
    scene, loading = case.scene, case.loading
    ramp = loading.ramp_transits * transit(case)
    confined = ramp if loading.confinement > 0 else 0.0
    timing = velocity_timing(loading.speed / scene.height, ramp, loading.end_strain)
    sides = np.concatenate([back_of(mesh, "left"), back_of(mesh, "right")])
    motion = Ramp(confined, ramp)
    return Problem(
        axisymmetric=False,
        velocity_loads=(
            roller(mesh, "bottom", 1),
            *pushed(case, mesh, "top", "punch", -loading.speed, motion),
            guided(mesh, "left"),
            guided(mesh, "right"),
        ),
        pressure_loads=(
            PressureLoad("lateral", sides, loading.confinement, ramp=Ramp(0.0, confined)),
        ),
        end_time=confined + timing.end_time,
        measures=Measures(
            axial_load="punch",
            area=scene.strip_width,
            length=scene.height,
            lateral_load="lateral",
            lateral_length=scene.width / 2,
            start_time=confined,
        ),
        **settings(
            case,
            mesh,
            {
                "strip_edge": ((scene.width - scene.strip_width) / 2, scene.block_height),
                "axis": (scene.width / 2, scene.block_height - scene.strip_width),
            },
        ),
    )
