"""Strip punch at several fracture energies (plots/punch.py)."""

import pytest
import yaml
from matplotlib.text import Text

from lithofrac.plots import punch

pytestmark = pytest.mark.no_core
BADGE = "experiment: not digitised"


@pytest.fixture
def make_punch(make_run, make_cracked_run):
    """make_punch(name, gf, discrete=False, compression=True) -> folder of a punch run."""

    def made(name, gf, discrete=False, compression=True, factor=1.0):
        make = make_cracked_run if discrete else make_run
        folder = make(name, test="punch", confinement=4.5, factor=factor)
        case = yaml.safe_load((folder / "case.yaml").read_text())
        case["material"] |= {"fracture_energy_J_m2": float(gf), "compression": compression}
        (folder / "case.yaml").write_text(yaml.safe_dump(case))
        return folder

    return made


@pytest.fixture
def runs(make_punch):
    return [
        make_punch("punch_gf1200", 1200),
        make_punch("punch_gf60", 60),
        make_punch("punch_discrete", 60, discrete=True),
        make_punch("punch_tension_only", 60, discrete=True, compression=False),
    ]


def legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_tension_alone_has_a_panel_of_its_own(runs, data_folder):
    both, alone = punch.figure(runs, data_folder).axes
    assert [name.split(",")[0] for name in legend(both)] == ["continuum", "continuum", "discrete"]
    assert [name.split(",")[0] for name in legend(alone)] == ["discrete"]
    assert alone.get_title(loc="left") == "tension alone"


def test_variants_of_the_discrete_run_have_looks_and_names_of_their_own(make_punch, data_folder):
    names = ("punch_tension_only", "punch_tension_only_coarse", "punch_tension_only_gf300")
    runs = [make_punch(name, 60, discrete=True, compression=False) for name in names]
    panel = punch.figure(runs, data_folder).axes[0]
    assert [name.split(",")[0] for name in legend(panel)] == [
        "discrete", "tension_only_coarse", "tension_only_gf300",
    ]  # fmt: skip
    drawn = [line for line in panel.get_lines() if not line.get_label().startswith("_")]
    assert len({(line.get_color(), line.get_linestyle()) for line in drawn}) == 3


def test_curves_stand_in_the_order_of_fracture_energy(runs, data_folder):
    names = legend(punch.figure(runs, data_folder).axes[0])
    assert ["60 J/m²" in names[0], "1200 J/m²" in names[1]] == [True, True]
    assert names[0].endswith(" MPa")


def test_panel_is_left_out_when_its_case_is_not_in_the_suite(runs, data_folder):
    assert len(punch.figure(runs[:1], data_folder).axes) == 1
    only = punch.figure(runs[3:], data_folder).axes
    assert [panel.get_title(loc="left") for panel in only] == ["tension alone"]


def test_axes_have_units_and_say_that_nothing_is_digitised(runs, data_folder):
    for panel in punch.figure(runs, data_folder).axes:
        assert panel.get_xlabel() == "axial strain [%]"
        assert panel.get_ylabel() == "punch stress [MPa]"
        assert BADGE in [text.get_text() for text in panel.findobj(Text)]


def test_digitised_curve_of_its_figure_replaces_the_note(runs, digitise):
    printed = {
        "x": {"unit": "percent", "printed_min": 0, "printed_max": 2},
        "y": {"unit": "MPa", "printed_min": 0, "printed_max": 1000},
    }
    data = digitise([(0.1, 30.0)], figure="6a", compare_with="punch_gf60", **printed)
    both, alone = punch.figure(runs, data).axes
    assert BADGE not in [text.get_text() for text in both.findobj(Text)]
    assert BADGE in [text.get_text() for text in alone.findobj(Text)]


def test_stages_are_lettered_on_the_discrete_curve_and_lacking_ones_are_said(runs, data_folder):
    """The curve falls once, to its residual: B and D are one point, and there is no C."""
    for panel in punch.figure(runs, data_folder).axes:
        words = [text.get_text() for text in panel.findobj(Text)]
        assert "A" in words and "B, D" in words and "C" not in words
    both = punch.figure(runs, data_folder).axes[0]
    assert "punch_discrete: no regain" in [text.get_text() for text in both.findobj(Text)]
