"""One right-angled triangle with its legs on the symmetry planes: a uniform stress.

With a confinement the pressure on the hypotenuse carries a part of the axial force, so that the
boundary force is no measure of the axial stress; the probe `element` is.
"""

import numpy as np

from lithofrac.config.case import Case
from lithofrac.problem import Measures, Mesh, PressureLoad, Problem, VelocityLoad
from lithofrac.scenes._common import roller, settings, transit
from lithofrac.scenes._finish import finished
from lithofrac.scenes._timing import velocity_timing


def mesh(case: Case, seed: int) -> Mesh:
    """The triangle; it has no realisations."""
    size = case.scene.element_size
    nodes = np.array([[0.0, 0.0], [size, 0.0], [0.0, size]])
    lines = {
        "bottom": np.array([[0, 1]]),
        "lateral": np.array([[1, 2]]),
        "left": np.array([[2, 0]]),
    }
    return finished(nodes, np.array([[0, 1, 2]]), lines)


def problem(case: Case, mesh: Mesh) -> Problem:
    """Move the upper corner; pressure on the hypotenuse."""
    scene, loading = case.scene, case.loading
    preload = isotropic_strain(case, scene.axisymmetric)
    timing = velocity_timing(
        loading.speed / scene.height,
        loading.ramp_transits * transit(case),
        loading.end_strain,
        preload,
    )
    speed = -loading.speed if loading.sense == "shorten" else loading.speed
    apex = np.array([np.argmax(mesh.nodes[:, 1])], dtype=np.int32)
    # force of a uniform axial stress on the apex: area of the triangle over its height, times
    # the mean radius in axisymmetry
    area = scene.height**2 / 6 if scene.axisymmetric else scene.height / 2
    return Problem(
        axisymmetric=scene.axisymmetric,
        velocity_loads=(
            roller(mesh, "bottom", 1),
            roller(mesh, "left", 0),
            VelocityLoad("top", apex, 1, speed, timing.ends),
        ),
        pressure_loads=(
            PressureLoad(
                "lateral", mesh.edge_sets["lateral"], loading.confinement, ramp=timing.confinement
            ),
        ),
        end_time=timing.end_time,
        measures=None
        if loading.confinement > 0
        else Measures(axial_load="top", area=area, length=scene.height),
        **settings(case, mesh, {"element": (0.0, 0.0)}),
    )


def isotropic_strain(case: Case, axisymmetric: bool) -> float:
    """Axial and lateral strain under the confinement alone, compression positive [-].

    Elastic: p (1 - 2 nu) / E all round, and 1 + nu times that in plane strain.
    """
    material = case.material
    strain = case.loading.confinement * (1 - 2 * material.poisson) / material.young
    return strain if axisymmetric else (1 + material.poisson) * strain
