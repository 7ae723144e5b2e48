"""The figure of a study (pywrap/lithofrac/plots/study.py)."""

import pytest

from lithofrac.data import DataError
from lithofrac.plots import style
from lithofrac.plots.study import figure, words_of

pytestmark = pytest.mark.no_core

STUDY = """\
title: Confinement
base: case.yaml
cases:
  a: {loading.confinement_MPa: 5, fracture.mode: "off"}
  b: {loading.confinement_MPa: 20, fracture.mode: "off"}
  c: {loading.confinement_MPa: 5, fracture.mode: inter_element}
realisations: 2
quantities: [strength.strength_MPa, strength.largest_stress_MPa, crack_length_mm]
plot: {x: loading.confinement_MPa, y: [strength.strength_MPa], series: fracture.mode}
"""
FACTORS = {"a": 1.0, "a@seed2": 1.1, "b": 1.0, "b@seed2": 1.0, "c": 0.5, "c@seed2": 0.5}


@pytest.fixture
def drawn(tmp_path, make_run, data_folder):
    """drawn(old, new): the axes of the study above with words replaced."""
    runs = [
        make_run(name, confinement=20 if name[0] == "b" else 5, factor=factor)
        for name, factor in FACTORS.items()
    ]

    def make(old="", new=""):
        path = tmp_path / "study.yaml"
        path.write_text(STUDY.replace(old, new) if old else STUDY)
        made = figure([path, *runs], data_folder)
        style.plt.close(made)
        return made

    return make


def test_a_line_joins_the_means_and_each_run_has_its_mark(drawn):
    made = drawn()
    lines = {line.get_label(): line for line in made.axes[0].get_lines()}
    mean = lines["fracture mode off"]
    assert list(mean.get_xdata()) == [5, 20]
    assert mean.get_ydata()[0] == pytest.approx(1.05 * 143.6, rel=1e-3)
    marks = [line for line in made.axes[0].get_lines() if line.get_linestyle() == "None"]
    assert sorted(len(line.get_xdata()) for line in marks) == [2, 4]
    panel = made.axes[0]
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("confinement [MPa]", "strength [MPa]")
    assert panel.get_ylim()[0] == 0.0


def test_a_logarithmic_axis_has_a_tick_at_each_value(drawn):
    panel = drawn("series: fracture.mode", "x_scale: log").axes[0]
    assert [tick.get_text() for tick in panel.get_xticklabels()] == ["5", "20"]


def test_a_text_on_the_horizontal_axis_gives_places_side_by_side(drawn):
    made = drawn(
        "x: loading.confinement_MPa, y: [strength.strength_MPa], series: fracture.mode",
        "x: fracture.mode, y: [strength.strength_MPa, strength.largest_stress_MPa]",
    )
    panel = made.axes[0]
    assert [tick.get_text() for tick in panel.get_xticklabels()] == ["off", "inter_element"]
    assert [text.get_text() for text in made.legends[0].get_texts()] == [
        "strength",
        "largest stress",
    ]


def test_nothing_to_draw_and_no_logarithm_are_refused(drawn):
    with pytest.raises(DataError, match="no run has a value of crack_length_mm"):
        drawn("y: [strength.strength_MPa]", "y: [crack_length_mm]")
    with pytest.raises(DataError, match=r"x_scale = log: expected fracture.mode to be numbers"):
        drawn("{x: loading.confinement_MPa,", "{x_scale: log, x: fracture.mode,")


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("material.fracture_energy_J_m2", ("fracture energy", "J/m²")),
        ("loading.speed_m_s", ("speed", "m/s")),
        ("contact.friction.rock-platen", ("friction rock-platen", "")),
        ("cracks", ("crack events", "")),
        (
            "hole_initiation.initiation_MPa[primary,crack]",
            ("initiation (primary, crack)", "MPa"),
        ),
    ],
)
def test_a_key_in_words_with_its_unit(key, words):
    assert words_of(key) == words
