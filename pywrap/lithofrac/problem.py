"""What a run is made of, in SI units: mesh, boundary sets, loads, probes.

A scene turns a checked case into a `Problem`; `lithofrac.run` steps it in the Fortran core.
Nothing here knows of config keys.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from lithofrac.errors import FileError
from lithofrac.mesh_flaws import flaw
from lithofrac.npz import arrays_of

EXPECTED = "a mesh of `lithofrac mesh`"
NEVER = 1e30  # a failure factor that no node reaches


@dataclass(frozen=True)
class Mesh:
    """Triangles with named bodies and boundary sets.

    Attributes
    ----------
    nodes : (n, 2) float, positions [m]; in axisymmetry column 0 is the radius
    triangles : (m, 3) int32, 0-based, counter-clockwise
    body : (m,) int32, index into `body_names`
    body_names : names of the bodies
    edge_sets : name -> (k, 2) int32 boundary edges, material on their left
    """

    nodes: np.ndarray
    triangles: np.ndarray
    body: np.ndarray
    body_names: tuple[str, ...]
    edge_sets: dict[str, np.ndarray] = field(default_factory=dict)

    def nodes_of(self, name: str) -> np.ndarray:
        """Sorted node indices of an edge set, (k,) int32."""
        return np.unique(self.edge_sets[name]).astype(np.int32)

    def centroids(self) -> np.ndarray:
        """Element centroids [m], (m, 2)."""
        return self.nodes[self.triangles].mean(axis=1)

    def areas(self) -> np.ndarray:
        """Element areas [m2], (m,)."""
        a, b, c = (self.nodes[self.triangles[:, i]] for i in range(3))
        ab, ac = b - a, c - a
        return 0.5 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])

    def save(self, path: Path) -> None:
        """Write to an .npz without pickled objects."""
        sets = {f"edges:{name}": edges for name, edges in self.edge_sets.items()}
        with open(path, "wb") as file:  # a handle, so that no suffix is added
            np.savez(
                file,
                nodes=self.nodes,
                triangles=self.triangles,
                body=self.body,
                body_names=np.array(self.body_names),
                **sets,
            )

    @classmethod
    def load(cls, path: Path) -> Mesh:
        """Read what `save` wrote; no code in the file is run.

        Raises
        ------
        FileError
            Where the file is no mesh, or its mesh has a flaw.
        """
        arrays = arrays_of(path, EXPECTED)
        missing = {"nodes", "triangles", "body", "body_names"} - set(arrays)
        if missing:
            raise FileError(f"{path}: expected {EXPECTED} (it lacks {sorted(missing)[0]})")
        sets = {
            key.removeprefix("edges:"): array
            for key, array in arrays.items()
            if key.startswith("edges:")
        }
        names = tuple(str(name) for name in arrays["body_names"].ravel())
        given = (arrays["nodes"], arrays["triangles"], arrays["body"], names, sets)
        found = flaw(*given)
        if found:
            raise FileError(f"{path}: {found}")
        return cls(
            nodes=given[0].astype(float),
            triangles=given[1].astype(np.int32),
            body=given[2].astype(np.int32),
            body_names=names,
            edge_sets={name: edges.astype(np.int32) for name, edges in sets.items()},
        )


@dataclass(frozen=True)
class Ramp:
    """Smooth rise from 0 to 1: 6 s^5 - 15 s^4 + 10 s^3 with s = (t - start) / duration [s]."""

    start: float = 0.0
    duration: float = 0.0


@dataclass(frozen=True)
class VelocityLoad:
    """Prescribed velocity of one component of a set of nodes (speed 0: a roller or symmetry)."""

    name: str
    nodes: np.ndarray
    component: int
    speed: float = 0.0  # [m/s]
    ramp: Ramp = Ramp()


@dataclass(frozen=True)
class PressureLoad:
    """Follower pressure on edges, with an optional spring.

    pressure [Pa] = ramp(t) * pressure + stiffness * outward displacement of the edge midpoint;
    `stiffness` [Pa/m] is a distributed (Winkler) spring that stands for a stiff confinement.
    """

    name: str
    edges: np.ndarray
    pressure: float = 0.0
    stiffness: float = 0.0
    ramp: Ramp = Ramp()


@dataclass(frozen=True)
class Damping:
    """Mass-proportional damping, alpha = 2 * fraction * omega (eqs 1-3).

    fraction : fraction of critical of the lowest frequency (the paper's 0.3); 0 is none
    alpha : fixed alpha [1/s] instead of a Rayleigh quotient at run time, or None
    relative_to : "affine" damps each body relative to the affine fit of its own velocity,
        "ground" is eq. 3 to the letter
    """

    fraction: float = 0.0
    alpha: float | None = None
    relative_to: str = "affine"


@dataclass(frozen=True)
class Contact:
    """Non-penetration with Coulomb friction on the whole boundary, self contact included.

    friction : (surface, surface) -> coefficient, in either order; a surface is a body or an edge
        set of the mesh, and an edge set that is named here is a surface of its own
    default_friction : where the table says nothing
    tolerance : of the contact solver and of the penetration that is left alone, over the usual
        one; 1e-3 makes energies independent of node numbers to 1e-6, at twice the run time
    """

    friction: dict[tuple[str, str], float] = field(default_factory=dict)
    default_friction: float = 0.0
    tolerance: float = 1.0

    def surfaces(self, mesh: Mesh) -> list[str]:
        """Names of the surfaces: all bodies, then the edge sets that the table names.

        Raises
        ------
        ValueError
            Where the table names neither a body nor an edge set, or says two things of a pair.
        """
        names = list(mesh.body_names)
        for name in dict.fromkeys(name for pair in self.friction for name in pair):
            if name not in mesh.body_names and name not in mesh.edge_sets:
                raise ValueError(f"contact: {name!r} is neither a body nor an edge set of the mesh")
            if name not in names:
                names.append(name)
        return names

    def table(self, mesh: Mesh) -> np.ndarray:
        """Friction by surface, (n, n), symmetric; order of `surfaces`."""
        names = self.surfaces(mesh)
        table = np.full((len(names), len(names)), self.default_friction)
        for (a, b), friction in self.friction.items():
            if friction != self.friction.get((b, a), friction):
                raise ValueError(f"contact: the friction of {a!r} and {b!r} is given twice")
            i, j = names.index(a), names.index(b)
            table[i, j] = table[j, i] = friction
        return table


@dataclass(frozen=True)
class Fracture:
    """Discrete cracks in the bodies that yield (Klerck 2004, section 2.5); needs contact.

    mode : "inter_element", cracks follow edges of the mesh and the time step stays as it is, or
        "intra_element", they cut elements where that leaves good ones
    weights : of the non-local averages of eq. 22, "volume" or "failure_factor"
    release_steps : steps over which the traction on a new crack fades; None: twice the way of a
        shear wave along it, at least 20; 0: at once, as in the paper
    reset : "normal", failed elements count their failure anew across the crack and regain
        nothing unless they stand alone, or "paper", all their state variables
    interval : steps between two failure maps; at 5 a crack may still run as fast as surface waves
    least_factor : F_p of eq. 22 from which a node cracks, not below 1; with `NEVER` none does
    """

    mode: str = "inter_element"
    weights: str = "volume"
    release_steps: int | None = None
    reset: str = "normal"
    interval: int = 5
    least_factor: float = 1.0


@dataclass(frozen=True)
class Guards:
    """When a run is worth a warning, and when it is stopped; all are relative.

    energy_residual : of the ledger, over the largest energy so far
    contact_work : energy that contact pressure has given, over the largest energy so far
    element_area : smallest one, over that in the reference
    overlap : depth of a boundary node in an element, over the shortest boundary edge
    time_step : critical step of the smallest piece of an element, over that of the mesh
    unconverged : steps in which contact did not converge, over all steps of the run
    speed : of the fastest node, over the P wave speed of its body
    """

    energy_residual_warning: float = 1e-4
    energy_residual_stop: float = 1e-2
    contact_work_warning: float = 1e-3
    contact_work_stop: float = 0.1
    element_area_warning: float = 0.1
    element_area_stop: float = 0.0
    overlap_warning: float = 0.01
    overlap_stop: float = 0.05
    time_step_warning: float = 0.39
    time_step_stop: float = 0.36
    unconverged_warning: float = 0.05
    unconverged_stop: float = 0.5
    speed_warning: float = 0.1
    speed_stop: float = 0.2


@dataclass(frozen=True)
class Measures:
    """How axial stress and strain of a specimen follow from the boundary records.

    Axial stress is the force of `axial_load` over `area`; axial strain the relative
    displacement of its nodes over `length`. Both compression positive.
    """

    axial_load: str
    area: float  # [m2], per metre of depth in plane strain, per radian in axisymmetry
    length: float  # [m] over which the shortening of `axial_load` alone acts
    lateral_load: str | None = None  # PressureLoad whose displacement gives the lateral strain
    lateral_length: float = 1.0  # [m]
    start_time: float = 0.0  # axial loading starts, after the confinement [s]


@dataclass(frozen=True)
class Problem:
    """All that a run needs; `materials[i]` belongs to body i of the mesh."""

    mesh: Mesh
    axisymmetric: bool
    materials: tuple  # of lithofrac.config.material.Material
    velocity_loads: tuple[VelocityLoad, ...]
    pressure_loads: tuple[PressureLoad, ...]
    end_time: float  # [s]
    damping: Damping = Damping()
    contact: Contact | None = None  # None: parts pass through each other
    fracture: Fracture | None = None  # None: the continuum alone
    time_step_factor: float = 0.9  # of the exact element limit
    probes: dict[str, int] = field(default_factory=dict)  # name -> element index
    measures: Measures | None = None
    records: int = 1000  # rows of the history
    fields: int = 5  # VTU frames, 0 for none
    guards: Guards = Guards()
    checkpoint_seconds: float = 20.0  # of wall time between two checkpoints; no bit depends on it
