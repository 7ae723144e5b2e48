"""What a new crack does to the rock at once: fading bonds, and the state of failed elements."""

import numpy as np
import pytest
from fracture_models import brittle, weakened
from models import hold, one_triangle, problem, rectangle

from lithofrac.config import Material
from lithofrac.core import Run
from lithofrac.problem import Contact, Damping, Fracture, Ramp

pytestmark = pytest.mark.verification
SIZE = 9e-3  # m
SPEED = 0.3  # m/s
ROCK = Material.load("sandstone")


def sheared_block(**fracture):
    """A row of sandstone in an elastic block that is pressed and sheared: it dilates and fails."""
    mesh = weakened(rectangle(9, 9, SIZE, SIZE, jitter=0.2, seed=2))
    ramp = Ramp(0.0, 2e-5)
    top, bottom = mesh.nodes_of("top"), mesh.nodes_of("bottom")
    return Run(
        problem(
            mesh,
            materials=(ROCK.model_copy(update={"elastic": True}), ROCK),
            velocity_loads=(
                hold("bottom x", bottom, 0),
                hold("bottom y", bottom, 1),
                hold("top x", top, 0, SPEED, ramp=ramp),
                hold("top y", top, 1, -0.1 * SPEED, ramp=ramp),
            ),
            contact=Contact(default_friction=0.6),
            fracture=Fracture(**fracture),
            damping=Damping(0.3),
        )
    )


@pytest.fixture(scope="module")
def first_crack():
    """Step of the first crack; it does not depend on what is done about the crack."""
    run = sheared_block()
    while run.sizes().cracks == 0:
        assert run.step < 40_000
        run.advance(10)
    return int(run.cracks()[0, 0])


def after_crack(first_crack, **fracture):
    """Largest gain of kinetic energy, work of the bonds, and the largest residual, over the
    elastic energy."""
    run = sheared_block(**fracture)
    run.advance(first_crack)
    before = run.energy()
    gain = residual = 0.0
    for _ in range(500):
        run.advance(1)
        energy = run.energy()
        gain = max(gain, energy.kinetic - before.kinetic)
        residual = max(residual, abs(energy.residual))
    assert run.sizes().cracks >= 1
    return gain / before.elastic, energy.insertion / before.elastic, residual


def test_a_bond_that_fades_keeps_a_crack_under_pressure_from_jumping(first_crack):
    """Dropped at once, the traction is a blow; over longer times the bonds take its energy."""
    at_once, usual, long = (
        after_crack(first_crack, release_steps=steps) for steps in (0, None, 400)
    )
    for result in (at_once, usual, long):
        print("kinetic {:.2e}, insertion {:.2e}, residual {:.1e}".format(*result))
        assert result[2] < 1e-6
    assert at_once[1] == 0.0
    assert usual[1] < 0.0
    assert long[1] < 0.0
    assert usual[0] < 0.6 * at_once[0]
    assert long[0] < 0.1 * at_once[0]


@pytest.mark.parametrize("reset", ["normal", "paper"])
def test_reset_changes_failed_elements_at_the_crack_alone(first_crack, reset):
    """`normal` counts anew across the crack; `paper` heals strength, cohesion and friction."""
    bare, run = sheared_block(interval=10**9), sheared_block(reset=reset)
    for each in (bare, run):
        each.advance(first_crack)
    assert bare.sizes().cracks == 0
    everything = np.arange(len(run.problem.mesh.triangles))
    before, after = bare.elements(everything), run.elements(everything)
    failed, touched = bare.failure()[0] >= 1.0, run.failure()[1] > 0
    node = np.isclose(run.mesh()[0], run.cracks()[0, 2:4], atol=1e-12).all(axis=1)
    at_node = np.isin(run.mesh()[1], np.flatnonzero(node)).any(axis=1)
    np.testing.assert_array_equal(touched, failed & at_node)
    assert touched.any()
    for name, values in vars(after).items():
        same = getattr(before, name)
        np.testing.assert_array_equal(values[~touched], same[~touched], err_msg=name)
    np.testing.assert_array_equal(after.stress, before.stress)
    np.testing.assert_array_equal(after.strain, before.strain)
    if reset == "normal":
        np.testing.assert_array_equal(after.tensile_strength, before.tensile_strength)
        np.testing.assert_array_equal(after.plastic_strain, before.plastic_strain)
        changed = (after.fracturing_strain != before.fracturing_strain)[touched]
        assert (changed.sum(axis=1) == 1).all()
        assert not after.fracturing_strain[touched][changed].any()
        # the plane that is left out has its normal within 45 degrees of the crack's
        angle = after.axis_angle[touched] + np.pi / 2 * np.argmax(changed, axis=1)
        across = angle - run.cracks()[0, 7]
        assert (abs(np.sin(across)) >= np.sqrt(0.5) - 1e-12).all()
    else:
        assert (after.tensile_strength[touched] == ROCK.tensile_strength).all()
        assert not after.fracturing_strain[touched].any()
        assert not after.plastic_strain[touched].any()


@pytest.mark.parametrize("weights", ["volume", "failure_factor"])
@pytest.mark.parametrize("reset", ["normal", "paper"])
def test_the_energy_that_elements_regain_is_booked_outside_the_balance(reset, weights):
    """Only `paper` gives any back; what was dissipated stays so, and the ledger closes."""
    run, residual, fracture = sheared_block(reset=reset, weights=weights), 0.0, 0.0
    while run.sizes().cracks < 10:
        assert run.step < 40_000
        run.advance(20)
        energy = run.energy()
        residual = max(residual, abs(energy.residual))
        assert energy.fracture >= fracture - 1e-6 * energy.internal  # trapezoids
        fracture = energy.fracture
    print(f"{run.sizes().cracks} cracks, regained {energy.reset:.2e} J, residual {residual:.1e}")
    assert residual < 1e-6
    assert (energy.reset > 0.0) == (reset == "paper")


@pytest.mark.parametrize("reset", ["normal", "paper"])
def test_an_element_on_its_own_begins_anew_when_it_has_failed_twice_over(reset):
    """It has no edge left to open: without strength it would be drawn out without end."""
    mesh, width = one_triangle(SIZE), SIZE
    rock = brittle(fracture_energy=60.0)
    critical = 2.0 * rock.fracture_energy / (width * rock.tensile_strength)  # strain, eq. 15
    run = Run(
        problem(
            mesh,
            rock,
            velocity_loads=(
                hold("base", np.array([0, 1], np.int32), 1),
                hold("corner", np.array([0], np.int32), 0),
                hold("top", np.array([2], np.int32), 1, SPEED, ramp=Ramp(0.0, 2e-5)),
            ),
            contact=Contact(),
            fracture=Fracture(reset=reset),
            damping=Damping(0.3),
        )
    )
    strains, strengths = [], []
    while not strains or strains[-1] < 4.5 * critical:
        run.advance(5)
        element = run.elements([0])
        strains.append(element.strain[0, 1])
        strengths.append(element.tensile_strength[0, :2].min())
    strains, strengths = np.array(strains) / critical, np.array(strengths)
    assert np.all(strengths[(strains > 1.1) & (strains < 1.95)] == 0.0)
    renewed = np.flatnonzero(np.diff(strengths) > 0.0)
    assert strains[renewed] == pytest.approx(2.0 * np.arange(1, len(renewed) + 1), rel=0.1)
    assert len(renewed) >= 2
    # all that was spent twice over is free to be spent again
    assert run.energy().reset == pytest.approx(
        len(renewed) * rock.fracture_energy * mesh.areas()[0] / width, rel=0.01
    )
    assert abs(run.energy().residual) < 1e-6
