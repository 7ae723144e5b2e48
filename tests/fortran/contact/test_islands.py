"""Islands of boundary nodes that candidates join (fortran/contact/islands.f90)."""

import numpy as np
from contact_models import join, moved
from models import rectangle

from lithofrac.kernels import contact_candidates, contact_islands


def stacks(columns, heights, gap=0.01):
    """Columns of blocks of different height, near enough to meet within a column only."""
    block = rectangle(3, 2)
    parts = {
        f"block{i}_{k}": moved(block, (3.0 * i, k * (1 + gap)))
        for i, height in zip(range(columns), heights, strict=True)
        for k in range(height)
    }
    return join(**parts)


def test_blocks_that_touch_are_one_island_and_others_are_not():
    mesh = stacks(3, [3, 1, 2])
    island, _ = contact_islands(mesh, 2)
    column = (mesh.nodes[:, 0] // 3.0).astype(int)
    on_boundary = island >= 0
    corner, edge = contact_candidates(mesh, 0 * mesh.nodes)
    for pairs in (corner, edge):
        assert (island[pairs[:, 0]] == island[pairs[:, 1]]).all()
    assert (column[island[on_boundary]] == column[on_boundary]).all()
    touched = np.unique(np.concatenate([corner, edge]))
    # faces of a column that lie apart are islands of their own, those that meet are one
    assert len(np.unique(island[touched])) < len(touched) / 4
    alone = np.setdiff1d(np.flatnonzero(on_boundary & (column == 1)), touched)
    np.testing.assert_array_equal(island[alone], alone)
    assert (island[island[on_boundary]] == island[on_boundary]).all()
    assert (island[on_boundary] <= np.flatnonzero(on_boundary)).all()


def test_islands_stay_whole_and_groups_are_even():
    mesh = stacks(12, [2] * 12)
    island, group = contact_islands(mesh, 3)
    on_boundary = np.flatnonzero(island >= 0)
    np.testing.assert_array_equal(group[on_boundary], group[island[on_boundary]])
    size = np.bincount(group[on_boundary], minlength=3)
    largest = np.bincount(island[on_boundary]).max()
    assert size.max() - size.min() <= largest
    _, one = contact_islands(mesh, 1)
    assert (one[on_boundary] == 0).all()
