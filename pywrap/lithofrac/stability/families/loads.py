"""Extremes of the load: confinement, friction of contact, loading rate, impact, strain steps."""

from dataclasses import replace

import numpy as np

from lithofrac import kernels, point
from lithofrac.core import Run
from lithofrac.problem import Contact, PressureLoad, Problem, Ramp, VelocityLoad
from lithofrac.scenes._rectangle import rectangle
from lithofrac.stability.cell import (
    CONTACT,
    CONTINUUM,
    CRACKED,
    CRACKS,
    LARGE,
    Cell,
    Left,
    Limits,
    Refused,
    Sound,
    Stable,
    Trial,
)
from lithofrac.stability.models import (
    ELASTIC,
    FACTOR,
    MESH,
    MM,
    ROCK,
    STEPS,
    block,
    cracked,
    cracking,
    in_pieces,
    joined,
    pressed,
    shifted,
    stacked,
    stacked_mesh,
    timed,
)

PRESSURES = (0.1, 1.0, 10.0)  # GPa
FRICTIONS = (0.0, 0.3, 10.0)
SPEEDS = (0.01, 0.1, 1.0, 10.0, 60.0)  # m/s
GUARD = 0.05  # relative velocity that contact takes, shortest edges a step
POINTS = 20_000


def confinement() -> list[Cell]:
    """Pressure all round, far beyond any strength, and an axial strain on top."""
    found = []
    for pressure in PRESSURES:
        words = f"{pressure:g} GPa"
        found += [
            Cell("confinement", words, CONTINUUM, Stable(lambda p=pressure: _confined(block(), p))),
            Cell(
                "confinement", words, CONTACT, Stable(lambda p=pressure: _confined_pair(p), LARGE)
            ),
            Cell(
                "confinement",
                words,
                CRACKED,
                Stable(lambda p=pressure: _confined(cracked(block()), p, True), CRACKS),
            ),
        ]
    return found


def _confined(mesh, pressure: float, cracks: bool = False) -> Trial:
    """Sides under pressure, shortened from the top as much as the pressure shortens them, and a
    little more."""
    build = cracking if cracks else pressed
    return Trial(_squeezed(build(mesh, ROCK, strain=0.012 + _shortening(pressure)), pressure))


def _confined_pair(pressure: float) -> Trial:
    """Two blocks of equal width, one upon the other, with meshes that do not match."""
    low = rectangle(8.0 * MM, 4.0 * MM, 1.0 * MM, True, MESH)
    high = shifted(rectangle(8.0 * MM, 4.0 * MM, 1.6 * MM, True, MESH), 0.0, 4.0 * MM)
    mesh = joined(low=low, high=high)
    sets = mesh.edge_sets | {"bottom": mesh.edge_sets["low.bottom"]}
    sets |= {"top": mesh.edge_sets["high.top"]}
    for side in ("left", "right"):
        sets[side] = np.concatenate([sets[f"low.{side}"], sets[f"high.{side}"]])
    contact = Contact(default_friction=0.3)
    problem = pressed(
        replace(mesh, edge_sets=sets),
        ROCK,
        ROCK,
        strain=0.012 + _shortening(pressure),
        contact=contact,
    )
    return Trial(_squeezed(problem, pressure))


def _shortening(pressure: float) -> float:
    """Strain of a square under equal pressure [GPa] on all sides, in plane strain."""
    nu = ROCK.poisson_ratio
    return pressure * (1.0 + nu) * (1.0 - 2.0 * nu) / ROCK.young_modulus_GPa


def _squeezed(problem: Problem, pressure: float) -> Problem:
    ramp = Ramp(0.0, 0.5 * problem.end_time)
    sides = tuple(
        PressureLoad(side, problem.mesh.edge_sets[side], pressure * 1e9, ramp=ramp)
        for side in ("left", "right")
    )
    return replace(problem, pressure_loads=sides)


def friction() -> list[Cell]:
    """Friction coefficients from none to one that nothing overcomes."""
    found = [Cell("contact friction", "0 to 10", CONTINUUM, Left("a continuum has no contact"))]
    for value in FRICTIONS:
        words = f"mu {value:g}"
        found += [
            Cell(
                "contact friction",
                words,
                CONTACT,
                Stable(lambda mu=value: Trial(stacked(ELASTIC, ELASTIC, mu))),
            ),
            Cell(
                "contact friction",
                words,
                CRACKED,
                Stable(
                    lambda mu=value: Trial(cracking(cracked(block()), ROCK, friction=mu)), CRACKS
                ),
            ),
        ]
    return found


def rates() -> list[Cell]:
    """Speed of the top; the fast ones for a tenth of the height, the slow ones for the time."""
    found = []
    for speed in SPEEDS:
        words = f"{speed:g} m/s"
        makes = {
            CONTINUUM: lambda v=speed: pressed(block(), ROCK, speed=v, steps=_steps(v)),
            CONTACT: lambda v=speed: stacked(ROCK, ROCK, speed=v, steps=_steps(v)),
            CRACKED: lambda v=speed: cracking(cracked(block()), ROCK, speed=v, steps=_steps(v)),
        }
        for mesh, make in makes.items():
            limits = CRACKS if mesh == CRACKED else LARGE
            found.append(
                Cell("loading rate", words, mesh, Stable(lambda f=make: Trial(f()), limits))
            )
    return found


def _steps(speed: float) -> int:
    """Steps of 1e-7 s in which the top comes a twentieth of 12 mm at most."""
    return int(min(STEPS, 0.05 * 12.0 * MM / speed / 1e-7))


def impact() -> list[Cell]:
    """A block that hits another at 60 m/s, just below the speed that contact takes, above it."""
    family, slow = "impact", "60 m/s"
    low, high = "0.9 of the speed guard", "1.1 of the speed guard"
    words = "too fast for the step"
    crushed = "it has turned inside out"  # rock does not survive 400 m/s
    return [
        Cell(family, slow, CONTINUUM, Stable(lambda: _jolt(60.0))),
        Cell(family, slow, CONTACT, Stable(lambda: _hit(60.0, cracks=False), CRACKS)),
        Cell(family, slow, CRACKED, Stable(lambda: _hit(60.0, cracks=True), CRACKS)),
        Cell(family, low, CONTINUUM, Stable(lambda: _jolt(None))),
        Cell(family, low, CONTACT, Stable(lambda: _hit(None, cracks=False), CRACKS)),
        Cell(family, low, CRACKED, Refused(lambda: _advanced(_hit(None, True)), crushed)),
        Cell(family, high, CONTINUUM, Left("the guard is that of contact")),
        Cell(family, high, CONTACT, Refused(lambda: _advanced(_hit(None, False, 1.1)), words)),
        Cell(family, high, CRACKED, Refused(lambda: _advanced(_hit(None, True, 1.1)), words)),
    ]


def _jolt(speed: float | None) -> Trial:
    """The upper half of a bonded block runs into the lower half at that speed, or 0.9 of the
    guard."""
    mesh = block()
    problem = timed(
        Problem(mesh, False, (ELASTIC,), (), (), 1.0, time_step_factor=FACTOR), STEPS // 2
    )
    velocity = np.zeros_like(mesh.nodes)
    upper = mesh.nodes[:, 1] > 0.5 * mesh.nodes[:, 1].max()
    velocity[upper, 1] = -(speed or _guard(problem, 0.9))
    return Trial(problem, 0.0 * velocity, velocity)


def _guard(problem: Problem, share: float) -> float:
    """A share of the relative speed that contact takes [m/s]."""
    return share * GUARD * kernels.boundary_of(problem.mesh)[1] / Run(problem).dt


def _hit(speed: float | None, cracks: bool, share: float = 0.9) -> Trial:
    """A block falls upon a plate that nothing holds, or upon a cracked block of rock, at that
    speed or at a share of the guard."""
    mesh = stacked_mesh()
    upper = mesh.body == 0
    material = ELASTIC
    contact = {"contact": Contact(default_friction=0.3)}
    if cracks:
        problem = cracking(cracked(block()), ROCK)
        material, contact = ROCK, {"contact": problem.contact, "fracture": problem.fracture}
        lower = problem.mesh
        top = shifted(rectangle(5.0 * MM, 3.0 * MM, MM, True, MESH), 1.0 * MM, 12.0 * MM)
        mesh = joined(block=top, plate=lower)
        upper = mesh.body == 0
    nodes = mesh.nodes.copy()
    falling = np.unique(mesh.triangles[upper])
    nodes[falling, 1] += 0.2 * MM
    mesh = replace(mesh, nodes=nodes)
    problem = Problem(mesh, False, (material,) * 2, (), (), 1.0, time_step_factor=FACTOR, **contact)
    problem = timed(problem, STEPS // 2)
    velocity = np.zeros_like(nodes)
    velocity[falling, 1] = -(speed or _guard(problem, share))
    return Trial(problem, 0.0 * velocity, velocity)


def _advanced(trial: Trial) -> None:
    run = Run(trial.problem)
    run.set_motion(trial.displacement, trial.velocity)
    run.advance(STEPS)


def strain_steps() -> list[Cell]:
    """Strain steps of 1: the material point, an element led by its nodes, and what refuses."""
    family = "strain step"
    refusal = "it has turned inside out"
    return [
        Cell(family, "1, material point", CONTINUUM, Sound(_leap)),
        Cell(family, "1, stretch", CONTINUUM, Stable(lambda: _led(1.0), Limits(speed=np.inf),
             margin=False, why="every node is led: there is nothing to grow")),
        Cell(family, "1, squeeze", CONTINUUM, Refused(lambda: _led_to_end(-1.0), refusal)),
        Cell(family, "1", CONTACT, Refused(lambda: _rushed(cracks=False), "too fast for the step")),
        Cell(family, "1", CRACKED, Refused(lambda: _rushed(cracks=True), "too fast for the step")),
    ]  # fmt: skip


def _leap() -> str:
    """Points anywhere inside and outside strength take strain increments of size 1."""
    random = np.random.default_rng(1)
    state = point.State.virgin(ROCK, POINTS)
    worst = 0.0
    for _ in range(3):
        strain = random.standard_normal((POINTS, 4))
        strain /= np.sqrt((strain**2).sum(axis=1))[:, None]
        state, info = point.step(ROCK, strain, state)
        assert not info.code.any(), f"{np.count_nonzero(info.code)} points without a return"
        assert np.isfinite(state.stress).all(), "a stress is not finite"
        worst = max(worst, float(excess(state).max()))
    scale = kernels.rock_scales(ROCK).strength_scale
    # an elastic trial stress of 28 GPa: rounding of that, not of the strength, decides
    allowed = 1e-12 * ROCK.young
    assert worst <= allowed, f"{worst:.1e} Pa beyond the strength, expected {allowed:.1e}"
    return f"{3 * POINTS} steps of points, at most {worst / scale:.1e} of the strength beyond it"


def excess(state: point.State) -> np.ndarray:
    """How far points of `ROCK` stand beyond their strength [Pa], (n,)."""
    xx, yy, zz, xy = state.stress.T
    mean, radius = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    principal = np.sort(np.column_stack([mean + radius, mean - radius, zz]), axis=1)
    sin_phi, c_cos_phi = kernels.strength_eval(ROCK, state.plastic_strain)
    low, high = principal[:, 0], principal[:, 2]
    return 0.5 * (high - low) + 0.5 * (high + low) * sin_phi - c_cos_phi


def _led(strain: float) -> Trial:
    """One triangle whose nodes are all led; its height changes by `strain` of it in a step."""
    mesh = rectangle(MM, MM, MM, True, 1)
    problem = Problem(mesh, False, (ROCK,), (), (), 1.0, time_step_factor=FACTOR)
    dt = Run(problem).dt
    low, high = mesh.nodes_of("bottom"), mesh.nodes_of("top")
    loads = (
        VelocityLoad("low y", low, 1),
        VelocityLoad("high y", high, 1, strain * MM / dt),
        VelocityLoad("low x", low, 0),
        VelocityLoad("high x", high, 0),
    )
    return Trial(replace(problem, velocity_loads=loads, end_time=10.0 * dt))


def _led_to_end(strain: float) -> None:
    run = Run(_led(strain).problem)
    run.advance(10)


def _rushed(cracks: bool) -> None:
    """A top that comes down by a whole element in a step."""
    mesh = cracked(block()) if cracks else in_pieces(block(), np.arange(len(block().triangles)))
    problem = cracking(mesh, ROCK) if cracks else pressed(mesh, ROCK, contact=Contact())
    dt = Run(problem).dt
    loads = tuple(
        replace(load, speed=-MM / dt, ramp=Ramp()) if load.name == "top" else load
        for load in problem.velocity_loads
    )
    Run(replace(problem, velocity_loads=loads)).advance(20)
