"""Runs that crack: the time step, the ledger, same bits for any threads and after a resume."""

from dataclasses import replace

import numpy as np
import pytest
from fracture_models import brittle, pulled_bar, turned_bar, weakened

from lithofrac.core import Run
from lithofrac.problem import Contact, Fracture, PressureLoad, Ramp

pytestmark = pytest.mark.verification
WIDTH, HEIGHT, SIZE = 6e-3, 9e-3, 0.8e-3  # m
MODES = ("inter_element", "intra_element")
STEPS = {"inter_element": 5000, "intra_element": 12000}  # of pulling; the second ones are shorter
THROUGH = 12  # column of the crack record


def squeezed_bar(mode, **options):
    """A bar that parts while its sides, where the crack comes out, are under a pressure.

    Both sides are surfaces of their own, so cracks split edges that have a load and a tag.
    """
    mesh = weakened(turned_bar(SIZE, 0.3, WIDTH, HEIGHT, jitter=0.25))
    ramp = Ramp(0.0, 2e-5)
    return pulled_bar(
        mesh,
        brittle(fracture_energy=1.0, poisson_ratio=0.2),
        0.1,
        1e-2,
        fracture=Fracture(mode, **options),
        contact=Contact({("left", "right"): 0.3, ("rock", "left"): 0.4}, 0.5),
        pressure_loads=tuple(
            PressureLoad(name, mesh.edge_sets[name], 1e6, 0.0, ramp) for name in ("left", "right")
        ),
    )


def bits(run):
    return run.save().tobytes()


@pytest.fixture(scope="module", params=MODES)
def parted(request):
    """A bar run through all its cracks, the steps at which they came, and its bits.

    The ledger notes the largest energy that it is asked for, so that asking changes the bits.
    """
    run = Run(squeezed_bar(request.param))
    run.advance(STEPS[request.param])
    return run, np.unique(run.cracks()[:, 0].astype(int)), bits(run)


def test_the_ledger_closes_while_a_bar_parts(parted):
    whole, steps, _ = parted
    run, residual = Run(whole.problem), 0.0
    while run.step < whole.step:
        run.advance(50)
        residual = max(residual, abs(run.energy().residual))
    print(f"{run.sizes().cracks} cracks, residual {residual:.1e}")
    assert len(steps) >= 3
    assert residual < 1e-6


def test_faces_that_crack_keep_their_pressure(parted):
    """Pressure times length of the sides, though their edges were split."""
    run, *_ = parted
    n = len(run.problem.velocity_loads)
    force = run.loads()[n:, 0]
    np.testing.assert_allclose(force, 1e6 * HEIGHT, rtol=0.02)


def test_cracks_along_edges_leave_the_step_of_the_continuum(parted):
    """Equal in inter-element runs; cuts leave at least 0.4 of it."""
    run, *_ = parted
    continuum = Run(replace(run.problem, fracture=None))
    if run.problem.fracture.mode == "inter_element":
        assert not run.cracks()[:, THROUGH].any()
        assert run.dt == continuum.dt
        assert run.critical_step == continuum.critical_step
        return
    cuts = int(run.cracks()[:, THROUGH].sum())
    print(f"{cuts} cuts, {run.dt / continuum.dt:.3f} of the step")
    assert cuts > 0
    assert run.dt >= 0.4 * continuum.dt * (1 - 1e-12)


@pytest.mark.parametrize("mode", MODES)
def test_threads_change_no_bit_of_a_run_that_cracks(mode):
    runs = [Run(squeezed_bar(mode)) for _ in range(3)]
    for threads, run in enumerate(runs, start=1):
        run.advance(STEPS[mode], threads)
    assert runs[0].sizes().cracks >= 3
    assert bits(runs[0]) == bits(runs[1]) == bits(runs[2])


@pytest.mark.restart
@pytest.mark.parametrize("after", [-1, 0, 1, 7, 40])
def test_a_resume_in_the_middle_of_cracking_is_bitwise(parted, after):
    """Saved just before a crack, with it, and while its bonds fade."""
    whole, steps, bits_of_whole = parted
    first, second = Run(whole.problem), Run(whole.problem)
    first.advance(int(steps[len(steps) // 2]) + after)
    assert 0 < first.sizes().cracks
    second.restore(first.save())
    second.advance(whole.step - second.step)
    assert bits(second) == bits_of_whole
    assert second.sizes() == whole.sizes()
    # `save` cannot show what it leaves out
    np.testing.assert_array_equal(second.cracks(), whole.cracks())
    np.testing.assert_array_equal(second.loads(), whole.loads())
    np.testing.assert_array_equal(second.contact_forces(), whole.contact_forces())
    for mine, other in zip(second.mesh(), whole.mesh(), strict=True):
        np.testing.assert_array_equal(mine, other)
