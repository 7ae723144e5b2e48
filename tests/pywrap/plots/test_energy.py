"""Where the energy went (plots/energy.py)."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import PolyCollection

from lithofrac.analysis.runs import Run
from lithofrac.plots import energy

pytestmark = pytest.mark.no_core


def names(axes):
    """Names in the legend of a panel."""
    return [text.get_text() for text in axes.get_legend().get_texts()]


def top_of_stack(axes):
    """Height of the stack at the end of the run."""
    corners = np.concatenate(
        [path.vertices for drawn in axes.findobj(PolyCollection) for path in drawn.get_paths()]
    )
    return corners[corners[:, 0] == corners[:, 0].max(), 1].max()


def test_continuum_run_has_ledger_and_residual_alone(make_run, data_folder):
    figure = energy.figure([make_run("sandstone_triaxial_p00")], data_folder)
    assert len(figure.axes) == 2
    assert "friction" not in names(figure.axes[0])


def test_run_with_cracks_shows_its_small_entries(make_cracked_run, data_folder):
    figure = energy.figure([make_cracked_run("soft_p00", test="plane_strain")], data_folder)
    ledger, small, _ = figure.axes
    assert {"friction", "crack insertion", "damping", "external work"} <= set(names(ledger))
    assert {"kinetic", "friction", "crack insertion", "mass lumping"} <= set(names(small))
    assert small.get_yscale() == "log"
    assert small.get_ylabel() == "small entries\n[J per metre of depth]"
    assert "contact pressure" not in names(small)  # 1e-9 of the largest energy is the floor


def test_what_takes_energy_is_stacked_and_what_gives_it_is_not(make_cracked_run, data_folder):
    """Work of the bond that takes 60 J raises the stack by them, work that gives them does not."""
    folder = make_cracked_run("sandstone_soft_p00")
    taken = top_of_stack(energy.figure([folder], data_folder).axes[0])
    table = pd.read_parquet(folder / "energy.parquet")
    for factor, change in ((0.0, -60.0), (-1.0, -60.0)):
        table.assign(insertion_J=factor * table["insertion_J"]).to_parquet(
            folder / "energy.parquet"
        )
        given = top_of_stack(energy.figure([folder], data_folder).axes[0])
        assert given - taken == pytest.approx(change, rel=1e-6)


def test_energy_of_an_axisymmetric_run_is_per_radian(make_run, data_folder):
    figure = energy.figure([make_run("sandstone_triaxial_p00")], data_folder)
    assert figure.axes[0].get_ylabel() == "energy [J per radian]"


def test_residual_is_over_the_largest_energy_that_the_run_has_seen(make_run, data_folder):
    folder = make_run("sandstone_triaxial_p00")
    drawn = energy.figure([folder], data_folder).axes[-1].lines[0].get_ydata()
    table = Run(folder).energy
    largest = table["external_J"].max()
    np.testing.assert_allclose(drawn[-1], table["residual_J"].iloc[-1] / largest)
