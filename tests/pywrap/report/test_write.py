"""Report and sheets from the tables of a pipeline (report/write.py)."""

import re
from pathlib import Path

import pytest

from lithofrac.data import DataError
from lithofrac.plots import draw
from lithofrac.plots.draw import TABLES
from lithofrac.report import write_report
from lithofrac.report.markdown import to_html

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]
SHEETS = ROOT / "reports" / "sheets"
QUARTZITE = ROOT / "configs" / "materials" / "quartzite.yaml"
SANDSTONE = QUARTZITE.with_name("sandstone.yaml")


@pytest.fixture
def out(make_run, make_bench, data_folder, tmp_path):
    """Folder of a pipeline with all tables of two runs and one bench curve."""
    runs = [
        make_run("sandstone_triaxial_p10", confinement=10.0),
        make_run("sandstone_plane_strain_p10", "plane_strain", 10.0, 0.02, 1.09),
    ]
    bench = [make_bench("sandstone", 10)]
    inputs = {
        "results": [ROOT / "reports" / "bands.csv", QUARTZITE, *bench]
        + [run / "summary.json" for run in runs],
        "claims": [ROOT / "reports" / "claims_bands.csv", *runs],
        "single_element": bench,
        "tautona": [QUARTZITE],
        "zigong_prediction": [SANDSTONE],
        "zigong_prediction_error": [SANDSTONE],
        "kirsch": [],
        "run_time": [ROOT / "reports" / "bands.csv", *runs],
        "hole_checks": [ROOT / "reports" / "bands.csv", *runs],
        "variants": [ROOT / "configs" / "suite.yaml", *runs],
    }
    (tmp_path / "out" / "tables").mkdir(parents=True)
    for name in TABLES.keys() - {"study", "speed_rows", "speed_targets"}:  # of other rules
        table = tmp_path / "out" / "tables" / f"{name}.csv"
        if name == "options":  # needs the compiled core
            table.write_text("rock,option\nsandstone,default\n")
            continue
        draw(name, inputs.get(name, runs), table, data_folder)
    return tmp_path / "out"


def test_report_holds_every_sheet_with_its_numbers(out):
    write_report(out, out / "report.md", SHEETS)
    text = (out / "report.md").read_text()
    for sheet in SHEETS.glob("*.md"):
        title = sheet.read_text().splitlines()[0]
        assert f"\n#{title}\n" in text
    assert "| sandstone_triaxial_p10 | 10 | 186.9 | 186.9 |" in text
    assert "commit 0123456789ab" in text
    assert "experiment: not digitised" in text


def test_report_shows_the_figures_that_are_there_with_their_captions(out):
    (out / "figures").mkdir()
    (out / "figures" / "strength.svg").touch()
    write_report(out, out / "report.md", SHEETS)
    text = (out / "report.md").read_text()
    assert 'src="figures/strength.svg"' in text
    assert "Strength of the sandstone specimens against confinement" in text
    assert 'src="figures/stress_strain.svg"' not in text


def test_page_of_a_scene_holds_its_figures_and_captions_in_itself(out):
    (out / "figures").mkdir()
    for name in ("strength.svg", "punch.svg"):
        (out / "figures" / name).write_text("<svg/>")
    write_report(out, out / "pages" / "2_sandstone_triaxial.html", SHEETS)
    page = (out / "pages" / "2_sandstone_triaxial.html").read_text()
    assert re.findall(r'src="([^"]+)"', page) == ["data:image/svg+xml;base64,PHN2Zy8+"]
    assert re.search(r"<figcaption>\s*<p>.*<strong>Units.</strong>.*</figcaption>", page, re.DOTALL)
    assert "<!-- figures" not in page


def test_report_shows_the_figures_of_each_case_with_cracks(
    out, make_cracked_run, data_folder, tmp_path
):
    runs = [make_cracked_run("sandstone_soft_p00"), make_cracked_run("punch_discrete")]
    bands = ROOT / "reports" / "bands.csv"
    for table, inputs in {"cracks": runs, "run_time": [bands, *runs]}.items():
        draw(table, inputs, out / "tables" / f"{table}.csv", data_folder)
    (out / "figures").mkdir()
    for name in ("events_punch_discrete", "fractures_sandstone_soft_p00", "fractures_of_old"):
        (out / "figures" / f"{name}.svg").touch()
    write_report(out, out / "report.md", SHEETS)
    text = (out / "report.md").read_text()
    assert 'src="figures/events_punch_discrete.svg"' in text
    assert 'src="figures/fractures_sandstone_soft_p00.svg"' in text
    assert "fractures_of_old" not in text
    assert "| sandstone_soft_p00 | - | 3 | 3 | 66.67 | 1 | 1 | -60 |" in text


def test_every_sheet_asks_and_answers_the_same_questions():
    for sheet in SHEETS.glob("*.md"):
        text = sheet.read_text()
        for part in ("Question", "Source", "Quantity", "Calibrated", "Predicted"):
            assert f"**{part}." in text, f"{sheet.name}: {part}"
        assert "**Acceptance, fixed beforehand.**" in text
        assert "<!-- table:" in text


def test_name_of_a_sheet_gives_that_sheet(out):
    write_report(out, out / "sheets" / "2_sandstone_triaxial.md", SHEETS)
    text = (out / "sheets" / "2_sandstone_triaxial.md").read_text()
    assert text.startswith("# Sandstone, triaxial compression")
    assert "Plane strain" not in text.splitlines()[0]


def test_page_is_written_when_the_name_ends_in_html(out):
    write_report(out, out / "summary.html", SHEETS)
    page = (out / "summary.html").read_text()
    assert page.startswith("<!DOCTYPE html>")
    assert "<td>sandstone_triaxial_p10</td>" in page


def test_marked_file_is_refreshed_in_place(out, tmp_path):
    readme = tmp_path / "README.md"
    readme.write_text("# Mine\n<!-- table: results -->\nstale row\n<!-- end -->\nkept\n")
    write_report(out, readme, SHEETS)
    text = readme.read_text()
    assert text.startswith("# Mine\n")
    assert text.endswith("<!-- end -->\nkept\n")
    assert "stale row" not in text
    assert "sandstone_triaxial_p10" in text


def test_readme_and_committed_sheets_have_blocks_that_can_be_filled(out, tmp_path):
    for path in [ROOT / "README.md", *SHEETS.glob("*.md")]:
        copy = tmp_path / "copy" / path.name
        copy.parent.mkdir(exist_ok=True)
        copy.write_text(path.read_text())
        write_report(out, copy, SHEETS)
        assert re.search(r" -->\n(\| |Nothing of this kind)", copy.read_text()), path


def test_folder_without_tables_is_refused_and_nothing_is_written(tmp_path):
    with pytest.raises(DataError, match=r"tables: holds no \.csv"):
        write_report(tmp_path, tmp_path / "report.md", SHEETS)
    assert not list(tmp_path.iterdir())


HREF = re.compile(r'<a href="([^"#]*)(?:#([^"]*))?">([^<]*)</a>')


def test_web_pages_link_claims_to_page_and_figure_of_this_run(out):
    """Every link of every page leads to a file that is there, and to a place in it."""
    (out / "figures").mkdir()
    for name in ("punch", "strength", "size_effect"):
        (out / "figures" / f"{name}.svg").write_text("<svg/>")
    pages = [out / "pages" / f"{sheet.stem}.html" for sheet in SHEETS.glob("*.md")]
    for page in [*pages, out / "summary.html"]:
        write_report(out, page, SHEETS)
    claims = (out / "pages" / "0_claims.html").read_text()
    assert '<a href="6_punch.html#punch">punch on page 6</a>' in claims
    assert '<a href="pages/8_hole.html#size_effect">' in (out / "summary.html").read_text()
    assert "<td>fracture_evolution.svg</td>" in claims  # which was not drawn
    for page in [*pages, out / "summary.html"]:
        for target, anchor, _ in HREF.findall(page.read_text()):
            there = page.parent / target
            assert there.exists(), f"{page.name}: {target}"
            assert there.suffix != ".md", f"{page.name}: {target}"
            assert not anchor or f'id="{anchor}"' in there.read_text()
    assert 'href="6_punch.html">' in claims  # a sheet to its neighbour


def test_pictures_of_the_gallery_are_left_out_of_web_pages(out, tmp_path):
    sheets = tmp_path / "reports" / "sheets"
    sheets.mkdir(parents=True)
    (sheets / "6_punch.md").write_text(
        "# Punch\n\n<!-- figures: punch -->\n![punch](../gallery/punch.png)\n\nwords\n"
    )
    for page in ("pages/6_punch.html", "summary.html", "report.md"):
        write_report(out, out / page, sheets)
        text = (out / page).read_text()
        assert "gallery/punch.png" not in text
        assert "words" in text


def test_page_without_neighbours_keeps_the_words_of_its_links():
    """In Snakemake's report a page is an address of its own, from which no other is reached."""
    assert "location.protocol" in to_html("# a")
    assert "link.replaceWith(link.textContent)" in to_html("# a")


def test_figure_that_a_claim_names_is_linked_where_it_is_there(out):
    link = "[punch.svg](figures/punch.svg)"
    write_report(out, out / "report.md", SHEETS)
    assert link not in (out / "report.md").read_text()
    (out / "figures").mkdir()
    (out / "figures" / "punch.svg").touch()
    write_report(out, out / "report.md", SHEETS)
    assert link in (out / "report.md").read_text()
