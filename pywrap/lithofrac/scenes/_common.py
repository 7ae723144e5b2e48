"""What every scene fills into its problem in the same way."""

from lithofrac.config.case import Case
from lithofrac.config.contact import ROCK
from lithofrac.config.gmsh_file import GmshFile
from lithofrac.config.loading import TractionLoading
from lithofrac.config.material import Material
from lithofrac.problem import (
    Contact,
    Damping,
    Fracture,
    Guards,
    Measures,
    Mesh,
    PressureLoad,
    Ramp,
    VelocityLoad,
)
from lithofrac.scenes._platens import bodies_of
from lithofrac.scenes._probes import probes
from lithofrac.scenes._timing import velocity_timing


def settings(case: Case, mesh: Mesh, points: dict[str, tuple[float, float]]) -> dict:
    """Keyword arguments of `Problem` that do not depend on the scene."""
    return {
        "mesh": mesh,
        "materials": tuple(_material(case, name) for name in mesh.body_names),
        "damping": Damping(case.damping.fraction, case.damping.alpha_1_s, case.damping.relative_to),
        "contact": _contact(case, mesh),
        "fracture": _fracture(case),
        "time_step_factor": case.time_step_factor,
        "probes": probes(case, mesh, points),
        "records": case.output.records,
        "fields": case.output.fields,
        "guards": Guards(**case.guards.model_dump()),
        "checkpoint_seconds": case.output.checkpoint_seconds,
    }


def _material(case: Case, body: str) -> Material:
    if isinstance(case.scene, GmshFile):
        return case.scene.materials.get(body, case.material)
    return case.material if body == ROCK else case.platens.material


def _contact(case: Case, mesh: Mesh) -> Contact | None:
    """Friction by bodies: `platen` stands for all of them but the rock."""
    if case.contact is None:
        return None
    if isinstance(case.scene, GmshFile):
        return Contact(case.contact.pairs, case.contact.default_friction, case.contact.tolerance)
    table = {
        (a, b): friction
        for (first, second), friction in case.contact.pairs.items()
        for a in bodies_of(first, mesh)
        for b in bodies_of(second, mesh)
    }
    return Contact(table, case.contact.default_friction, case.contact.tolerance)


def _fracture(case: Case) -> Fracture | None:
    """Discrete cracks, where they are on."""
    section = case.fracture
    if not section.on:
        return None
    return Fracture(
        section.mode,
        section.weights,
        section.release_steps,
        section.reset,
        section.interval_steps,
    )


def roller(mesh: Mesh, name: str, component: int) -> VelocityLoad:
    """Hold one component of the nodes of an edge set."""
    return VelocityLoad(name, mesh.nodes_of(name), component)


def transit(case: Case) -> float:
    """Time in which a pressure wave runs through the height of the whole specimen [s]."""
    return case.scene.height / case.material.wave_speed


def top_measures(case: Case, area: float, length: float) -> Measures | None:
    """Axial stress and strain from the edge set "top" when it is moved.

    None under traction: the stress is given then, and the probes measure.
    """
    if isinstance(case.loading, TractionLoading):
        return None
    return Measures(axial_load="top", area=area, length=length)


def top_load(
    case: Case, mesh: Mesh, length: float
) -> tuple[tuple[VelocityLoad, ...], tuple[PressureLoad, ...], float]:
    """Load of an unconfined scene on its edge set "top", and the end time [s].

    Parameters
    ----------
    length : distance from the loaded end to the plane that stays [m]
    """
    loading = case.loading
    if isinstance(loading, TractionLoading):
        ramp = Ramp(0.0, loading.ramp_transits * transit(case))
        load = PressureLoad("top", mesh.edge_sets["top"], loading.stress, ramp=ramp)
        return (), (load,), ramp.duration + loading.hold_transits * transit(case)
    timing = velocity_timing(
        loading.speed / length, loading.ramp_transits * transit(case), loading.end_strain
    )
    speed = -loading.speed if loading.sense == "shorten" else loading.speed
    load = VelocityLoad("top", mesh.nodes_of("top"), 1, speed, timing.ends)
    return (load,), (), timing.end_time
