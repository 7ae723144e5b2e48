"""Models that crack within a few hundred steps, again and again: state is reset as in the paper."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from models import hold, problem, rectangle

from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.problem import Contact, Damping, Fracture, PressureLoad, Problem

SIZE = 0.1  # [m]


@dataclass(frozen=True)
class Cracking:
    """A problem and the motion at time 0."""

    problem: Problem
    velocity: np.ndarray

    def start(self) -> Run:
        """A new run, at time 0."""
        run = Run(self.problem)
        run.set_motion(np.zeros_like(self.velocity), self.velocity)
        return run

    def with_fracture(self, **changes) -> "Cracking":
        fracture = replace(self.problem.fracture, **changes)
        return replace(self, problem=replace(self.problem, fracture=fracture))


def burst(mesh):
    """No load: it flies apart, unevenly."""
    uneven = 1.0 + np.random.default_rng(1).random((len(mesh.nodes), 1))
    return {}, 40.0 * (mesh.nodes - 0.5 * SIZE) * uneven


def blow(mesh):
    """As `burst`, with a little follower pressure from below."""
    _, velocity = burst(mesh)
    return {"pressure_loads": (PressureLoad("bottom", mesh.edge_sets["bottom"], 1.0),)}, velocity


def pull(mesh):
    """Two sides are driven apart, the others are free."""
    loads = (hold("l", mesh.nodes_of("left"), 0, -1.5), hold("r", mesh.nodes_of("right"), 0, 1.5))
    return {"velocity_loads": loads}, np.zeros_like(mesh.nodes)


def squeeze(mesh):
    """Two sides are driven together; follower pressure and a spring act on the others."""
    loads = (hold("b", mesh.nodes_of("bottom"), 1), hold("t", mesh.nodes_of("top"), 1, -5.0))
    sides = tuple(
        PressureLoad(name, mesh.edge_sets[name], pressure, stiffness)
        for name, pressure, stiffness in (("left", 1e6, 0.0), ("right", 0.5e6, 1e11))
    )
    return {"velocity_loads": loads, "pressure_loads": sides}, np.zeros_like(mesh.nodes)


LOADS = {  # and squares a side
    "burst": (burst, 6),
    "blow": (blow, 6),
    "pull": (pull, 4),
    "squeeze": (squeeze, 6),
}


@pytest.fixture(scope="session")
def cracking():
    """cracking(load, mode, damping=none) -> Cracking, a square of rock."""

    def made(load, mode, damping=None):
        load, n = LOADS[load]
        mesh = rectangle(n, n, SIZE, SIZE, jitter=0.2)
        rock = Material.load("sandstone").model_copy(update={"fracture_energy_J_m2": 50.0})
        loads, velocity = load(mesh)
        friction = {("left", "left"): 0.7, ("top", "rock"): 0.2}
        given = problem(
            mesh,
            rock,
            damping=damping or Damping(),
            contact=Contact(friction, 0.4),
            fracture=Fracture(mode=mode, reset="paper"),
            **loads,
        )
        return Cracking(given, velocity)

    return made
