"""Prism between stiff lateral platens, shortened between smooth ends (Klerck 2004, Fig. 8a).

Choice: each platen is a spring k on its face. The pressure is the confinement plus k times the
lateral strain since the start of axial loading; k = 0 is a soft pressure.
"""

import numpy as np

from lithofrac.config.case import Case
from lithofrac.problem import Measures, Mesh, PressureLoad, Problem, VelocityLoad
from lithofrac.scenes._common import settings, transit
from lithofrac.scenes._rectangle import rectangle
from lithofrac.scenes._timing import velocity_timing
from lithofrac.scenes.single_element import isotropic_strain


def mesh(case: Case, seed: int) -> Mesh:
    """The whole specimen: a shear band is not symmetric."""
    scene = case.scene
    return rectangle(scene.width, scene.height, scene.element_size, scene.structured, seed)


def problem(case: Case, mesh: Mesh) -> Problem:
    """Both ends at a constant speed, pressure with a spring on both lateral faces."""
    scene, loading = case.scene, case.loading
    half, half_width = scene.height / 2, scene.width / 2
    preload = isotropic_strain(case, axisymmetric=False)
    timing = velocity_timing(
        loading.speed / half, loading.ramp_transits * transit(case), loading.end_strain, preload
    )
    spring = loading.lateral_stiffness_over_young * case.material.young  # [Pa] per lateral strain
    speed = -loading.speed if loading.sense == "shorten" else loading.speed
    sides = np.concatenate([mesh.edge_sets["left"], mesh.edge_sets["right"]])
    return Problem(
        axisymmetric=False,
        velocity_loads=(
            VelocityLoad("bottom", mesh.nodes_of("bottom"), 1, -speed, timing.ends),
            VelocityLoad("top", mesh.nodes_of("top"), 1, speed, timing.ends),
        ),
        pressure_loads=(
            PressureLoad(
                "lateral",
                sides,
                # the spring gives way by the preload; this makes up for it
                loading.confinement + spring * preload,
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
