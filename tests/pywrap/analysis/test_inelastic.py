"""Inelastic strain from stress and strain of a frame (analysis/inelastic.py)."""

import numpy as np
import pytest
from punch_runs import block, write_field

from lithofrac.analysis.frames import frame_times
from lithofrac.analysis.inelastic import first_damage, frame_at, load_inelastic
from lithofrac.analysis.runs import Run

pytestmark = pytest.mark.no_core


@pytest.fixture
def run(make_punch_run):
    return Run(make_punch_run("punch_gf60"))


def elastic(rock, stress):
    """Strain (4,) with engineering shear of a stress (4,), by Hooke's law written out."""
    e, nu = rock.young, rock.poisson
    x, y, z, xy = stress
    normal = [x - nu * (y + z), y - nu * (x + z), z - nu * (x + y)]
    return np.array([*normal, 2.0 * (1.0 + nu) * xy]) / e


def write(run, **fields):
    """Overwrite the last frame of a run and read it."""
    time_s, path = frame_times(run.folder)[-1]
    write_field(path, block(), **fields)
    return load_inelastic(run, time_s, path)


def test_strain_that_the_stress_explains_is_not_inelastic(run):
    stress = np.array([-20e6, -90e6, -15e6, 12e6])
    n = len(block().triangles)
    state = write(
        run, stress=np.tile(stress, (n, 1)), strain=np.tile(elastic(run.rock, stress), (n, 1))
    )
    np.testing.assert_allclose(state.tensor, 0.0, atol=1e-18)
    assert not state.damaged.any()


def test_principal_values_are_those_put_in_and_turn_with_the_element(run):
    """Extension of 0.04 along the material's x, turned by 30 degrees with the block."""
    stress = np.array([5e6, -50e6, 0.0, 3e6])
    strain = elastic(run.rock, stress) + np.array([0.04, -0.06, 0.0, 0.0])
    mesh, angle = block(), np.radians(30.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    n = len(mesh.triangles)
    state = write(
        run,
        stress=np.tile(stress, (n, 1)),
        strain=np.tile(strain, (n, 1)),
        displacement=mesh.nodes @ turn.T - mesh.nodes,
        plastic=0.1,
    )
    values, directions = state.principal
    np.testing.assert_allclose(values, np.tile([-0.06, 0.04], (n, 1)), rtol=1e-9)
    extension = np.abs(directions[:, :, 1])
    np.testing.assert_allclose(extension, np.tile([np.cos(angle), np.sin(angle)], (n, 1)))
    assert state.damaged.all()


def test_first_damage_is_the_earliest_frame_that_has_any(run):
    state = first_damage(run)
    assert state.frame.time_s == frame_times(run.folder)[1][0]
    assert np.count_nonzero(state.damaged) == 4  # one in each square beside an edge


def test_run_without_damage_has_no_first(run):
    for _, path in frame_times(run.folder):
        write_field(path, block())
    assert first_damage(run) is None


def test_frame_of_a_moment_is_the_next_one_or_the_last(run):
    frames = frame_times(run.folder)
    assert frame_at(run, 0.5 * frames[1][0]) == frames[1]
    assert frame_at(run, frames[1][0]) == frames[1]
    assert frame_at(run, 2.0 * frames[2][0]) == frames[2]
