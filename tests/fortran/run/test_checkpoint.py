"""A state that was saved between cracks goes on to the bit (fortran/run/checkpoint.f90)."""

import numpy as np
import pytest

from lithofrac.errors import CoreError

pytestmark = pytest.mark.restart
MODES = pytest.mark.parametrize("mode", ["inter_element", "intra_element"])


def same_bits(one, other):
    return np.array_equal(one.save().view(np.int64), other.save().view(np.int64))


def to_next_crack(run):
    cracks, limit = run.sizes().cracks, run.step + 2000
    while run.sizes().cracks == cracks:
        assert run.step < limit, "no crack comes"
        run.advance(1)


@MODES
@pytest.mark.parametrize(("load", "first", "more"), [("pull", 5, 1), ("squeeze", 90, 40)])
def test_a_run_resumes_at_the_step_of_a_crack(cracking, load, mode, first, more):
    """There the list of contacts is out of date, but its impulses are still the first guess."""
    model = cracking(load, mode)
    whole = model.start()
    whole.advance(first)
    for _ in range(2):
        to_next_crack(whole)
        resumed = model.start()
        resumed.restore(whole.save())
        resumed.check()
        assert same_bits(whole, resumed)
        for run in (whole, resumed):
            run.advance(more)
        assert same_bits(whole, resumed)
        for one, other in zip(whole.mesh(), resumed.mesh(), strict=True):
            np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(whole.cracks(), resumed.cracks())


@MODES
def test_threads_change_no_bit_of_a_cracking_run(cracking, mode):
    runs = {threads: cracking("squeeze", mode).start() for threads in (1, 2, 3, 8)}
    for threads, run in runs.items():
        run.advance(400, threads)
    assert runs[1].sizes().cracks > 10
    assert all(same_bits(runs[1], run) for run in runs.values())


@MODES
def test_a_state_cut_short_is_refused(cracking, mode):
    model = cracking("pull", mode)
    run = model.start()
    to_next_crack(run)
    state = run.save()
    for length in (1, 3, 40, len(state) // 2, len(state) - 1):
        with pytest.raises(CoreError, match="another model"):
            model.start().restore(state[:length])
