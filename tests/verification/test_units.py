"""Units and origin are choices of the reader: nothing in the core may have one of its own."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from contact_models import join, moved
from fracture_models import brittle, pulled_bar, turned_bar, weakened
from models import hold, problem, rectangle

from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.problem import Contact, Damping, Fracture, PressureLoad, Ramp

pytestmark = pytest.mark.verification


@dataclass(frozen=True)
class Units:
    """How many of the new units are one metre, one second and one kilogram."""

    length: float = 1.0
    time: float = 1.0
    mass: float = 1.0

    @property
    def stress(self):
        return self.mass / (self.length * self.time**2)

    @property
    def speed(self):
        return self.length / self.time


@dataclass(frozen=True)
class Rock:
    """A material in other units; as the core takes it."""

    source: object
    units: Units

    def __getattr__(self, name):
        return getattr(self.source, name)

    @property
    def young(self):
        return self.source.young * self.units.stress

    @property
    def density(self):
        return self.source.density * self.units.mass / self.units.length**3

    @property
    def tensile_strength(self):
        return self.source.tensile_strength * self.units.stress

    @property
    def fracture_energy(self):
        return self.source.fracture_energy * self.units.stress * self.units.length

    @property
    def reference_width(self):
        return self.source.reference_width * self.units.length

    @property
    def table(self):
        return self.source.table * np.array([[1.0], [self.units.stress], [1.0], [1.0]])


def in_units(given, units):
    """The same problem in other units."""

    def ramp(old):
        return Ramp(old.start * units.time, old.duration * units.time)

    return replace(
        given,
        mesh=replace(given.mesh, nodes=given.mesh.nodes * units.length),
        materials=tuple(Rock(material, units) for material in given.materials),
        velocity_loads=tuple(
            replace(load, speed=load.speed * units.speed, ramp=ramp(load.ramp))
            for load in given.velocity_loads
        ),
        pressure_loads=tuple(
            replace(
                load,
                pressure=load.pressure * units.stress,
                stiffness=load.stiffness * units.stress / units.length,
                ramp=ramp(load.ramp),
            )
            for load in given.pressure_loads
        ),
        end_time=given.end_time * units.time,
    )


def specimen():
    """A specimen that yields and softens, under a pressure with a spring."""
    mesh = rectangle(8, 16, 0.01, 0.02, jitter=0.3)
    side = PressureLoad("side", mesh.edge_sets["right"], 2e6, 1e11, Ramp(0.0, 5e-6))
    loads = (
        hold("axis", mesh.nodes_of("left"), 0),
        hold("bottom", mesh.nodes_of("bottom"), 1),
        hold("top", mesh.nodes_of("top"), 1, -20.0, ramp=Ramp(0.0, 5e-6)),
    )
    return problem(
        mesh, Material.load("sandstone"), velocity_loads=loads, pressure_loads=(side,),
        damping=Damping(fraction=0.3),
    )  # fmt: skip


def dragged_block():
    """A yielding block that hits a driven plate of another mesh and slides on it."""
    rock = Material.load("sandstone")
    block = moved(rectangle(5, 5, 0.01, 0.01, jitter=0.2), (0.003, 0.00301))
    mesh = join(block=block, plate=rectangle(11, 2, 0.02, 0.003))
    bottom = mesh.nodes_of("plate.bottom")
    press = PressureLoad("p", mesh.edge_sets["block.top"], 2e7)
    return problem(
        mesh, materials=(rock, rock), contact=Contact(default_friction=0.4),
        velocity_loads=(hold("x", bottom, 0, 3.0, ramp=Ramp(0.0, 1e-6)), hold("y", bottom, 1)),
        pressure_loads=(press,), damping=Damping(fraction=0.1),
    )  # fmt: skip


def parting_bar():
    """A bar that is pulled until it cracks."""
    mesh = weakened(turned_bar(0.8e-3, 0.3, 6e-3, 9e-3, jitter=0.25))
    return pulled_bar(mesh, brittle(fracture_energy=1.0), 0.1, 1e-2, fracture=Fracture())


def results(given, steps):
    """Displacement, velocity, stress, strain and strengths after some steps, and the cracks."""
    run = Run(given)
    run.advance(steps)
    displacement, velocity, _ = run.nodes()
    state = run.elements(np.arange(run.sizes().elements))
    assert run.elements(np.arange(1)).stress.any()
    return {
        "length": displacement,
        "speed": velocity,
        "stress": np.hstack([state.stress, state.tensile_strength]),
        "one": np.hstack([state.strain, state.fracturing_strain]),
    }, run


def differences(given, units, steps):
    """Largest difference of each kind of result over its largest value, and both runs."""
    here, run = results(given, steps)
    there, other = results(in_units(given, units), steps)
    scale = {"length": units.length, "speed": units.speed, "stress": units.stress, "one": 1.0}
    return {
        kind: abs(there[kind] / scale[kind] - values).max() / abs(values).max()
        for kind, values in here.items()
    }, (run, other)


POWERS = [(12, -20, 16), (30, 0, 0), (-30, 0, 0), (0, 30, 0), (0, -30, 0), (0, 0, 40), (0, 0, -40)]


@pytest.mark.parametrize(
    ("scene", "steps"), [(specimen, 600), (dragged_block, 600), (parting_bar, 5000)]
)
def test_units_that_are_powers_of_two_change_no_bit(scene, steps, n_random):
    """Scaling is then exact, so any constant of its own that a kernel had would show."""
    for powers in POWERS[: n_random(len(POWERS), least=1)]:
        units = Units(*(2.0**power for power in powers))
        found, (run, other) = differences(scene(), units, steps)
        assert set(found.values()) == {0.0}, powers
        assert run.sizes() == other.sizes()
    if scene is parting_bar:
        assert run.sizes().cracks >= 3
    elif scene is dragged_block:
        assert run.contact_statistics() == other.contact_statistics()
        assert run.energy().friction < 0.0
    else:
        assert run.elements(np.arange(256)).plastic_strain.max() > 1e-3


@pytest.mark.parametrize(
    "units",
    [
        Units(1e3, 1.0, 1e-3),  # mm, t, s
        Units(1e9, 1.0, 1.0),
        Units(1e-9, 1.0, 1.0),
        Units(1.0, 1e9, 1.0),
        Units(1.0, 1e-9, 1.0),
        Units(1.0, 1.0, 4e-14),  # Young's modulus near 1e-3
        Units(1.0, 1.0, 4e4),  # near 1e15
    ],
)
def test_other_units_give_the_same_results(units):
    found, _ = differences(specimen(), units, 600)
    print(found)
    assert max(found.values()) < 1e-9


def test_a_specimen_a_million_lengths_from_the_origin_is_the_same():
    """Positions lose six digits there, results no more: moments are not taken about the origin."""
    near = specimen()
    far = replace(near, mesh=replace(near.mesh, nodes=near.mesh.nodes + [2e4, 2e4]))
    here, there = (results(given, 600)[0] for given in (near, far))
    found = {kind: abs(there[kind] - here[kind]).max() / abs(here[kind]).max() for kind in here}
    print(found)
    assert max(found.values()) < 1e-6
