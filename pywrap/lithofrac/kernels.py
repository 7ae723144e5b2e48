"""Single kernels of the core on batches of points: arrays in, arrays out, errors raised.

Arrays have one row per point; (n, 4) tensors are xx, yy, zz, xy; stress is in pascal, tension
positive, and shear strain is engineering. A `rock` is anything with the SI attributes of
`lithofrac.config.material.Material`: `young, poisson, density, tensile_strength,
fracture_energy, table, options`, or a `PackedRock`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lithofrac import _core
from lithofrac.errors import checked
from lithofrac.problem import Mesh

_face = _core.kernels_material
_principal_axes = checked(_face.principal_axes)
_rotate_axes = checked(_face.rotate_axes)
_rock_scales = checked(_face.rock_scales)
_strength_eval = checked(_face.strength_eval)
_planes_soften = checked(_face.planes_soften)
_axes_follow = checked(_face.axes_follow)
_crack_turn = checked(_face.crack_turn)
_return_principal = checked(_face.return_principal)
_point_step = checked(_face.point_step)

table_eval = checked(_face.table_eval)
"""(values, slopes) of the table (x, y) at the points `at`."""

element_path = checked(_core.kernels_mechanics.element_path)
"""(states, forces, dissipated, critical step) of a triangle led through displacements."""

bare_elastic = checked(_core.kernels_mechanics.bare_elastic)
"""Positions after bare elastic steps of a free body: the yardstick of the benchmark."""

pair_impulse = checked(_core.kernels_contact.pair_impulse)
"""Impulse (2,) of a contact pair: (velocity, normals (2, n), biases (n,), friction, compliance)."""

corner_kind = checked(_core.kernels_contact.corner_kind)
"""(kind, faces, neighbours) of two wedges at one place, from unit tangents (2, 4): into and out
of each."""

_boundary_of = checked(_core.kernels_contact.boundary_of)
_candidates_of = checked(_core.kernels_contact.candidates_of)
_islands_of = checked(_core.kernels_contact.islands_of)

CORNER_KINDS = ("none", "any", "both", "flat")
"""Meaning of the kind that `corner_kind` gives."""


def boundary_of(mesh: Mesh) -> tuple[np.ndarray, float]:
    """Next node along the boundary for every node, -1 off it, and the shortest edge [m]."""
    following, shortest = _boundary_of(mesh.nodes.T, mesh.triangles.T + 1)
    return following - 1, shortest


def contact_candidates(mesh: Mesh, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (node, node) and pairs (node, start of edge) that the search keeps, (k, 2) each."""
    arrays = mesh.nodes.T, displacement.T, mesh.triangles.T + 1
    counts, _ = _candidates_of(*arrays, 1)
    _, pairs = _candidates_of(*arrays, max(1, sum(counts)))
    pairs = pairs.T - 1
    return pairs[: counts[0]], pairs[counts[0] : sum(counts)]


def contact_islands(mesh: Mesh, n_groups: int) -> tuple[np.ndarray, np.ndarray]:
    """Lowest node of the island of every boundary node, and its group; -1 off the boundary."""
    island, group = _islands_of(mesh.nodes.T, mesh.triangles.T + 1, n_groups)
    return island - 1, group - 1


ACTIVE_PLANES = (
    "T1", "T2", "T3", "M12", "M13", "M21", "M23", "M31", "M32", "apex", "mixture", "cut",
)  # fmt: skip
"""Meaning of the bits of `active`: T tension plane, M Mohr-Coulomb plane (larger, smaller)."""


@dataclass(frozen=True)
class Scales:
    """Derived constants of a rock: moduli, scale and tolerance [Pa], virgin strength, limit."""

    bulk: float
    shear: float
    lame: float
    strength_scale: float
    yield_tolerance: float
    sin_phi: float
    c_cos_phi: float
    band_width_limit: float  # [m]


@dataclass(frozen=True)
class PackedRock:
    """The numbers of a rock as the core takes them; saves time when used again and again."""

    constants: np.ndarray  # (6,) E, nu, density, ft, Gf, reference width in SI
    table: np.ndarray  # (4, k) Fortran order: strain, cohesion [Pa], friction, dilation [rad]
    options: np.ndarray  # (4,) int32: total, explicit, compression, yields


def pack(rock) -> PackedRock:
    """The numbers of a rock, or a `PackedRock` as it is."""
    if isinstance(rock, PackedRock):
        return rock
    constants = np.array(
        [
            rock.young,
            rock.poisson,
            rock.density,
            rock.tensile_strength,
            rock.fracture_energy,
            rock.reference_width,
        ],
        dtype=float,
    )
    table = np.asfortranarray(rock.table, dtype=float)
    return PackedRock(constants, table, np.asarray(rock.options, dtype=np.int32))


def constants_of(rock) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(constants, table, options) of a rock; see `PackedRock`."""
    packed = pack(rock)
    return packed.constants, packed.table, packed.options


def rock_scales(rock) -> Scales:
    """Derived constants of a rock; raises `CoreError` on numbers that make no sense."""
    return Scales(*_rock_scales(*constants_of(rock)))


def principal_axes(tensors, equality=0.0, fallback=(1.0, 0.0)):
    """(centre (n,), radius (n,), axis (n, 2) as cos and sin of 2 theta, tensors put together)."""
    centre, radius, axis, again = _principal_axes(
        np.asarray(tensors, dtype=float).T, equality, fallback
    )
    return centre, radius, axis.T, again.T


def rotate_axes(tensors, axes):
    """Normal components (n, 3) along the axes, at 90 degrees to them, and along z."""
    return _rotate_axes(np.asarray(tensors, dtype=float).T, np.asarray(axes, dtype=float).T).T


def strength_eval(rock, plastic_strain):
    """(sin phi, c cos phi [Pa]) at effective plastic strains (n,)."""
    return _strength_eval(*constants_of(rock), np.atleast_1d(plastic_strain))


def planes_soften(rock, areas, strengths, increments, scale=2**0.5):
    """(band widths [m], softening moduli [Pa], strengths left [Pa]) of triangles, each (n,)."""
    return _planes_soften(*constants_of(rock), areas, scale, strengths, increments)


def axes_follow(stresses, axes):
    """Strength axes (n, 2) after they have followed the stresses (n, 4)."""
    return _axes_follow(np.asarray(stresses, dtype=float).T, np.asarray(axes, dtype=float).T).T


def crack_turn(damage, axes):
    """Running sum of eq. 13 (n, 2) over n steps of damage (n, 2) along axes (n, 2)."""
    return _crack_turn(np.asarray(damage, dtype=float).T, np.asarray(axes, dtype=float).T).T


def return_principal(rock, softening, trials, strengths, plastic_strain):
    """Return principal trial stresses (n, 3) to the yield surface.

    Parameters
    ----------
    softening : (n,) H, not positive [Pa]
    trials, strengths : (n, 3) [Pa], any order
    plastic_strain : (n,)

    Returns
    -------
    plastic_strain (n,), inelastic strain (n, 3), its Mohr-Coulomb part (n, 3), active (n,),
    code (n,)
    """
    ep_eff, dep, dep_compressive, active, codes = _return_principal(
        *constants_of(rock),
        softening,
        np.asarray(trials, dtype=float).T,
        np.asarray(strengths, dtype=float).T,
        plastic_strain,
    )
    return ep_eff, dep.T, dep_compressive.T, active, codes


def point_step(rock, softening, strain, stress, ep_eff, ft, opening, axis, crack):
    """Strain a batch of points by one increment each.

    Parameters
    ----------
    softening : (n,) H, not positive [Pa]
    strain : (n, 4) increments
    stress (n, 4), ep_eff (n,), ft (n, 3), opening (n, 3), axis (n, 2), crack (n, 2) : the state

    Returns
    -------
    The six arrays of the state after the step, inelastic strain increments (n, 4), their
    Mohr-Coulomb part (n, 4), active (n,), code (n,).
    """
    state = [np.asarray(part, dtype=float).T for part in (stress, ep_eff, ft, opening, axis, crack)]
    results = _point_step(*constants_of(rock), softening, np.asarray(strain, dtype=float).T, *state)
    return tuple(result.T for result in results)
