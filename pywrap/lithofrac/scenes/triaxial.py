"""Cylinder under fluid pressure, shortened between smooth ends (Klerck 2004, Fig. 8c)."""

from lithofrac.config.case import Case
from lithofrac.problem import Measures, Mesh, PressureLoad, Problem, VelocityLoad
from lithofrac.scenes._common import roller, settings, transit
from lithofrac.scenes._rectangle import rectangle
from lithofrac.scenes._timing import velocity_timing
from lithofrac.scenes.single_element import isotropic_strain


def mesh(case: Case, seed: int) -> Mesh:
    """Half of the meridian plane: radius across, whole or upper half of the height up."""
    scene = case.scene
    height = scene.height if scene.whole_height else scene.height / 2
    return rectangle(scene.radius, height, scene.element_size, scene.structured, seed)


def problem(case: Case, mesh: Mesh) -> Problem:
    """Ends at a constant speed, soft pressure on the lateral face."""
    scene, loading = case.scene, case.loading
    half = scene.height / 2
    timing = velocity_timing(
        loading.speed / half,
        loading.ramp_transits * transit(case),
        loading.end_strain,
        isotropic_strain(case, axisymmetric=True),
    )
    speed = -loading.speed if loading.sense == "shorten" else loading.speed
    bottom = roller(mesh, "bottom", 1)
    if scene.whole_height:
        bottom = VelocityLoad("bottom", mesh.nodes_of("bottom"), 1, -speed, timing.ends)
    return Problem(
        axisymmetric=True,
        velocity_loads=(
            roller(mesh, "left", 0),
            bottom,
            VelocityLoad("top", mesh.nodes_of("top"), 1, speed, timing.ends),
        ),
        pressure_loads=(
            PressureLoad(
                "lateral", mesh.edge_sets["right"], loading.confinement, ramp=timing.confinement
            ),
        ),
        end_time=timing.end_time,
        measures=Measures(
            axial_load="top",
            area=scene.radius**2 / 2,
            length=half,
            lateral_load="lateral",
            lateral_length=scene.radius,
            start_time=timing.start_time,
        ),
        **settings(case, mesh, {"centre": (0.0, half if scene.whole_height else 0.0)}),
    )
