"""Fracture patterns on the deformed mesh (plots/fractures.py)."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.text import Text

from lithofrac.analysis.runs import Run
from lithofrac.plots import fractures, style
from lithofrac.plots.fractures import MODES, OTHER, ROCK, magnification

pytestmark = pytest.mark.no_core


@pytest.fixture
def folder(make_cracked_run):
    return make_cracked_run("sandstone_soft_p00", opening_mm=0.2, cracks=3)


def words(figure):
    """All text of a figure that can be seen."""
    style.plt.rcParams.update(style.SETTINGS)
    figure.canvas.draw()
    return "\n".join(text.get_text() for text in figure.findobj(Text) if text.get_visible())


def lines_in(axes, colour):
    """Segments drawn in a colour, (n, 2, 2) [mm]."""
    return np.array(
        [
            segment
            for drawn in axes.findobj(LineCollection)
            if np.array_equal(drawn.get_colors()[0], to_rgba(colour))
            for segment in drawn.get_segments()
        ]
    )


def test_both_faces_of_a_crack_are_drawn_apart_in_the_colour_of_its_mode(folder, data_folder):
    """Two tensile pieces above one of compressive dilation, open by 0.2 mm at the top."""
    panel = fractures.figure([folder], data_folder).axes[0]
    tensile = lines_in(panel, MODES["tensile"][1])
    compressive = lines_in(panel, MODES["compressive_dilation"][1])
    assert (len(tensile), len(compressive)) == (4, 2)
    assert np.ptp(tensile[..., 0]) == pytest.approx(0.2)
    assert compressive[..., 1].max() < tensile[..., 1].min() + 0.1
    np.testing.assert_allclose(np.ptp(compressive[..., 0]), 0.2 / 3, atol=1e-12)


def test_time_of_insertion_is_that_of_the_faces_own_crack(folder, data_folder):
    run = Run(folder)
    panel = fractures.figure([folder], data_folder).axes[1]
    drawn = next(c for c in panel.findobj(LineCollection) if c.get_array() is not None)
    times = np.sort(np.asarray(drawn.get_array()))
    np.testing.assert_allclose(times, 1e3 * np.repeat(run.cracks["time_s"], 2))
    heights = [segment[:, 1].mean() for segment in drawn.get_segments()]
    assert np.all(np.diff(np.array(heights)[np.argsort(drawn.get_array())][::2]) < 0.0)


def test_platens_are_neutral_and_rock_is_tinted(folder, data_folder):
    panel = fractures.figure([folder], data_folder).axes[0]
    bodies = panel.findobj(PolyCollection)
    colours = {tuple(body.get_facecolor()[0]): len(body.get_paths()) for body in bodies}
    assert colours == {to_rgba(ROCK): 48, to_rgba(OTHER): 8}


def test_axes_are_to_scale_in_millimetres_and_say_how_displacements_are_drawn(folder, data_folder):
    figure = fractures.figure([folder], data_folder)
    assert all(panel.get_aspect() == 1.0 for panel in figure.axes[:2])
    text = words(figure)
    assert "sandstone_soft_p00 at 2 ms, displacements to scale" in text
    counted = ("crack edges by mode", "tensile: 2", "dilation: 1")
    for part in ("x [mm]", "y [mm]", "time of insertion [ms]", *counted):
        assert part in text


@pytest.mark.parametrize(
    ("largest", "factor"), [(0.0, 1), (0.1, 1), (0.035, 1), (0.034, 2), (0.014, 10), (1e-9, 1000)]
)
def test_small_displacements_are_magnified_by_a_round_factor(folder, largest, factor):
    """Extent 7 mm: from 0.035 mm on they are seen as they are, and never drawn above 0.14 mm."""
    frame = Run(folder).last_frame
    moved = np.full_like(frame.displacement, largest)
    assert magnification(replace(frame, displacement=moved)) == factor


def test_magnified_opening_is_stated(make_cracked_run, data_folder):
    folder = make_cracked_run("closed", opening_mm=0.02)
    figure = fractures.figure([folder], data_folder)
    tensile = lines_in(figure.axes[0], MODES["tensile"][1])
    factor = magnification(Run(folder).last_frame)
    assert factor > 1
    assert np.ptp(tensile[..., 0]) == pytest.approx(0.02 * factor)
    assert f"displacements magnified {factor:g} times" in words(figure)


def test_lost_cracks_and_none_at_all_are_said_in_the_figure(folder, data_folder):
    table = pd.read_parquet(folder / "cracks.parquet")
    table.assign(x1_mm=table["x1_mm"] + 0.3 * (table.index == 1)).to_parquet(
        folder / "cracks.parquet"
    )
    assert "1 of 3 crack edges have no face" in words(fractures.figure([folder], data_folder))
    table.iloc[:0].to_parquet(folder / "cracks.parquet")
    figure = fractures.figure([folder], data_folder)
    assert "no cracks" in words(figure)
    (panel,) = figure.axes  # neither a second panel nor a bar without colours
    figure.draw_without_rendering()
    title = panel.title.get_window_extent()
    assert 0.0 < title.x0 < title.x1 < figure.bbox.width


def test_rubble_that_flies_off_does_not_shrink_the_picture(make_cracked_run, data_folder):
    """Halves 100 mm apart, of a block 4 mm wide."""
    folder = make_cracked_run("rubble", opening_mm=100.0)
    low, high = fractures.figure([folder], data_folder).axes[0].get_xlim()
    assert (low, high) == pytest.approx((-0.42, 4.42))


def test_cracks_far_smaller_than_the_bodies_are_shown_alone(folder, data_folder, monkeypatch):
    whole = np.ptp(fractures.figure([folder], data_folder).axes[0].get_xlim())
    monkeypatch.setattr(fractures, "CLOSER", 10.0)
    panel = fractures.figure([folder], data_folder).axes[0]
    assert np.ptp(panel.get_xlim()) != whole
    drawn = np.concatenate([lines_in(panel, colour) for _, colour in MODES.values()])
    for component, (low, high) in enumerate((panel.get_xlim(), panel.get_ylim())):
        assert (drawn[..., component] > low).all()
        assert (drawn[..., component] < high).all()


def test_large_bodies_are_drawn_in_metres(folder, data_folder, monkeypatch):
    monkeypatch.setattr(fractures, "METRES", 1.0)
    text = words(fractures.figure([folder], data_folder))
    assert "x [m]" in text
    assert "y [m]" in text
    assert "[mm]" not in text


def test_series_shows_a_panel_a_run(make_cracked_run, data_folder):
    folders = [
        make_cracked_run("sandstone_soft_p00"),
        make_cracked_run("sandstone_soft_p10", confinement=10.0),
    ]
    figure = fractures.series(folders, data_folder)
    assert len(figure.axes) == 2
    text = words(figure)
    assert "sandstone_soft: confinement" in text
    assert "10 MPa,\nto scale" in text
