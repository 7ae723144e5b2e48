"""Prism under lateral confinement, shortened between smooth ends (Klerck 2004, Fig. 8a).

Choice: the confining frame is a spring k on each face. The pressure is the confinement plus k
times the lateral strain since the start of axial loading; k = 0 is a soft pressure. It acts on the
rock itself, or on the backs of lateral platens. Where lateral platens stand beside the rock over
its whole height, the loading platens must be narrower than the rock to come between them.
"""

import numpy as np

from lithofrac.config.case import Case
from lithofrac.problem import Measures, Mesh, PressureLoad, Problem, Ramp, VelocityLoad
from lithofrac.scenes._common import settings, transit
from lithofrac.scenes._join import flattened, joined
from lithofrac.scenes._platens import back_of, guided, name_of, platen, pushed
from lithofrac.scenes._rectangle import rectangle
from lithofrac.scenes._timing import velocity_timing
from lithofrac.scenes.single_element import isotropic_strain


def mesh(case: Case, seed: int) -> Mesh:
    """The whole specimen, as a shear band is not symmetric, and its platens."""
    scene = case.scene
    width, height, size = scene.width, scene.height, scene.element_size
    rock = rectangle(width, height, size, scene.structured, seed)
    if case.platens is None:
        return rock
    faces = {"bottom": (1, 0.0), "right": (0, width), "top": (1, height), "left": (0, 0.0)}
    over = case.platens.overhang
    places = {"bottom": ((-over, width + over), 0.0), "top": ((-over, width + over), height)}
    if scene.lateral_platens:
        places |= {"left": ((0.0, height), 0.0), "right": ((0.0, height), width)}
    platens = {name_of(side): platen(case, side, *at, size) for side, at in places.items()}
    return joined({"rock": flattened(rock, faces), **platens})


def problem(case: Case, mesh: Mesh) -> Problem:
    """Both ends at a constant speed, pressure with a spring on both lateral faces."""
    scene, loading = case.scene, case.loading
    half, half_width = scene.height / 2, scene.width / 2
    preload = isotropic_strain(case, axisymmetric=False)
    axial, lateral = _steel_strain(case)
    timing = velocity_timing(
        loading.speed / half,
        loading.ramp_transits * transit(case),
        loading.end_strain,
        preload + axial,
    )
    spring = loading.lateral_stiffness_over_young * case.material.young  # [Pa] per lateral strain
    return Problem(
        axisymmetric=False,
        velocity_loads=_motions(case, mesh, timing.ends),
        pressure_loads=(
            PressureLoad(
                "lateral",
                _pressed(case, mesh),
                # the spring gives way by the preload; this makes up for it
                loading.confinement + spring * (preload + lateral),
                spring / half_width,
                timing.confinement,
            ),
        ),
        end_time=timing.end_time,
        measures=Measures(
            axial_load="top",
            area=scene.width,
            length=half,
            lateral_load="lateral",
            lateral_length=half_width,
            start_time=timing.start_time,
        ),
        **settings(case, mesh, {"centre": (half_width, half)}),
    )


def _steel_strain(case: Case) -> tuple[float, float]:
    """What the loading and the lateral platens give way under the confinement [-].

    Over half the height and half the width of the rock.
    """
    scene, platens = case.scene, case.platens
    if platens is None:
        return 0.0, 0.0
    shorter = platens.shortening(case.loading.confinement)
    axial = 0.0 if platens.rigid else shorter / (scene.height / 2)
    return axial, shorter / (scene.width / 2) if scene.lateral_platens else 0.0


def _motions(case: Case, mesh: Mesh, ramp: Ramp) -> tuple[VelocityLoad, ...]:
    """Motion of the ends of the rock or of their platens; guides of the lateral ones."""
    speed = -case.loading.speed if case.loading.sense == "shorten" else case.loading.speed
    if case.platens is None:
        return (
            VelocityLoad("bottom", mesh.nodes_of("bottom"), 1, -speed, ramp),
            VelocityLoad("top", mesh.nodes_of("top"), 1, speed, ramp),
        )
    sides = ("left", "right") if case.scene.lateral_platens else ()
    return (
        *pushed(case, mesh, "bottom", "bottom", -speed, ramp),
        *pushed(case, mesh, "top", "top", speed, ramp),
        *(guided(mesh, side) for side in sides),
    )


def _pressed(case: Case, mesh: Mesh) -> np.ndarray:
    """Edges that the lateral pressure acts on: of the rock, or the backs of its platens."""
    if case.scene.lateral_platens:
        return np.concatenate([back_of(mesh, "left"), back_of(mesh, "right")])
    return np.concatenate([mesh.edge_sets["left"], mesh.edge_sets["right"]])
