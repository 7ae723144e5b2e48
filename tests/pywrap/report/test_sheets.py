"""Figures on sheets and their captions (report/sheets.py, captions.py)."""

import re
from pathlib import Path

import pytest

from lithofrac.data import DataError
from lithofrac.report import category_of, load_sheets
from lithofrac.report.captions import caption, is_of_a_run, template_of
from lithofrac.report.sheets import Sheet, pictured, place

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]
SHEETS = load_sheets(ROOT / "reports" / "sheets")
CAPTIONS = ROOT / "reports" / "captions"
TEXT = "# Punch\n\n<!-- figures: punch events_p* -->\n\nwords\n\n<!-- figures: *_p* -->\n"
NAMES = ["mesh_p2", "events_p2", "events_p1", "punch", "strength"]


def test_sheet_shows_the_figures_it_names_each_once_in_its_order():
    sheet = Sheet("6_punch", "Punch", TEXT)
    assert sheet.figures(NAMES) == ["punch", "events_p1", "events_p2", "mesh_p2"]
    shown = place(TEXT, NAMES, lambda name: f"[{name}]")
    assert re.findall(r"\[(\w+)\]", shown) == sheet.figures(NAMES)
    assert shown.index("[events_p2]") < shown.index("words") < shown.index("[mesh_p2]")


def test_committed_sheet_shows_the_pictures_of_the_gallery_below_its_comments():
    once = pictured(TEXT, ["punch", "mesh_p2"], "../gallery")
    assert once == TEXT.replace(
        "events_p* -->\n", "events_p* -->\n![punch](../gallery/punch.png)\n"
    ).replace("*_p* -->\n", "*_p* -->\n![mesh_p2](../gallery/mesh_p2.png)\n")
    assert pictured(once, ["punch", "mesh_p2"], "../gallery") == once
    assert pictured(once, [], "../gallery") == TEXT


def test_page_has_its_figures_in_place_of_the_pictures():
    shown = place(pictured(TEXT, ["punch"], "../gallery"), NAMES, lambda name: f"[{name}]")
    assert shown == place(TEXT, NAMES, lambda name: f"[{name}]")


def test_figure_belongs_to_the_first_sheet_that_shows_it():
    both = [Sheet("1_a", "A", "<!-- figures: x -->\n"), Sheet("2_b", "B", "<!-- figures: * -->\n")]
    assert category_of("x", both) == "1 A"
    assert category_of("y", both) == "2 B"
    with pytest.raises(DataError, match="figure y: stands on no sheet"):
        category_of("y", both[:1])


def test_committed_sheets_have_a_number_and_a_title():
    assert SHEETS
    for sheet in SHEETS:
        assert re.match(r"\d+ \w", sheet.category)


@pytest.mark.parametrize("path", sorted(CAPTIONS.glob("*.rst")), ids=lambda path: path.stem)
def test_every_caption_says_source_and_units(path):
    text = path.read_text()
    if path.stem != "suite":  # the words above the whole report
        assert "**Source.**" in text
        assert "**Units.**" in text


def test_caption_is_found_by_kind_and_filled_with_the_case(tmp_path):
    assert template_of("energy_punch_gf60", CAPTIONS) == (CAPTIONS / "energy.rst", "punch_gf60")
    assert template_of("punch", CAPTIONS) == (CAPTIONS / "compared.rst", "punch")
    html = caption("energy_punch_gf60", CAPTIONS, tmp_path)
    assert "<strong>punch_gf60</strong>" in html
    assert "\n\n" not in html


@pytest.mark.parametrize(
    ("figure", "words"),
    [
        ("hole_gauges", "strain in microstrain"),
        ("punch", "strain in percent"),
        ("size_effect", "radii in mm"),
        ("strength", "four lateral stiffnesses from 0.01 to 100 E"),
        ("stress_strain", "plane strain under a soft pressure"),
    ],
)
def test_caption_says_what_its_own_figure_shows(tmp_path, figure, words):
    assert words in " ".join(caption(figure, CAPTIONS, tmp_path).split())


def test_figure_of_a_case_that_did_not_run_is_an_old_one():
    assert is_of_a_run("energy_punch_gf60", CAPTIONS, {"punch_gf60"})
    assert not is_of_a_run("energy_punch_gf60", CAPTIONS, {"punch_discrete"})
    assert is_of_a_run("single_element_sandstone", CAPTIONS, set())


def test_caption_that_asks_for_what_is_not_there_is_refused(tmp_path):
    (tmp_path / "odd.rst").write_text("{{ snakemake.wildcards.cse }}")
    with pytest.raises(DataError, match=r"odd\.rst: .*cse.*, for figure odd"):
        caption("odd", tmp_path, tmp_path)
    (tmp_path / "odd.rst").write_text("*open")
    with pytest.raises(DataError, match=r"odd\.rst"):
        caption("odd", tmp_path, tmp_path)
    with pytest.raises(DataError, match=r"compared\.rst: no such file"):
        caption("other", tmp_path, tmp_path)
