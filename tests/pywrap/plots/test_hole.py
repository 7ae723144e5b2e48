"""Gauges, patterns and size effect of the hole (plots/hole.py, plots/size_effect.py)."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.text import Text

from lithofrac.analysis.tables import NOT_DIGITISED
from lithofrac.plots import hole, size_effect

pytestmark = pytest.mark.no_core
MICROSTRAIN = {"unit": "microstrain", "printed_min": -6000, "printed_max": 6000}
FIG_15 = {"x": MICROSTRAIN, "y": {"unit": "MPa", "printed_min": 0, "printed_max": 24}}
FIG_16 = {"x": {"unit": "mm", "printed_min": 0, "printed_max": 35},
          "y": {"unit": "MPa", "printed_min": 0, "printed_max": 20}}  # fmt: skip
STAGES = [
    (12.0, 0.05, 1.1, "tensile"),
    (14.0, -0.9, 1.4, "tensile"),
    (16.0, 1.1, 0.1, "compressive_dilation"),
]


def words(figure):
    return [text.get_text() for text in figure.findobj(Text)]


def marks(axes):
    """Stresses of the marks with an interval."""
    return sorted(float(bar.lines[0].get_ydata()[0]) for bar in axes.containers)


def test_gauges_stand_on_the_printed_axes(make_hole, data_folder):
    whole, close = hole.gauges([make_hole("hole_r25.0", largest=20.0)], data_folder).axes
    assert whole.get_xlim() == (-6000.0, 6000.0)
    assert whole.get_ylim() == (0.0, 24.0)
    assert whole.get_xlabel() == close.get_xlabel() == "principal strain [microstrain]"
    assert whole.get_ylabel() == "axial stress [MPa]"


def test_stress_beyond_the_printed_axis_is_shown_and_said(make_hole, data_folder):
    drawn = hole.gauges([make_hole("hole_r25.0", largest=30.0)], data_folder)
    assert drawn.axes[0].get_ylim()[1] > 30.0
    assert "printed up to 24 MPa" in words(drawn)


def test_changes_of_curvature_are_marked_in_both_panels(make_hole, data_folder):
    whole, close = hole.gauges([make_hole("hole_r25.0", largest=20.0)], data_folder).axes
    for panel in (whole, close):
        for kink in (4.0, 8.0, 10.0):
            assert min(abs(np.array(marks(panel)) - kink)) < 0.1


def test_event_at_a_strain_beyond_the_axis_is_named(make_hole, data_folder):
    """Sidewall at 140e-6 a MPa to 10 MPa, twice that beyond: 6000 microstrain at 26.4 MPa."""
    crack = (28.0, 1.1, 0.1, "compressive_dilation")
    drawn = hole.gauges([make_hole("hole_r25.0", cracks=[crack], largest=30.0)], data_folder)
    (said,) = (text for text in words(drawn) if text.startswith("beyond the axis"))
    assert "sidewall crack:\n28.0 MPa" in said


def test_gauges_say_that_nothing_is_digitised_until_something_is(make_hole, data_folder, digitise):
    run = make_hole("hole_r25.0")
    assert NOT_DIGITISED in words(hole.gauges([run], data_folder))
    data = digitise([(500.0, 6.0)], figure="15", compare_with="hole_r25.0", **FIG_15)
    assert NOT_DIGITISED not in words(hole.gauges([run], data))


def cracks_drawn(axes):
    lines = [c for c in axes.collections if isinstance(c, LineCollection)][1:]  # first: outline
    return [len(c.get_segments()) for c in lines]


def test_each_stage_shows_the_cracks_up_to_its_own(make_hole, data_folder):
    drawn = hole.patterns([make_hole("hole_r25.0", cracks=STAGES)], data_folder)
    assert [cracks_drawn(panel) for panel in drawn.axes] == [[1, 0], [2, 0], [2, 1]]
    titles = [panel.get_title(loc="left") for panel in drawn.axes]
    assert titles == ["primary\n12.0 MPa", "remote\n14.0 MPa", "sidewall\n16.0 MPa"]


def test_stage_that_never_came_is_said(make_hole, data_folder):
    drawn = hole.patterns([make_hole("hole_r25.0", cracks=STAGES[:1])], data_folder)
    assert drawn.axes[1].get_title(loc="left") == "no remote crack;\nat 24.0 MPa, the largest"


def test_stage_of_a_failed_block_is_said(make_hole, data_folder):
    late = (24.0 * 1.05, 0.05, 1.1, "tensile")
    drawn = hole.patterns([make_hole("hole_r25.0", cracks=[late])], data_folder)
    assert drawn.axes[0].get_title(loc="left").endswith("after the largest stress")


def test_patterns_have_a_row_for_each_radius_of_the_paper(make_hole, data_folder):
    folders = [make_hole(f"hole_r{r:04.1f}", radius_mm=r, cracks=STAGES) for r in (6.4, 25.0, 9.5)]
    folders.append(make_hole("hole_r25.0@seed2", cracks=STAGES))
    drawn = hole.patterns(folders, data_folder)
    assert len(drawn.axes) == 6
    assert "R = 25 mm" in drawn.axes[0].get_ylabel()
    assert "R = 6.4 mm" in drawn.axes[3].get_ylabel()


@pytest.fixture
def radii(make_hole):
    """Runs over five radii whose primary crack comes at 50 MPa mm over R, with one in 150 mm."""
    folders = [
        make_hole(f"hole_r{r:04.1f}", radius_mm=r, cracks=[(50.0 / r, 0.0, 1.1, "tensile")])
        for r in (3.2, 6.4, 12.7, 19.1, 25.0)
    ]
    crack = (9.0, 0.0, 1.1, "tensile")
    return [*folders, make_hole("hole_block150_r06.4", radius_mm=6.4, cracks=[crack])]


def test_size_effect_has_a_panel_for_each_zone_on_the_printed_axes(radii, data_folder):
    drawn = size_effect.figure(radii, data_folder)
    tops = [panel.get_ylim()[1] for panel in drawn.axes[:3]]
    assert tops == [20.0, 40.0, 40.0]
    assert all(panel.get_xlim() == (0.0, 35.0) for panel in drawn.axes[:3])
    assert [panel.get_title(loc="left") for panel in drawn.axes[:3]] == [
        "(a) primary", "(b) remote", "(c) sidewall",
    ]  # fmt: skip
    assert words(drawn).count(NOT_DIGITISED) == 3


def test_stress_beyond_a_printed_axis_extends_it_and_says_so(make_hole, data_folder):
    folders = [make_hole("hole_r06.4", radius_mm=6.4, cracks=[(26.0, 0.0, 1.1, "tensile")],
                         largest=30.0)]  # fmt: skip
    drawn = size_effect.figure(folders, data_folder)
    assert drawn.axes[0].get_ylim()[1] > 26.0
    assert "printed axis ends at 20 MPa" in words(drawn)


def test_other_series_and_theories_are_in_the_legend(radii, data_folder):
    legend = size_effect.figure(radii, data_folder).axes[3].get_legend()
    names = [text.get_text() for text in legend.get_texts()]
    assert "blocks of 150 mm" in names
    assert "wall elements of 1 mm" not in names
    assert "finite fracture mechanics" in names


def test_digitised_curve_replaces_the_note_of_its_panel(radii, digitise):
    data = digitise([(25.0, 9.0)], figure="16a", compare_with="hole", **FIG_16)
    drawn = size_effect.figure(radii, data)
    assert words(drawn).count(NOT_DIGITISED) == 2
