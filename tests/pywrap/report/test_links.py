"""Links from where a text is written (report/links.py)."""

from pathlib import Path

import pytest

from lithofrac.report.links import moved, to_files, to_pages

pytestmark = pytest.mark.no_core
SHEETS, OUT = Path("reports", "sheets"), Path("out")


@pytest.mark.parametrize(
    ("link", "in_report", "on_page"),
    [
        ("(6_punch.md)", "(../reports/sheets/6_punch.md)", "(6_punch.html)"),
        ("(6_punch.md#a)", "(../reports/sheets/6_punch.md#a)", "(6_punch.html#a)"),
        ("(../a/b.csv)", "(../reports/a/b.csv)", "(../../reports/a/b.csv)"),
        ("(../guide/a.md)", "(../reports/guide/a.md)", "(../../reports/guide/a.md)"),
        ("(https://a.org/b.md)", "(https://a.org/b.md)", "(https://a.org/b.md)"),
        ("(#here)", "(#here)", "(#here)"),
    ],
)
def test_links_of_a_sheet_lead_to_the_same_from_elsewhere(link, in_report, on_page):
    assert moved(f"see [words]{link}, (6_punch.md)", SHEETS, OUT, None) == (
        f"see [words]{in_report}, (6_punch.md)"
    )
    assert moved(f"[words]{link}", SHEETS, OUT / "pages", OUT / "pages") == f"[words]{on_page}"


def test_figure_of_another_format_is_linked_and_one_that_is_not_there_stays_a_name(tmp_path):
    (tmp_path / "gallery").mkdir()
    (tmp_path / "gallery" / "punch.png").touch()
    link = to_files(tmp_path / "gallery", tmp_path / "sheets")
    assert link("punch.svg") == "[punch.svg](../gallery/punch.png)"
    assert link("other.svg") == "other.svg"


def test_figure_is_linked_to_its_place_on_the_first_page_that_shows_it(tmp_path):
    for folder in ("sheets", "out/figures"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "sheets" / "2_a.md").write_text("# A\n<!-- figures: x -->\n")
    (tmp_path / "sheets" / "3_b.md").write_text("# B\n<!-- figures: x y -->\n")
    for name in ("x.svg", "y.png", "z.svg"):
        (tmp_path / "out" / "figures" / name).touch()
    link = to_pages(tmp_path / "out", tmp_path / "sheets", tmp_path / "out" / "pages")
    assert link("x.svg") == "[x on page 2](2_a.html#x)"
    assert link("y.svg") == "[y on page 3](3_b.html#y)"
    assert link("z.svg") == "z.svg"
    assert link("absent.svg") == "absent.svg"
