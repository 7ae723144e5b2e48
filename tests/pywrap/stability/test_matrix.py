"""The stability matrix (pywrap/lithofrac/stability): every cell, the quick ones in every test.

`lithofrac stability` makes the table; here each cell is one test.
"""

import pytest

from lithofrac.core import Run
from lithofrac.stability.cell import MESHES, Left
from lithofrac.stability.families import FAMILIES, cells_of
from lithofrac.stability.families.scales import _torn
from lithofrac.stability.judge import judge
from lithofrac.stability.matrix import GOOD

CELLS = cells_of(tuple(FAMILIES))
QUICK = (
    "E ratio 1e+06",
    "density ratio 1e+06",
    "nu 0.4999",
    "nu 0.5",
    "phi 89 deg",
    "phi 90 deg",
    "c 0 and ft 1 Pa",
    "Gf 0",
    "10 GPa",
    "mu 10",
    "60 m/s",
    "1.1 of the speed guard",
    "1, material point",
    "aspect 100",
    "free, ringing",
    "two that collide",
)  # one extreme of each family that takes a second or less


def is_quick(cell):
    return cell.extreme.split(", soft")[0].split(", heavy")[0] in QUICK


@pytest.mark.parametrize(
    "cell",
    [pytest.param(c, id=c.name, marks=[] if is_quick(c) else pytest.mark.slow) for c in CELLS],
)
def test_cell_is_stable_refused_or_has_a_reason(cell):
    row = judge(cell)
    print(row)
    assert row["verdict"] in GOOD, row["note"]
    assert row["verdict"] != "n/a" or row["note"]


def test_every_family_says_something_of_every_mesh():
    for name, make in FAMILIES.items():
        cells = make()
        assert {cell.mesh for cell in cells} == set(MESHES), name
        assert {cell.family.replace(" ", "_") for cell in cells} == {name}
        assert any(not isinstance(cell.expected, Left) for cell in cells)


def test_cracks_open_in_the_cell_that_drifts_with_new_cracks():
    """Else it is the cell of the held crack again."""
    trial = _torn()
    run = Run(trial.problem)
    run.set_motion(trial.displacement, trial.velocity)
    run.advance(1000)
    assert run.sizes().cracks > 0


def test_no_two_cells_have_one_name():
    names = [cell.name for cell in CELLS]
    assert len(set(names)) == len(names)


def test_quick_cells_are_there():
    assert {word for word in QUICK if not any(word in cell.extreme for cell in CELLS)} == set()
