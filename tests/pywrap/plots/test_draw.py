"""Figures and their numbers from results made in the test (plots/)."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text

from lithofrac.data import DataError
from lithofrac.plots import draw, measured, sandstone, single_element, style
from lithofrac.plots.draw import FIGURES, TABLES

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]
QUARTZITE = ROOT / "configs" / "materials" / "quartzite.yaml"
BADGE = "experiment: not digitised"


@pytest.fixture
def runs(make_run):
    """Two tests at two confinements, and a stiffer one without a peak."""
    return [
        make_run("sandstone_triaxial_p00"),
        make_run("sandstone_triaxial_p10", confinement=10.0),
        make_run("sandstone_plane_strain_p00", "plane_strain", 0.0, 0.02, 1.1),
        make_run("sandstone_plane_strain_p10", "plane_strain", 10.0, 0.02, 1.1),
        make_run("sandstone_plane_strain_k05_p10", "plane_strain", 10.0, 0.05, peak=False),
    ]


def words(figure):
    """All text of a figure."""
    style.plt.rcParams.update(style.SETTINGS)
    figure.canvas.draw()
    return "\n".join(text.get_text() for text in figure.findobj(Text) if text.get_visible())


def assert_labelled(figure):
    """Every axis that is drawn says what it shows, with a unit; and nothing is empty."""
    for axes in figure.axes:
        if not axes.axison:
            continue
        assert axes.lines or axes.collections, "empty panel"
        shared = axes.get_subplotspec() is not None and not axes.xaxis.get_tick_params().get(
            "labelbottom", True
        )
        labels = [axes.get_ylabel()] + ([] if shared else [axes.get_xlabel()])
        for label in filter(None, labels):
            assert re.search(r"\[[^\]]+\]", label), f"no unit in {label!r}"


def test_digitised_curve_replaces_the_badge_of_its_own_figure(runs, digitise, data_folder):
    """End to end: the badge goes, the points and their legend come, Fig. 10 is left alone."""
    before = words(sandstone.stress_strain(runs, data_folder))
    assert before.count(BADGE) == 2  # one a panel
    assert "experiment: triaxial, 10 MPa" not in before
    data = digitise([(0.1, 30.0), (0.5, 150.0), (1.5, 90.0)])
    after = words(sandstone.stress_strain(runs, data))
    assert after.count(BADGE) == 1  # plane strain is still missing
    assert "experiment: triaxial, 10 MPa" in after
    assert BADGE in words(sandstone.strength(runs, data))


def test_digitised_points_stand_where_they_were_read(runs, digitise):
    data = digitise([(0.1, 30.0), (0.5, 150.0)])
    panel = sandstone.stress_strain(runs, data).axes[0]
    drawn = [line.get_xydata() for line in panel.lines if line.get_marker() == "^"]
    np.testing.assert_allclose(drawn[0], [[0.1, 30.0], [0.5, 150.0]])


def test_curve_of_the_papers_model_does_not_count_as_an_experiment(runs, digitise):
    data = digitise([(0.1, 30.0)], origin="model", series="Klerck, triaxial")
    text = words(sandstone.stress_strain(runs, data))
    assert "model: Klerck, triaxial" in text
    assert text.count(BADGE) == 2


def test_digitised_strengths_replace_the_badge_of_figure_10(runs, digitise):
    data = digitise(
        [(0.0, 95.0), (10.0, 180.0)],
        figure="10",
        series="triaxial",
        compare_with="sandstone_triaxial",
        x={"unit": "MPa", "printed_min": 0, "printed_max": 40},
    )
    text = words(sandstone.strength(runs, data))
    assert BADGE not in text
    assert "experiment: triaxial" in text


def test_run_without_a_peak_is_shown_as_such(runs, data_folder):
    assert "plane strain, k = 0.05 E: no peak" in words(sandstone.strength(runs, data_folder))


def test_discrete_runs_stand_apart_from_the_continuum(runs, make_cracked_run, data_folder):
    """A soft block gets a panel, a stiff one with cracks is drawn through beside dashes."""
    runs += [
        make_cracked_run("sandstone_soft_p00", test="plane_strain"),
        make_cracked_run("sandstone_cracked_p00", test="plane_strain", stiffness=0.02),
    ]
    figure = sandstone.stress_strain(runs, data_folder)
    panels = figure.axes
    assert [panel.get_title(loc="left") for panel in panels] == list(sandstone.TITLES.values())
    dashes = [sorted({line.get_linestyle() for line in p.lines} - {"None"}) for p in panels]
    assert dashes[1:] == [["-"], ["-", "--"]]
    assert {"discrete", "continuum"} <= set(
        words(sandstone.stress_strain(runs, data_folder)).split()
    )
    text = words(sandstone.strength(runs, data_folder))
    assert "plane strain, soft pressure" in text
    assert "plane strain, k = 0.02 E\n" in text + "\n"
    assert "plane strain, k = 0.02 E, discrete" in text


def test_figures_label_every_axis_with_a_unit(runs, make_bench, data_folder):
    curves = [make_bench("sandstone", level) for level in (0, 10)]
    for figure in (
        sandstone.stress_strain(runs, data_folder),
        sandstone.strength(runs, data_folder),
        single_element.figure(curves, data_folder),
        measured.figure([QUARTZITE], data_folder),
        FIGURES["energy"](runs, data_folder),
    ):
        assert_labelled(figure)


def test_same_results_give_the_same_file(runs, tmp_path, data_folder):
    for name in ("a.svg", "b.svg"):
        draw("strength", runs, tmp_path / name, data_folder)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_numbers_of_a_figure_are_written_beside_it(runs, tmp_path, data_folder):
    draw("strength", [run / "summary.json" for run in runs], tmp_path / "s.csv", data_folder)
    table = pd.read_csv(tmp_path / "s.csv")
    assert list(table["case"]) == [run.name for run in runs]


def test_table_of_nothing_is_written_and_read_back(tmp_path, data_folder):
    draw("kirsch", [], tmp_path / "k.csv", data_folder)
    assert (tmp_path / "k.csv").exists()


@pytest.mark.parametrize(
    ("kind", "out", "words"),
    [
        ("strenght", "a.svg", "plot: no figure 'strenght', expected one of "),
        ("mesh", "a.csv", "plot: no table 'mesh', expected one of "),
        ("strength", "a.jpg", "a.jpg: format '.jpg', expected one of .svg, .png, .pdf, .csv"),
    ],
)
def test_unknown_kind_or_format_is_refused(tmp_path, kind, out, words):
    with pytest.raises(DataError) as caught:
        draw(kind, [], tmp_path / out)
    assert words in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_missing_input_is_refused(tmp_path):
    with pytest.raises(DataError, match="no such file or folder, expected an input"):
        draw("strength", [tmp_path / "lost"], tmp_path / "a.svg")


def test_figure_of_nothing_is_refused(tmp_path):
    with pytest.raises(DataError, match="plot strength: no input, expected results folders"):
        draw("strength", [], tmp_path / "a.svg")


def test_file_that_is_no_bench_curve_is_refused(tmp_path):
    (tmp_path / "curve.parquet").touch()
    with pytest.raises(DataError, match="is not drawn, expected curves"):
        draw("single_element", [tmp_path / "curve.parquet"], tmp_path / "a.svg")


def test_every_kind_says_what_it_is():
    for function in {**FIGURES, **TABLES}.values():
        assert function.__doc__


def test_colours_darken_with_confinement_and_stay_apart_in_grey():
    colours = style.confinement_colours([0, 1, 2, 5, 10, 15, 20, 30, 40])
    grey = [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b, _ in colours.values()]
    assert min(np.diff(grey)) > 0.02
    assert max(grey) < 0.75  # visible on white
