"""Upright bar on a frictionless base: waves, and crack bands under tension."""

from lithofrac.config.case import Case
from lithofrac.problem import Mesh, Problem
from lithofrac.scenes._common import roller, settings, top_load, top_measures
from lithofrac.scenes._rectangle import rectangle


def mesh(case: Case, seed: int) -> Mesh:
    """The whole bar."""
    scene = case.scene
    return rectangle(scene.width, scene.height, scene.element_size, scene.structured, seed)


def problem(case: Case, mesh: Mesh) -> Problem:
    """Base and left face on rollers, the right face too if `laterally_fixed`; load on top."""
    scene = case.scene
    velocities, pressures, end_time = top_load(case, mesh, scene.height)
    rollers = [roller(mesh, "bottom", 1), roller(mesh, "left", 0)]
    if scene.laterally_fixed:
        rollers.append(roller(mesh, "right", 0))
    return Problem(
        axisymmetric=False,
        velocity_loads=(*rollers, *velocities),
        pressure_loads=pressures,
        end_time=end_time,
        measures=top_measures(case, scene.width, scene.height),
        **settings(case, mesh, {"centre": (scene.width / 2, scene.height / 2)}),
    )
