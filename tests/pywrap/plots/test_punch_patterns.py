"""Patterns beneath the strip punch side by side (plots/punch_patterns.py)."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgba
from punch_runs import CRACKS

from lithofrac.data import DataError
from lithofrac.plots import punch_patterns, style

pytestmark = pytest.mark.no_core


@pytest.fixture
def runs(make_punch_run):
    return [
        make_punch_run("punch_gf300", gf=300),
        make_punch_run("punch_gf60"),
        make_punch_run("punch_discrete", cracks=CRACKS),
        make_punch_run("punch_tension_only", compression=False, cracks=CRACKS),
    ]


def titles(figure):
    return [axes.get_title(loc="left") for axes in figure.axes if axes.axison]


def bars(axes, colour):
    """Segments of a colour, (n, 2, 2) [mm]."""
    return np.array(
        [
            segment
            for drawn in axes.findobj(LineCollection)
            if np.array_equal(drawn.get_colors()[0], to_rgba(colour))
            for segment in drawn.get_segments()
        ]
    )


def test_panels_are_those_of_the_paper_with_the_lowest_fracture_energy(runs, data_folder):
    names = titles(punch_patterns.figure(runs, data_folder))
    assert [name[:3] for name in names] == ["(a)", "(b)", "(c)", "(e)"]
    assert [name.split(":")[0][4:] for name in names] == [
        "punch_gf60", "punch_gf60", "punch_discrete", "punch_tension_only",
    ]  # fmt: skip
    assert all(" MPa" in name for name in names)


def test_panel_is_left_out_when_its_case_is_not_in_the_suite(runs, data_folder):
    assert [name[:3] for name in titles(punch_patterns.figure(runs[2:], data_folder))] == [
        "(c)", "(e)",
    ]  # fmt: skip
    with pytest.raises(DataError, match="no run of the strip punch"):
        punch_patterns.figure([], data_folder)


def test_bars_lie_in_the_direction_of_their_strain(runs, data_folder):
    """Flanks are pressed along y by 0.06 and extended along x by 0.04; 0.06 has the full length.

    Beneath them the axis is extended along x alone.
    """
    panel = punch_patterns.figure(runs, data_folder).axes[1]
    pressed, extended = (bars(panel, colour) for colour in (style.RED, style.BLUE))
    np.testing.assert_allclose(np.ptp(pressed[:, :, 0], axis=1), 0.0, atol=1e-9)
    np.testing.assert_allclose(np.ptp(extended[:, :, 1], axis=1), 0.0, atol=1e-9)
    full = punch_patterns.LONGEST * 2.0
    np.testing.assert_allclose(np.ptp(pressed[:, :, 1], axis=1), full)
    lengths = np.unique(np.ptp(extended[:, :, 0], axis=1).round(6))
    np.testing.assert_allclose(lengths, [full * 2.0 / 6.0, full * 4.0 / 6.0], atol=1e-5)


def test_first_damage_is_tinted_and_nothing_else(runs, data_folder):
    panel = punch_patterns.figure(runs, data_folder).axes[0]
    counts = {
        tuple(drawn.get_facecolor()[0]): len(drawn.get_paths())
        for drawn in panel.findobj(PolyCollection)
        if len(drawn.get_paths())
    }
    assert counts[to_rgba(punch_patterns.COMPRESSIVE)] == 4
    assert counts[to_rgba(punch_patterns.ROCK)] == 128 - 4


def test_axes_have_units(runs, data_folder):
    for panel in punch_patterns.figure(runs, data_folder).axes:
        assert (panel.get_xlabel(), panel.get_ylabel()) == ("x [mm]", "y [mm]")
