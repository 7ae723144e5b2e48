"""One insertion against the same run without it (fortran/run/insert_cracks.f90, fracture/).

With an interval of `step`, cracks come at that step for the first time; a twin whose interval is
never reached has the same bits until then.
"""

import numpy as np
import pytest

STEP = {"burst": 40, "pull": 30, "squeeze": 150}
LOADS = pytest.mark.parametrize("load", STEP)
MODES = pytest.mark.parametrize("mode", ["inter_element", "intra_element"])
NEVER = 2**30


def twins(model, step, **fracture):
    """The run that has cracked at `step`, and the one that has not."""
    runs = [model.with_fracture(interval=i, **fracture).start() for i in (step, NEVER)]
    for run in runs:
        run.advance(step)
    assert runs[0].sizes().cracks > 0
    assert runs[1].sizes().cracks == 0
    return runs


def origin(cracked, whole):
    """Node of the whole mesh at the place of each node, -1 for nodes on cut edges."""
    places = {tuple(place): i for i, place in enumerate(whole.mesh()[0])}
    return np.array([places.get(tuple(place), -1) for place in cracked.mesh()[0]])


def internal_force(run):
    """Force of the stress on the nodes [N], (n, 2), for small rotations."""
    nodes, triangles, _, alive = run.mesh()
    xx, yy, _, xy = run.elements(np.flatnonzero(alive)).stress.T
    stress = np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-1)
    force = np.zeros_like(nodes)
    for k in range(3):
        first, second = (nodes[triangles[alive, (k + i) % 3]] for i in (1, 2))
        gradient = np.column_stack([first[:, 1] - second[:, 1], second[:, 0] - first[:, 0]])
        part = 0.5 * np.einsum("eij,ej->ei", stress, gradient)
        np.add.at(force, triangles[alive, k], part)
    return force


def kinetic(run):
    _, velocity, mass = run.nodes()
    return 0.5 * (mass * (velocity**2).sum(axis=1)).sum()


@LOADS
@MODES
def test_copies_move_as_their_node(cracking, load, mode):
    cracked, whole = twins(cracking(load, mode), STEP[load])
    at = origin(cracked, whole)
    for one, other in zip(cracked.nodes()[:2], whole.nodes()[:2], strict=True):
        np.testing.assert_array_equal(one[at >= 0], other[at[at >= 0]])
    mass = np.bincount(at[at >= 0], weights=cracked.nodes()[2][at >= 0])
    if mode == "inter_element":
        np.testing.assert_allclose(mass, whole.nodes()[2], rtol=1e-13)


@LOADS
@MODES
def test_the_event_keeps_momentum_and_energy(cracking, load, mode):
    cracked, whole = twins(cracking(load, mode), STEP[load])
    one, other = cracked.energy(), whole.energy()
    momenta = [run.nodes()[2] @ run.nodes()[1] for run in (cracked, whole)]
    scale = abs(whole.nodes()[2] @ abs(whole.nodes()[1])).max()
    np.testing.assert_allclose(momenta[0], momenta[1], atol=1e-14 * scale)
    for name in ("elastic", "compressive", "fracture", "contact", "friction", "insertion"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-12, abs=1e-12)
    assert kinetic(cracked) == pytest.approx(kinetic(whole) + one.relump, rel=1e-13)
    assert one.relump <= 0.0
    assert one.residual == pytest.approx(other.residual, abs=1e-12)


@MODES
def test_bonds_cancel_and_keep_accelerations_equal(cracking, mode):
    """Bonds are what the next step does with a long release and not without one: m dv / dt.

    Where contact pushes as well, only the sum can be told.
    """
    model, step = cracking("pull", mode), STEP["pull"]
    held, whole = twins(model, step, release_steps=10**5)
    free, _ = twins(model, step, release_steps=0)
    at, mass, force = origin(held, whole), held.nodes()[2], internal_force(held)
    for run in (held, free):
        run.advance(1)
    bond = mass[:, None] * (held.nodes()[1] - free.nodes()[1]) / held.dt
    copied = np.flatnonzero(np.bincount(at[at >= 0]) > 1)
    checked = 0
    assert len(copied) > 3
    assert not bond[(at >= 0) & ~np.isin(at, copied)].any()
    driven = np.concatenate([load.nodes for load in model.problem.velocity_loads])
    for node in copied:
        copies = np.flatnonzero(at == node)
        assert abs(bond[copies].sum(axis=0)).max() < 1e-9 * abs(bond).max()
        if any(run.contact_forces()[copies].any() for run in (held, free)):
            continue
        checked += 1
        acceleration = (bond - force)[copies] / mass[copies, None]
        free_axes = [1] if node in driven else [0, 1]
        scale = abs(force[copies] / mass[copies, None]).max()
        assert np.ptp(acceleration, axis=0)[free_axes].max() < 3e-3 * scale
    assert checked > 1


@LOADS
def test_let_go_at_once_the_faces_part(cracking, load):
    """The paper's way: without bonds the copies of a node go different ways in the next step."""
    cracked, whole = twins(cracking(load, "inter_element"), STEP[load], release_steps=0)
    at = origin(cracked, whole)
    cracked.advance(1)
    copies = np.flatnonzero(np.bincount(at) > 1)
    velocity = cracked.nodes()[1]
    gaps = [np.ptp(velocity[at == node], axis=0).max() for node in copies]
    assert max(gaps) > 1e-3
    assert cracked.energy().insertion == 0.0


@MODES
def test_bonds_fade_smoothly_and_end(cracking, mode):
    """They work only while they last, and the start of the fall has no jump."""
    release, step = 20, STEP["pull"]
    cracked, _ = twins(cracking("pull", mode), step, release_steps=release)
    work = [0.0]
    while cracked.step < step + release + 5:
        cracked.advance(1)
        work.append(cracked.energy().insertion)
    power = np.diff(work)
    assert np.all(power[release:] == 0.0)
    assert abs(power[0]) < 0.05 * abs(power).max()
    assert abs(power[release - 1]) < 0.05 * abs(power).max()
    assert abs(work[-1]) > 0.0


@pytest.mark.parametrize("reset", ["normal", "paper"])
@LOADS
def test_failed_elements_are_reset(cracking, load, reset):
    cracked, whole = twins(cracking(load, "inter_element"), STEP[load], reset=reset)
    everything = np.arange(whole.sizes().elements)
    (factor, times), before = cracked.failure(), whole.failure()[0]
    new, old = cracked.elements(everything), whole.elements(everything)
    failed, strength = times > 0, 4e6
    assert failed.any()
    assert np.all(before[failed] >= 1.0)
    assert times.max() == 1
    np.testing.assert_array_equal(new.stress, old.stress)
    for name in ("tensile_strength", "fracturing_strain", "plastic_strain"):
        same = getattr(new, name)[~failed]
        np.testing.assert_array_equal(same, getattr(old, name)[~failed], err_msg=name)
    if reset == "paper":
        assert np.all(new.tensile_strength[failed] == strength)
        assert np.all(new.fracturing_strain[failed] == 0.0)
        assert np.all(new.plastic_strain[failed] == 0.0)
        assert np.all(factor[failed] == 0.0)
        return
    np.testing.assert_array_equal(new.plastic_strain, old.plastic_strain)
    np.testing.assert_array_equal(new.tensile_strength, old.tensile_strength)
    kept = new.fracturing_strain == old.fracturing_strain
    assert np.all(kept[failed, 2])
    assert np.all(new.fracturing_strain[~kept] == 0.0)
    assert np.all((~kept[failed]).sum(axis=1) <= 1)
    assert not kept[failed].all()


@pytest.mark.parametrize("reset", ["normal", "paper"])
def test_the_energy_to_spend_again_is_that_of_the_strength_regained(cracking, reset):
    """Half of (ft^2 - ft_i^2) / |H| a volume in every plane, H of eq. 16."""
    model = cracking("pull", "inter_element")
    cracked, whole = twins(model, STEP["pull"], reset=reset)
    mesh, rock = model.problem.mesh, model.problem.materials[0]
    everything = np.arange(len(mesh.triangles))
    gained = cracked.elements(everything).tensile_strength ** 2
    gained -= whole.elements(everything).tensile_strength ** 2
    softening = rock.band_width_of(mesh.areas()) * rock.tensile_strength**2
    softening /= 2.0 * rock.fracture_energy
    energy = (0.5 * gained.sum(axis=1) / softening * mesh.areas()).sum()
    assert cracked.energy().reset == pytest.approx(energy, rel=1e-9)


def test_the_failure_factor_is_that_of_equation_21(cracking):
    """Largest fracturing strain in the plane over ft / |H|, no more than 10."""
    model = cracking("pull", "inter_element").with_fracture(interval=NEVER)
    run = model.start()
    run.advance(100)
    mesh, rock = model.problem.mesh, model.problem.materials[0]
    opening = run.elements(np.arange(len(mesh.triangles))).fracturing_strain[:, :2].max(axis=1)
    softening = rock.band_width_of(mesh.areas()) * rock.tensile_strength**2
    softening /= 2.0 * rock.fracture_energy
    expected = np.minimum(10.0, opening * softening / rock.tensile_strength)
    assert expected.max() > 1.0
    np.testing.assert_allclose(run.failure()[0], expected, rtol=1e-12)


def test_nodes_on_cut_edges_are_driven_with_their_side(cracking):
    run = cracking("squeeze", "intra_element").start()
    run.advance(600)
    nodes = run.mesh()[0]
    top = nodes[:, 1] == nodes[:, 1].max()
    assert np.all(run.nodes()[1][top, 1] == -5.0)


@MODES
def test_nodes_without_way_are_counted_and_not_how_often_they_were_looked_at(cracking, mode):
    """Each is looked at again whenever its failure has grown by a twentieth."""
    run = cracking("burst", mode).start()
    run.advance(1000)
    assert 0 < run.sizes().closed < run.sizes().nodes - run.sizes().cracks
