"""A geometry of one's own: a Gmsh file whose physical groups are the bodies and boundaries."""

from itertools import combinations

import numpy as np

from lithofrac.config.base import MM, MPA
from lithofrac.config.case import Case
from lithofrac.config.errors import ConfigError, suggestion
from lithofrac.config.gmsh_file import SCRIPT, BoundaryLoading
from lithofrac.mesh_flaws import flaw
from lithofrac.npz import MOST_BYTES
from lithofrac.plain_file import refuse_other
from lithofrac.problem import Measures, Mesh, PressureLoad, Problem, Ramp, VelocityLoad
from lithofrac.scenes import _gmsh
from lithofrac.scenes._common import settings
from lithofrac.scenes._finish import finished
from lithofrac.scenes._gmsh import GeoError, meshed, read
from lithofrac.scenes._groups import groups
from lithofrac.scenes._script import forbidden
from lithofrac.scenes._timing import time_to_go

# In the line of the first of the file, so that gmsh counts lines as its author does.
BEFORE = "General.NumThreads = 1; Mesh.Algorithm = 6; Mesh.Smoothing = 10; "
AFTER = "Mesh.MshFileVersion = 2.2; Mesh.Binary = 0; Mesh.SaveAll = 0;"
SPREAD = 0.02  # of all element sizes, between realisations
AXES = "xy"


def mesh(case: Case, seed: int) -> Mesh:
    """Mesh the `.geo`, or read the `.msh`.

    A realisation scales all sizes of a `.geo` by up to 2 %; the first leaves them as they are.

    Raises
    ------
    ConfigError
        Where the file is not what a scene needs.
    MeshError
        Where gmsh cannot be run.
    """
    scene = case.scene
    if scene.seed_problems(seed):
        raise ConfigError(scene.seed_problems(seed)[0])
    named = f"scene.file = {scene.file}"
    try:
        if scene.path.suffix == SCRIPT:
            refuse_other(scene.path, "a script of gmsh")
            text = _script(scene.path.read_text(encoding="utf-8"), seed, named)
            found = meshed(text, _gmsh.OWN_TIME_LIMIT)
        else:
            refuse_other(scene.path, "a mesh of gmsh", MOST_BYTES)
            found = read(scene.path)
    except (GeoError, UnicodeDecodeError) as error:
        raise ConfigError(f"{named}: {error}") from None
    raw = groups(found, named)
    nodes = raw.nodes * scene.unit
    made = finished(nodes, raw.triangles, raw.lines, raw.body, raw.body_names)
    wrong = flaw(made.nodes, made.triangles, made.body, made.body_names, made.edge_sets)
    if wrong:
        raise ConfigError(f"{named}: {wrong}")
    return made


def _script(text: str, seed: int, named: str) -> str:
    why = forbidden(text)
    if why:
        raise ConfigError(f"{named}: {why}")
    if seed == 1:
        return f"{BEFORE}{text}\n{AFTER}\n"
    factor = 1.0 + SPREAD * np.random.default_rng(seed).uniform(-1.0, 1.0)
    return f"{BEFORE}{text}\n{AFTER}\nMesh.MeshSizeFactor = {factor!r} * Mesh.MeshSizeFactor;\n"


def problem(case: Case, mesh: Mesh) -> Problem:
    """Loads on the named boundaries.

    Raises
    ------
    ConfigError
        Where the case names groups that the file lacks, or loads one in two ways.
    """
    loading = case.loading
    problems = _name_problems(case, mesh) or _edge_problems(loading, mesh)
    if problems:
        raise ConfigError("\n".join(problems))
    transit = np.ptp(mesh.nodes, axis=0).max() / case.material.wave_speed
    ramp = loading.ramp_transits * transit
    start = ramp if loading.pressed_MPa else 0.0
    end = ramp + loading.hold_transits * transit
    if loading.driven:
        end = start + time_to_go(loading.farthest / loading.speed_m_s, ramp)
    velocities = _velocities(loading, mesh, Ramp(start, ramp))
    return Problem(
        axisymmetric=False,
        velocity_loads=velocities,
        pressure_loads=tuple(
            PressureLoad(name, mesh.edge_sets[name], value * MPA, ramp=Ramp(0.0, ramp))
            for name, value in loading.pressed_MPa.items()
        ),
        end_time=end,
        measures=_measures(loading, mesh, velocities, start),
        **settings(case, mesh, {}),
    )


def _name_problems(case: Case, mesh: Mesh) -> list[str]:
    """Keys that name no group of the mesh."""
    found, curves, bodies = [], sorted(mesh.edge_sets), list(mesh.body_names)
    for key, name in case.loading.curves.items():
        if not curves:
            found.append(f"loading.{key}: the mesh has no physical curve with a name")
        elif name not in curves:
            found.append(f"loading.{key}: no such physical curve, {suggestion(name, curves)}")
    for name in case.scene.materials:
        if name not in bodies:
            known = suggestion(name, bodies)
            found.append(f"scene.materials.{name}: no such physical surface, {known}")
    if not found and set(bodies) <= set(case.scene.materials):
        found.append(
            "scene.materials: names all physical surfaces, expected one that is of the material "
            "of the case"
        )
    if case.contact is not None:
        found += case.contact.problems([*bodies, *curves])
    return found


def _edge_problems(loading: BoundaryLoading, mesh: Mesh) -> list[str]:
    """Pressed curves inside of the mesh, or on both sides of a cut."""
    t = mesh.triangles
    sides = {(int(row[i]), int(row[(i + 1) % 3])) for row in t for i in range(3)}
    found = []
    for name in loading.pressed_MPa:
        edges = map(tuple, mesh.edge_sets[name].tolist())
        if any((b, a) in sides for a, b in edges):
            found.append(
                f"loading.pressed_MPa.{name}: the curve lies inside of the mesh, expected a "
                "boundary"
            )
    return found


def _velocities(loading: BoundaryLoading, mesh: Mesh, ramp: Ramp) -> tuple[VelocityLoad, ...]:
    """Rollers and driven curves, named CURVE_x or CURVE_y; a node that two hold, one holds.

    Raises
    ------
    ConfigError
        Where two curves move a node differently.
    """
    wanted = [
        (f"driven.{name}", name, component, way / loading.farthest * loading.speed_m_s)
        for name, move in loading.driven.items()
        for component, way in move.components.items()
    ]
    wanted += [
        (f"held.{name}", name, AXES.index(axis), 0.0)
        for name, axes in loading.held.items()
        for axis in axes
    ]
    for (key, name, component, speed), (other, second, across, pace) in combinations(wanted, 2):
        both = np.intersect1d(mesh.nodes_of(name), mesh.nodes_of(second))
        if component == across and speed != pace and len(both):
            x, y = mesh.nodes[both[0]] / MM
            raise ConfigError(
                f"loading.{other}: moves its node at ({x:g}, {y:g}) mm along {AXES[component]} "
                f"otherwise than loading.{key}, expected the same"
            )
    taken: dict[int, np.ndarray] = {0: np.zeros(0, int), 1: np.zeros(0, int)}
    loads = []
    for _, name, component, speed in wanted:
        nodes = np.setdiff1d(mesh.nodes_of(name), taken[component]).astype(np.int32)
        taken[component] = np.union1d(taken[component], nodes)
        if len(nodes):
            motion = ramp if speed else Ramp()
            loads.append(VelocityLoad(f"{name}_{AXES[component]}", nodes, component, speed, motion))
    return tuple(loads)


def _measures(
    loading: BoundaryLoading, mesh: Mesh, velocities: tuple[VelocityLoad, ...], start: float
) -> Measures | None:
    """Axial stress and strain of the curve that `axial` names."""
    if loading.axial is None:
        return None
    moved = loading.driven[loading.axial].components
    (component,) = (c for c, way in moved.items() if way != 0.0)
    width = np.ptp(mesh.nodes[mesh.nodes_of(loading.axial), 1 - component])
    if width == 0.0:
        raise ConfigError(
            f"loading.axial = {loading.axial}: the curve has no width across its way along "
            f"{AXES[component]}"
        )
    return Measures(
        axial_load=f"{loading.axial}_{AXES[component]}",
        area=width,
        length=np.ptp(mesh.nodes[:, component]),
        start_time=start,
    )
