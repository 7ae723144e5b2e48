"""What is committed and read first: README.md and the sheets are whole and filled."""

import re
from pathlib import Path
from urllib.parse import unquote

import pandas as pd
import pytest

from lithofrac.report import load_sheets
from lithofrac.report.blocks import BLOCK

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]
SHEETS = sorted((ROOT / "reports" / "sheets").glob("*.md"))
PAGES = [ROOT / "README.md", *SHEETS]
GUIDE = [ROOT / "CONTRIBUTING.md", *sorted((ROOT / "reports" / "guide").glob("*.md"))]
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
COLUMNS = "energy_residual,kinetic_ratio_at_peak,kinetic_ratio_before_peak,kinetic_verdict"
FILL = "fill it: snakemake --cores all pages"


def links(page):
    """Local targets of links and pictures of a page: path and anchor."""
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        if not re.match(r"[a-z]+:", target):
            path, _, anchor = unquote(target).partition("#")
            yield target, (page.parent / path if path else page), anchor


def anchors(page):
    """Anchors that a Markdown page has, as forges make them of its headings."""
    headings = re.findall(r"^#+ +(.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", [*PAGES, *GUIDE], ids=lambda page: page.stem)
def test_links_and_pictures_of_a_page_are_there(page):
    for target, path, anchor in links(page):
        assert path.exists(), f"{page.name}: {target}"
        assert not anchor or anchor in anchors(path), f"{page.name}: {target}"


def test_committed_sheets_show_the_pictures_of_the_gallery_that_stand_on_them():
    pictures = [path.stem for path in (ROOT / "reports" / "gallery").glob("*.png")]
    for sheet in load_sheets(ROOT / "reports" / "sheets"):
        shown = re.findall(r"^!\[(\w+)\]\(\.\./gallery/\1\.png\)$", sheet.text, re.MULTILINE)
        assert shown == sheet.figures(pictures), f"{sheet.name}: {FILL}"


def test_every_claim_of_the_committed_table_has_a_link_to_its_figure():
    text = (ROOT / "reports" / "sheets" / "0_claims.md").read_text(encoding="utf-8")
    rows = [block for block in BLOCK.finditer(text) if block["name"] == "claims"]
    cells = [line.split(" | ")[-1] for block in rows for line in block[0].splitlines()[3:-1]]
    assert len(cells) == 50
    for cell in cells:
        assert re.fullmatch(r"\[\w+\.svg\]\(\.\./gallery/\w+\.png\) \|", cell), f"{cell}: {FILL}"


def test_every_run_stands_in_a_table_of_run_times_of_a_sheet():
    """With its ledger and its kinetic energy; the full suite, as the gallery holds it."""
    table = pd.read_csv(ROOT / "reports" / "gallery" / "tables" / "run_time.csv")
    listed = set()
    for sheet in load_sheets(ROOT / "reports" / "sheets"):
        for block in BLOCK.finditer(sheet.text):
            if block["name"] == "run_time":
                assert block["options"].endswith(COLUMNS)
                listed |= {line.split(" | ")[0][2:] for line in block[0].splitlines()[3:-1]}
    assert listed == set(table["case"])
    assert len(listed) > 100


def test_readme_has_links_to_check():
    assert len(list(links(ROOT / "README.md"))) > 5


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_table_of_a_page_is_filled(page):
    """With a header, a rule and at least one row; a suite that ran has left nothing out."""
    text = page.read_text(encoding="utf-8")
    blocks = list(BLOCK.finditer(text))
    assert len(blocks) == text.count("<!-- table:") > 0
    for block in blocks:
        inside = block[0].removeprefix(block["head"]).removesuffix(block["tail"])
        rows = [line for line in inside.splitlines() if line.startswith("| ")]
        assert len(rows) > 2, f"{page.name}: table {block['name']} is empty, {FILL}"
