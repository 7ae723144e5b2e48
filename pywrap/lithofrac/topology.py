"""Meshes that crack: the core's topology, crack insertion and failure map on arrays.

For tests and for trying things out: a run inserts its cracks inside the core. Indices count from
0 and -1 means none; arrays have one row a node or an element. Edge k of an element runs from its
corner k to the next one, counter-clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from lithofrac import _core
from lithofrac.errors import checked

_face = _core.kernels_mesh
_new = checked(_face.mesh_new)
_load = checked(_face.mesh_load)
_drop = checked(_face.mesh_drop)
_sizes = checked(_face.mesh_sizes)
_arrays = checked(_face.mesh_arrays)
_edits = checked(_face.mesh_edits)
_fan = checked(_face.mesh_fan)
_boundary = checked(_face.mesh_boundary)
_check = checked(_face.mesh_check)
_follow = checked(_face.mesh_follow)
_field = checked(_face.mesh_field)
_split = checked(_face.mesh_split)
_cut = checked(_face.mesh_cut)
_open = checked(_face.mesh_open)
_undo = checked(_face.mesh_undo)
_crack = checked(_face.mesh_crack)
_average = checked(_face.mesh_average)
_plan = checked(_face.mesh_plan)
_triangle_shapes = checked(_face.triangle_shapes)
_failure_factors = checked(_face.failure_factors)

MODES = {"inter": 1, "intra": 2}  # fortran/fracture/arms.f90
WEIGHTS = {"volume": 0, "failure_factor": 1}  # fortran/fracture/failure_map.f90


@dataclass(frozen=True)
class Guard:
    """What an element cut in two must be (fortran/mesh/cut.f90)."""

    snap: float = 0.25
    least_step: float = 0.4
    least_area: float = 0.05
    least_angle: float = np.pi / 18
    poisson: tuple[float, ...] = (0.2,)  # of each body

    @property
    def numbers(self) -> tuple[float, float, float, float]:
        """The four limits in the order of the core."""
        return self.snap, self.least_step, self.least_area, self.least_angle


class State(NamedTuple):
    """All arrays of a topology; rows of elements that have been cut stay, with `alive` false."""

    nodes: np.ndarray  # (n, 2) [m]
    element_at: np.ndarray  # (n,)
    triangles: np.ndarray  # (m, 3)
    neighbours: np.ndarray  # (m, 3)
    body: np.ndarray  # (m,)
    origin: np.ndarray  # (m,) element of the first mesh
    alive: np.ndarray  # (m,) bool
    body_of_node: np.ndarray  # (n,)


class Edits(NamedTuple):
    """What the last change did."""

    node_parent: np.ndarray  # (new nodes, 2)
    share: np.ndarray  # (new nodes,) weight of the second parent
    element_parent: np.ndarray  # (new elements,)
    retired: np.ndarray
    changed: np.ndarray
    opened: np.ndarray  # (k, 4) element, edge; element, edge


class Cut(NamedTuple):
    """Outcome of a cut; `node` is -1 if a guard forbade it."""

    node: int
    middle: tuple[int, int]  # element and edge from the far corner to the node
    verdict: str


class Crack(NamedTuple):
    """A planned crack; an arm is (element, edge, s), s is None along the edge."""

    node: int
    factor: float
    arms: list[tuple[int, int, float | None]]


class Plan(NamedTuple):
    """Cracks to insert, and how many failed nodes were put off or have no way for one."""

    cracks: list[Crack]
    waiting: int
    closed: int


class Topology:
    """A mesh with its neighbours, in the core.

    Raises
    ------
    lithofrac.errors.CoreError
        Where an edge has two elements on one side, a node joins parts that share no edge, or a
        number does not exist.
    """

    def __init__(self, nodes, triangles, body=None) -> None:
        self._handle = 0
        body = np.zeros(len(triangles), dtype=np.int32) if body is None else np.asarray(body)
        self._handle = _new(np.asarray(nodes, dtype=float).T, np.asarray(triangles).T + 1, body + 1)

    @classmethod
    def load(cls, state: State) -> Topology:
        """Take the arrays as they are, good or not; all elements in one body."""
        topology = cls.__new__(cls)
        topology._handle = 0
        topology._handle = _load(
            np.asarray(state.nodes, dtype=float).T,
            np.asarray(state.triangles).T + 1,
            np.asarray(state.neighbours).T + 1,
            np.asarray(state.origin) + 1,
            np.asarray(state.alive).astype(np.int32),
            np.asarray(state.element_at) + 1,
        )
        return topology

    def __del__(self) -> None:
        if getattr(self, "_handle", 0):
            _drop(self._handle)
            self._handle = 0

    @property
    def n_nodes(self) -> int:
        """Nodes, with all copies."""
        return int(_sizes(self._handle)[0])

    @property
    def n_elements(self) -> int:
        """Elements, with those that have been cut."""
        return int(_sizes(self._handle)[1])

    @property
    def changes(self) -> int:
        """Counts every change, also those taken back."""
        return int(_sizes(self._handle)[2])

    def state(self) -> State:
        """A copy of all arrays."""
        sizes = _sizes(self._handle)
        nodes, element_at, triangles, neighbours, body, origin, alive, body_of_node = _arrays(
            self._handle, sizes[0], sizes[1]
        )
        return State(
            nodes.T,
            element_at - 1,
            triangles.T - 1,
            neighbours.T - 1,
            body - 1,
            origin - 1,
            alive.astype(bool),
            body_of_node - 1,
        )

    def edits(self) -> Edits:
        """What the last change did."""
        node_parent, share, element_parent, retired, changed, opened = _edits(
            self._handle, *_sizes(self._handle)[3:]
        )
        return Edits(
            node_parent.T - 1, share, element_parent - 1, retired - 1, changed - 1, opened.T - 1
        )

    def fan(self, node: int, capacity: int = 64) -> tuple[np.ndarray, np.ndarray, bool]:
        """Elements (n,) around a node, nodes (n + 1,) at the ends of its spokes, closed or not."""
        n, closed, elements, rim = _fan(self._handle, node + 1, capacity)
        return elements[:n] - 1, rim[: n + 1] - 1, bool(closed)

    def boundary(self) -> tuple[np.ndarray, np.ndarray]:
        """Boundary nodes before and after each node, material on the left; -1 in the inside."""
        before, after = _boundary(self._handle, self.n_nodes)
        return before - 1, after - 1

    def check(self) -> None:
        """Raise `CoreError` in words where an invariant is broken."""
        _check(self._handle)

    def follow(self, field) -> None:
        """Let a nodal field (n, 2) follow all changes."""
        _follow(self._handle, np.asarray(field, dtype=float).T)

    def field(self) -> np.ndarray:
        """The nodal field that follows, (n, 2)."""
        return _field(self._handle, self.n_nodes).T

    def split(self, edges) -> None:
        """Cut edges (k, 2), each element and edge, and split the nodes at their ends."""
        edges = np.asarray(edges, dtype=np.int32).reshape(-1, 2)
        _split(self._handle, edges.T + 1)

    def cut(self, element: int, edge: int, s: float, guard: Guard) -> Cut:
        """Put a node at s on an edge and cut the elements on both sides."""
        node, middle, _, words = _cut(
            self._handle, element + 1, edge + 1, s, guard.numbers, guard.poisson
        )
        return Cut(node - 1, (middle[0] - 1, middle[1] - 1), words.decode().strip())

    def open(self, arms, guard=None) -> str:
        """Open the arms of one crack, as a plan gives them: "sound", or why nothing was done."""
        guard = guard or Guard()
        rows = [(e + 1, k + 1, -1.0 if s is None else s) for e, k, s in arms]
        _, words = _open(self._handle, np.array(rows, dtype=float).T, guard.numbers, guard.poisson)
        return words.decode().strip()

    def undo(self) -> None:
        """Take the last change back."""
        _undo(self._handle)

    def crack(self, nodes, along, mode="inter", guard=None):
        """Crack nodes (k,) along unit vectors (k, 2), one after the other.

        Returns
        -------
        number of arms (k,), of those through an element (k,), and 0 or why nothing was done (k,)
        """
        guard = guard or Guard()
        return _crack(
            self._handle,
            np.atleast_1d(nodes) + 1,
            np.atleast_2d(along).T,
            MODES[mode],
            guard.numbers,
            guard.poisson,
        )

    def average(self, factor, normal, weights="volume"):
        """Failure map: F_p (n,), unit vectors of the cracks (n, 2), agreement of directions (n,).

        `normal` (m, 2) are softening directions as (cos 2a, sin 2a).
        """
        mean, along, agreement = _average(
            self._handle, factor, np.asarray(normal, dtype=float).T, WEIGHTS[weights], self.n_nodes
        )
        return mean, along.T, agreement

    def plan(self, factor, normal, mode="inter", weights="volume", most=50, guard=None) -> Plan:
        """Cracks that are due, most failed node first; see `average` for the arguments."""
        guard = guard or Guard()
        n, node, mean, arms, waiting, closed = _plan(
            self._handle,
            factor,
            np.asarray(normal, dtype=float).T,
            MODES[mode],
            WEIGHTS[weights],
            most,
            guard.numbers,
            guard.poisson,
        )
        cracks = [
            Crack(
                int(node[i]) - 1,
                float(mean[i]),
                [
                    (int(arm[0]) - 1, int(arm[1]) - 1, float(arm[2]) if arm[2] >= 0 else None)
                    for arm in arms[:, :, i].T
                    if arm[0] > 0
                ],
            )
            for i in range(n)
        ]
        return Plan(cracks, int(waiting), int(closed))


def triangle_shapes(corners, poisson):
    """Critical step times P wave speed [m], smallest angle [rad], mean squared edge [m2], (n,).

    `corners` is (n, 3, 2) [m], `poisson` one number or (n,).
    """
    corners = np.asarray(corners, dtype=float)
    return _triangle_shapes(
        corners.transpose(2, 1, 0), np.broadcast_to(np.asarray(poisson, dtype=float), len(corners))
    )


def failure_factors(opening, softening, strength):
    """F_k of tension planes (eq. 21): fracturing strain, H [Pa], virgin strength [Pa], (n,)."""
    return _failure_factors(opening, softening, strength)
