"""Extremes of numbers: units scaled, coordinates far from the origin, a million steps."""

from dataclasses import dataclass, replace

import numpy as np

from lithofrac.core import Run
from lithofrac.guards import Watch
from lithofrac.problem import Contact, Fracture, Mesh, Problem, VelocityLoad
from lithofrac.stability.cell import (
    CONTACT,
    CONTINUUM,
    CRACKED,
    CRACKS,
    Cell,
    Limits,
    Refused,
    Stable,
    Trial,
)
from lithofrac.stability.models import (
    ELASTIC,
    FACTOR,
    MM,
    ROCK,
    WIDTH,
    block,
    cracked,
    cracking,
    in_pieces,
    pressed,
    stacked,
    timed,
)

FACTORS = (1e-9, 1e-6, 1e6, 1e9)
OFFSET = 1e6  # lengths of the block
EARLY = 1e-3  # strain
MILLION = 1_000_000


@dataclass(frozen=True)
class Scaled:
    """A material in other units: lengths, stresses and densities times factors.

    A material file has ranges in which rocks and metals lie; the core takes any numbers.
    """

    base: object
    length: float = 1.0
    stress: float = 1.0
    mass: float = 1.0  # of a volume

    def __getattr__(self, name: str):
        value = getattr(self.base, name)
        if name in ("young", "tensile_strength"):
            return value * self.stress
        if name == "density":
            return value * self.mass
        if name == "fracture_energy":
            return value * self.stress * self.length
        if name == "table":
            return value * np.array([[1.0], [self.stress], [1.0], [1.0]])
        return value * self.length if name == "reference_width" else value


def in_units(problem: Problem, length: float, stress: float, mass: float) -> Problem:
    """The same problem in other units; times follow."""
    time = length * (mass / stress) ** 0.5

    def slower(ramp):
        return replace(ramp, start=ramp.start * time, duration=ramp.duration * time)

    return replace(
        problem,
        mesh=replace(problem.mesh, nodes=problem.mesh.nodes * length),
        materials=tuple(Scaled(m, length, stress, mass) for m in problem.materials),
        velocity_loads=tuple(
            replace(load, speed=load.speed * length / time, ramp=slower(load.ramp))
            for load in problem.velocity_loads
        ),
        end_time=problem.end_time * time,
    )


def far_away(problem: Problem, x: float) -> Problem:
    """The same problem somewhere else."""
    return replace(problem, mesh=replace(problem.mesh, nodes=problem.mesh.nodes + [x, -x]))


def bases() -> dict[str, Problem]:
    """One problem for each mesh."""
    return {
        CONTINUUM: pressed(block(), ROCK),
        CONTACT: stacked(ELASTIC, ELASTIC),
        CRACKED: cracking(cracked(block()), ROCK),
    }


def units() -> list[Cell]:
    """Lengths, stresses or densities times 1e-9 to 1e9."""
    found = []
    for factor in FACTORS:
        for word, given in (
            ("lengths", (factor, 1.0, 1.0)),
            ("stresses", (1.0, factor, 1.0)),
            ("densities", (1.0, 1.0, factor)),
        ):
            for mesh in (CONTINUUM, CONTACT, CRACKED):
                limits = CRACKS if mesh == CRACKED else Limits()
                found.append(
                    Cell("units", f"{word} times {factor:g}", mesh,
                         Stable(lambda m=mesh, g=given: _in_units(m, g), limits))
                )  # fmt: skip
    return found


def _in_units(mesh: str, given: tuple[float, float, float]) -> Trial:
    base = bases()[mesh]
    return Trial(in_units(base, *given), watch=lambda run: _compared(run, base, given[0]))


def offsets() -> list[Cell]:
    """Coordinates 1e6 widths of the block from the origin."""
    found = []
    for mesh in (CONTINUUM, CONTACT, CRACKED):
        limits = CRACKS if mesh == CRACKED else Limits()
        found.append(
            Cell("offset", f"{OFFSET:g} widths", mesh, Stable(lambda m=mesh: _far(m), limits))
        )
    return found


def _far(mesh: str) -> Trial:
    """Before the peak: beyond it, what coordinates have lost of the mesh picks other cracks."""
    base = {
        CONTINUUM: lambda: pressed(block(), ROCK, strain=EARLY),
        CONTACT: lambda: stacked(ELASTIC, ELASTIC),
        CRACKED: lambda: cracking(cracked(block()), ROCK, strain=EARLY),
    }[mesh]()
    return Trial(far_away(base, OFFSET * WIDTH), watch=lambda run: _compared(run, base, 1.0))


def _compared(run: Run, base: Problem, length: float) -> str:
    """Where nodes have come, against the same problem in its own units and place."""
    there = Run(base)
    there.advance(run.step)
    moved, own = run.nodes()[0] / length, there.nodes()[0]
    if len(moved) != len(own):
        return f"{run.sizes().cracks} cracks, {there.sizes().cracks} in metres at the origin"
    return f"displacement differs by {abs(moved - own).max() / abs(own).max():.0e} of the largest"


def drift() -> list[Cell]:
    """A million steps: ringing without damping, a held crack, cracks of the run that ring."""
    words = "1e6 steps"
    later = "margin: see the other families; a search would take as many steps again and again"
    return [
        Cell("drift", f"{words}, ringing", CONTINUUM,
             Stable(_ringing, margin=False, why=later), slow=True),
        Cell("drift", f"{words}, held crack", CONTACT,
             Stable(_held, margin=False, why=later), slow=True),
        Cell("drift", f"{words}, new cracks", CRACKED,
             Stable(_torn, CRACKS, margin=False, why=later), slow=True),
        Cell("drift", f"{words}, new cracks, pressed", CRACKED,
             Refused(_pressed_until_stopped, r"guards\.contact_work_stop"), slow=True),
    ]  # fmt: skip


def _ringing() -> Trial:
    """A small elastic block in free vibration."""
    mesh = block(3.0 * MM, 4.0 * MM)
    problem = Problem(mesh, False, (ELASTIC,), (), (), 1.0, time_step_factor=FACTOR)
    problem = timed(problem, MILLION)
    middle = mesh.nodes.mean(axis=0)
    velocity = 1000.0 * (mesh.nodes - middle) @ np.array([[1.0, 0.3], [0.3, -0.7]])
    return Trial(problem, 0.0 * velocity, velocity)


def _held() -> Trial:
    """A block with a jagged crack under biaxial strain; the slip of its faces must not go on."""
    problem = _jagged(ELASTIC)
    start = problem.mesh.nodes * [-1e-4, -8e-4]
    return Trial(problem, start, 0.0 * start)


def _torn(xx: float = 6e-4, yy: float = 2e-4) -> Trial:
    """The same of brittle rock, strained so far that cracks open at once; nothing damps it."""
    problem = _jagged(ROCK.model_copy(update={"fracture_energy_J_m2": 1.0}), fracture=Fracture())
    start = problem.mesh.nodes * [xx, yy]
    return Trial(problem, start, 0.0 * start)


def _pressed_until_stopped() -> None:
    """The same, pressed along y: faces that ring at 0.9 of the step slide on and on.

    Contact gives what friction takes, in a million steps as much as was put in, and the ledger
    closes. Not so at 0.8 of the step, with damping, or without friction. The guard must see it.
    """
    trial = _torn(1e-3, -1e-3)
    run = Run(trial.problem)
    run.set_motion(trial.displacement, trial.velocity)
    watch = Watch(run, MILLION)
    while run.step < MILLION:
        run.advance(watch.steps_ahead())
        watch.look()


def _jagged(material, **more) -> Problem:
    """A million steps of a block with a jagged crack, held along its outline."""
    mesh = _crossed(block(4.0 * MM, 4.0 * MM))
    x, y = mesh.nodes.T
    wide = 4.0 * MM
    edge = (np.minimum(x, y) < 1e-6 * wide) | (np.maximum(x, y) > (1.0 - 1e-6) * wide)
    nodes = np.flatnonzero(edge).astype(np.int32)
    loads = (VelocityLoad("x", nodes, 0), VelocityLoad("y", nodes, 1))
    problem = Problem(
        mesh, False, (material,), loads, (), 1.0, time_step_factor=FACTOR,
        contact=Contact(default_friction=0.4), **more,
    )  # fmt: skip
    return timed(problem, MILLION)


def _crossed(mesh: Mesh) -> Mesh:
    """Cut along a jagged, inclined line, without edge sets."""
    x, y = (mesh.centroids() / (4.0 * MM) - 0.5).T
    return in_pieces(mesh, (y > 0.35 * x + 0.12 * np.sin(9.0 * x)).astype(int))
