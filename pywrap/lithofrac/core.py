"""The compiled run as Python sees it: arrays in, arrays out, errors raised, indices from 0."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

# Waiting threads must sleep: spinning ones cost a factor eight on a shared machine.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
os.environ.setdefault("GOMP_SPINCOUNT", "3000")  # some 40 us: a step waits less, then sleep

from lithofrac import _core
from lithofrac.errors import CoreError, checked
from lithofrac.problem import Contact, Damping, Fracture, Mesh, Problem

_face = _core.run_face
_new = checked(_face.run_new)
_drop = checked(_face.run_drop)
_add_velocity = checked(_face.run_add_velocity)
_add_pressure = checked(_face.run_add_pressure)
_add_contact = checked(_face.run_add_contact)
_refuse_overlap = checked(_face.run_refuse_overlap)
_tag_surface = checked(_face.run_tag_surface)
_add_fracture = checked(_face.run_add_fracture)
_sizes = checked(_face.run_sizes)
_mesh = checked(_face.run_mesh)
_parts = checked(_face.run_parts)
_failure = checked(_face.run_failure)
_cracks = checked(_face.run_cracks)
_check = checked(_face.run_check)
_set_motion = checked(_face.run_set_motion)
_advance = checked(_face.run_advance)
_clock = checked(_face.run_clock)
_energy = checked(_face.run_energy)
_watch = checked(_face.run_watch)
_loads = checked(_face.run_loads)
_elements = checked(_face.run_elements)
_nodes = checked(_face.run_nodes)
_contact_forces = checked(_face.run_contact_forces)
_contact_statistics = checked(_face.run_contact_statistics)
_checkpoint_size = checked(_face.run_checkpoint_size)
_save = checked(_face.run_save)
_restore = checked(_face.run_restore)

BAND_FACTOR = {"sqrt_2A": 2.0, "sqrt_A": 1.0}
MODES = {"inter_element": 1, "intra_element": 2}  # fortran/fracture/arms.f90
WEIGHTS = {"volume": 0, "failure_factor": 1}  # fortran/fracture/failure_map.f90
RESETS = {"normal": 0, "paper": 1}  # fortran/fracture/element_failure.f90
DAMPING = {"none": 0, "affine": 1, "ground": 2}  # fortran/run/settings.f90


@dataclass(frozen=True)
class Energy:
    """The energy ledger [J], per metre of depth or per radian; `residual` is relative."""

    kinetic: float
    elastic: float
    compressive: float
    fracture: float
    external: float
    damping: float
    residual: float
    initial: float
    contact: float  # work of contact pressure
    friction: float  # work of friction, <= 0
    insertion: float  # work of the bonds that fade on new cracks
    relump: float  # kinetic energy lost as mass went to new nodes, <= 0
    reset: float  # fracture energy that elements may spend again; not part of the balance
    turning: float  # given by elements that turn along chords: what the step itself gains

    @property
    def internal(self) -> float:
        """Elastic energy and what the material has dissipated [J]."""
        return self.elastic + self.compressive + self.fracture


@dataclass(frozen=True)
class ContactStatistics:
    """What contact has cost and how exact it was, since the start."""

    pairs_max: int
    steps: int  # with at least one pair
    sweeps: int
    unconverged_steps: int
    lists: int  # times that the list of candidates was made
    max_penetration_over_h: float  # h: shortest boundary edge

    @property
    def sweeps_mean(self) -> float:
        """Sweeps in a step with contact."""
        return self.sweeps / self.steps if self.steps else 0.0


@dataclass(frozen=True)
class Sizes:
    """What cracks have made of the mesh so far."""

    nodes: int
    elements: int  # also those that were cut
    opened_edges: int
    cracks: int  # failed nodes that have cracked
    fallbacks: int  # edges taken where a cut was planned
    closed: int  # failed nodes that had no way for a crack when they were looked at
    most_resets: int  # of one element
    contact_pairs: int  # of now


@dataclass(frozen=True)
class Sight:
    """What the guards look at, all relative; places are indices, -1 where there is none."""

    area: float  # smallest area of an element, over that in the reference
    speed: float  # largest of a node, over the P wave speed of its body
    step: float  # critical step of the smallest piece, over that of the mesh at the start
    overlap: float  # depth of a boundary node in an element, over the shortest boundary edge
    area_element: int
    speed_node: int
    step_element: int
    overlap_node: int
    overlap_element: int
    bad_node: int  # first one with a value that is not finite; nothing else is looked at then
    bad_element: int  # likewise


@dataclass(frozen=True)
class ElementState:
    """State of some elements, in the frame that rotates with the material.

    stress (n, 4) xx, yy, zz, xy [Pa]; strain (n, 4) with engineering shear; plastic_strain (n,);
    tensile_strength (n, 3) and fracturing_strain (n, 3) along axis 1, axis 2 and zz;
    axis_angle (n,) and crack_angle (n,) [rad].
    """

    stress: np.ndarray
    strain: np.ndarray
    plastic_strain: np.ndarray
    tensile_strength: np.ndarray
    fracturing_strain: np.ndarray
    axis_angle: np.ndarray
    crack_angle: np.ndarray


class Run:
    """One simulation in the core; owns its memory there.

    Raises
    ------
    lithofrac.errors.CoreError
        Where the core refuses the mesh, a material or a load, or a step fails.
    """

    def __init__(self, problem: Problem) -> None:
        self._handle = 0
        self.problem = problem
        self.n_loads = len(problem.velocity_loads) + len(problem.pressure_loads)
        self._handle = _new(*_arguments(problem))
        for load in problem.velocity_loads:
            _add_velocity(
                self._handle,
                load.nodes + 1,
                load.component + 1,
                load.speed,
                load.ramp.start,
                load.ramp.duration,
            )
        for load in problem.pressure_loads:
            _add_pressure(
                self._handle,
                (load.edges + 1).T,
                load.pressure,
                load.stiffness,
                load.ramp.start,
                load.ramp.duration,
            )
        if problem.contact is not None:
            self._add_contact(problem.contact, problem.mesh)
        if problem.fracture is not None:
            self._add_fracture(problem.fracture)

    def _add_contact(self, contact: Contact, mesh: Mesh) -> None:
        try:
            names, friction = contact.surfaces(mesh), contact.table(mesh)
        except ValueError as error:
            raise CoreError(str(error)) from None
        _add_contact(self._handle, friction, contact.tolerance)
        for tag in range(len(mesh.body_names), len(names)):
            _tag_surface(self._handle, (mesh.edge_sets[names[tag]] + 1).T, tag + 1)

    def _add_fracture(self, fracture: Fracture) -> None:
        _add_fracture(
            self._handle,
            MODES[fracture.mode],
            WEIGHTS[fracture.weights],
            -1 if fracture.release_steps is None else fracture.release_steps,
            RESETS[fracture.reset],
            fracture.interval,
            fracture.least_factor,
        )

    def __del__(self) -> None:
        if getattr(self, "_handle", 0):
            _drop(self._handle)
            self._handle = 0

    def refuse_overlap(self) -> None:
        """Raise where parts overlap, even those that no contact will keep apart."""
        _refuse_overlap(self._handle)

    def set_motion(self, displacement: np.ndarray, velocity: np.ndarray) -> None:
        """Start from displacement [m] and velocity [m/s], both (n, 2), at time 0."""
        _set_motion(self._handle, displacement.T, velocity.T)

    def advance(self, steps: int, threads: int = 1) -> None:
        """Take `steps` steps; other Python threads run meanwhile."""
        _advance(self._handle, steps, threads)

    @property
    def step(self) -> int:
        """Steps taken; the fields are at time `step * dt`."""
        return _clock(self._handle)[0]

    @property
    def dt(self) -> float:
        """Time step [s]."""
        return _clock(self._handle)[1]

    @property
    def critical_step(self) -> tuple[float, int]:
        """Smallest exact element limit [s] and the element that sets it."""
        _, _, critical, element = _clock(self._handle)
        return critical, element - 1

    def energy(self) -> Energy:
        """The ledger at the time of the fields."""
        return Energy(*map(float, _energy(self._handle)))

    def watch(self) -> Sight:
        """What the guards look at; takes the time of a small part of a step."""
        values, places = _watch(self._handle)
        return Sight(*values.tolist(), *(places - 1).tolist())

    def loads(self) -> np.ndarray:
        """Force [N] and displacement [m] of every load, (n, 2): velocities, then pressures.

        A velocity load has the sum of its reactions and the mean displacement of its component;
        a pressure load has pressure times area and the mean outward displacement.
        """
        return _loads(self._handle, self.n_loads).T if self.n_loads else np.zeros((0, 2))

    def elements(self, elements: np.ndarray) -> ElementState:
        """State of the elements of these indices."""
        return element_states(_elements(self._handle, np.asarray(elements) + 1).T)

    def nodes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Displacement (n, 2) [m], velocity (n, 2) [m/s] of the half step after, mass (n,) [kg]."""
        displacement, velocity, mass = _nodes(self._handle, self.sizes().nodes)
        return displacement.T, velocity.T, mass

    def contact_forces(self) -> np.ndarray:
        """Contact force on every node [N], (n, 2), at the time of the fields."""
        return _contact_forces(self._handle, self.sizes().nodes).T

    def sizes(self) -> Sizes:
        """Nodes, elements, cracks."""
        return Sizes(*map(int, _sizes(self._handle)))

    def mesh(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """The mesh of now: reference nodes (n, 2) [m], triangles (m, 3), body (m,), alive (m,).

        Copies of a node share its reference position; an element that was cut is not alive.
        """
        sizes = self.sizes()
        nodes, triangles, body, alive = _mesh(self._handle, sizes.nodes, sizes.elements)
        return nodes.T, triangles.T - 1, body - 1, alive.astype(bool)

    def parts(self) -> np.ndarray:
        """Lowest element that each element hangs together with, (m,); -1 if it was cut."""
        return _parts(self._handle, self.sizes().elements) - 1

    def failure(self) -> tuple[np.ndarray, np.ndarray]:
        """Failure factor (eq. 21) of every element and how often it was reset, both (m,)."""
        return _failure(self._handle, self.sizes().elements)

    def cracks(self) -> np.ndarray:
        """The record of opened edges, (k, 16); columns as in fortran/fracture/fracture.f90."""
        return _cracks(self._handle, self.sizes().opened_edges).T

    def check(self) -> None:
        """Raise `CoreError` in words where an invariant of the mesh is broken."""
        _check(self._handle)

    def contact_statistics(self) -> ContactStatistics:
        """Pairs, sweeps and penetration since the start."""
        counts, penetration = _contact_statistics(self._handle)
        return ContactStatistics(*map(int, counts), float(penetration))

    def save(self) -> np.ndarray:
        """The state to the bit, as one array of numbers."""
        return _save(self._handle, _checkpoint_size(self._handle))

    def restore(self, state: np.ndarray) -> None:
        """Go on from a state that `save` gave for the same problem."""
        _restore(self._handle, state)


def element_states(values: np.ndarray) -> ElementState:
    """Name the columns of the core's `element_state`, (n, 17)."""
    return ElementState(
        values[:, 0:4],
        values[:, 4:8],
        values[:, 8],
        values[:, 9:12],
        values[:, 12:15],
        values[:, 15],
        values[:, 16],
    )


def _arguments(problem: Problem) -> tuple:
    """Arguments of the core's `run_new`, materials packed into equal arrays."""
    mesh, materials = problem.mesh, problem.materials
    knots = np.array([m.table.shape[1] for m in materials])
    constants = np.zeros((6, len(materials)), order="F")
    tables = np.zeros((4, knots.max(), len(materials)), order="F")
    options = np.zeros((4, len(materials)), dtype=np.int32, order="F")
    for i, m in enumerate(materials):
        constants[:5, i] = m.young, m.poisson, m.density, m.tensile_strength, m.fracture_energy
        constants[5, i] = m.reference_width
        tables[:, : knots[i], i] = m.table
        options[:, i] = m.options
    kind, alpha = damping_arguments(problem.damping)
    return (
        mesh.nodes.T,
        mesh.triangles.T + 1,
        mesh.body + 1,
        int(problem.axisymmetric),
        constants,
        tables,
        knots,
        options,
        [BAND_FACTOR[m.band_width] for m in materials],
        problem.time_step_factor,
        kind,
        problem.damping.fraction,
        alpha,
    )


def damping_arguments(damping: Damping) -> tuple[int, float]:
    """Kind of damping and fixed alpha [1/s] as the core takes them; -1 asks for the quotient."""
    if damping.alpha is None:
        kind = damping.relative_to if damping.fraction > 0.0 else "none"
        return DAMPING[kind], -1.0
    return DAMPING[damping.relative_to if damping.alpha > 0.0 else "none"], damping.alpha
