"""The stability limit: what runs do as their time step grows beyond the limit of an element.

Four elastic meshes, struck once and left alone. What a mesh stores beyond the energy of the blow
is bounded below its limit, by 1/(1 - f^2) for a mode at the share f of it, and has no bound above.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lithofrac.problem import Contact, Mesh, Problem
from lithofrac.stability.cell import CONTACT, CONTINUUM, CRACKED, Trial
from lithofrac.stability.judge import RUNAWAY, run_trial
from lithofrac.stability.models import (
    ELASTIC,
    FACTOR,
    FRICTION,
    MM,
    STEPS,
    block,
    in_pieces,
    joined,
    shifted,
    timed,
)

FACTORS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.925, 0.95, 0.96, 0.97, 0.98, 0.99)
FACTORS += (
    1.0,
    1.005,
    1.01,
    1.02,
    1.03,
    1.04,
    1.05,
    1.075,
    1.1,
    1.125,
    1.15,
    1.2,
    1.25,
    1.3,
    1.4,
    1.45,
)
FACTORS += (1.475, 1.5, 1.525, 1.55, 1.6, 1.65)
BLOW = 1.0  # velocity gradient of the blow, m/s over the size of the mesh
STRAIN = -1e-3  # that presses parts together
ONE = "one element"


def _struck(mesh: Mesh, n_bodies: int = 1, contact: Contact | None = None, noise=0.0) -> Trial:
    """A mesh whose nodes move off, in a steady gradient and at random; nothing holds it."""
    problem = Problem(
        mesh, False, (ELASTIC,) * n_bodies, (), (), 1.0, time_step_factor=FACTOR, contact=contact
    )
    arm = (mesh.nodes - mesh.nodes.mean(axis=0)) / np.ptp(mesh.nodes)
    velocity = BLOW * arm @ np.array([[0.7, 0.3], [0.4, -1.0]])
    velocity += noise * np.random.default_rng(1).uniform(-1, 1, velocity.shape)
    start = STRAIN * mesh.nodes if contact else 0.0 * mesh.nodes
    return Trial(timed(problem, STEPS), start, velocity)


def one_element() -> Trial:
    """A free triangle."""
    nodes = MM * np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.8]])
    mesh = Mesh(nodes, np.array([[0, 1, 2]], np.int32), np.zeros(1, np.int32), ("rock",))
    return _struck(mesh, noise=0.5)


def continuum() -> Trial:
    """The block of the matrix."""
    return _struck(block(), noise=0.1)


def contact() -> Trial:
    """Two halves of the block, meshes that match, pressed on each other by their own strain."""
    low, high = block(8.0 * MM, 6.0 * MM), block(8.0 * MM, 6.0 * MM)
    mesh = joined(low=low, high=shifted(high, 0.0, 6.0 * MM))
    return _struck(mesh, 2, Contact(default_friction=FRICTION), noise=0.1)


def cracked() -> Trial:
    """The block with every edge cut."""
    mesh = block(6.0 * MM, 6.0 * MM)
    mesh = in_pieces(mesh, np.arange(len(mesh.triangles)))
    return _struck(mesh, contact=Contact(default_friction=FRICTION), noise=0.1)


MESHES: dict[str, Callable[[], Trial]] = {
    ONE: one_element,
    CONTINUUM: continuum,
    CONTACT: contact,
    CRACKED: cracked,
}


def point_of(mesh: str, factor: float) -> dict:
    """A row of the curve: largest internal energy over the energy of the blow, at most 1e30."""
    seen = run_trial(MESHES[mesh](), factor)
    return {
        "mesh": mesh,
        "time_step_factor": factor,
        "internal_over_put_in": seen.gain if seen.gain < np.inf else None,
        "energy_residual": seen.residual,
        "broke": seen.broke or seen.gain > RUNAWAY,
        "note": seen.ended,
    }
