"""Links of the report: to figures, and from sheet to sheet."""

import os
import re
from collections.abc import Callable
from pathlib import Path

from lithofrac.report.sheets import load_sheets

TARGET = re.compile(r"(?<=\]\()(?![a-z]+:|#)(?P<path>[^)\s#]+)(?P<anchor>#[^)\s]*)?(?=\))")


def to_files(folder: Path, here: Path) -> Callable[[str], str]:
    """What makes a link, relative to `here`, of the name of a figure that is in a folder.

    The picture there may be a .png of a figure named as .svg; a figure that is not there stays a
    name.
    """

    def link(name: str) -> str:
        drawn = [folder / str(name), (folder / str(name)).with_suffix(".png")]
        there = next((path for path in drawn if path.is_file()), None)
        return f"[{name}]({os.path.relpath(there, here)})" if there else name

    return link


def to_pages(out_dir: Path, sheets: Path, here: Path) -> Callable[[str], str]:
    """What makes a link of the name of a figure to its place on the page that shows it.

    The words of the link name figure and page: inside Snakemake's report a page has no neighbours,
    and the words are what is left (`markdown.PAGE`).
    """
    known = load_sheets(sheets)

    def link(name: str) -> str:
        figure = Path(str(name)).stem
        if not any((out_dir / "figures").glob(f"{figure}.*")):
            return name
        page = next((sheet for sheet in known if sheet.figures([figure])), None)
        if page is None:
            return name
        target = os.path.relpath(out_dir / "pages" / f"{page.name}.html", here)
        return f"[{figure} on page {page.name.split('_')[0]}]({target}#{figure})"

    return link


def moved(text: str, folder: Path, here: Path, pages: Path | None) -> str:
    """Markdown of a folder with its relative links made good for a file in the folder `here`.

    Parameters
    ----------
    text : a sheet
    folder : in which it lies
    here : where the text is written
    pages : folder of the web pages; where it is given, links to sheets go to their pages there
    """

    def target(link: re.Match) -> str:
        path = folder / link["path"]
        if pages and path.suffix == ".md" and path.parent.resolve() == folder.resolve():
            path = pages / f"{path.stem}.html"
        return os.path.relpath(path, here) + (link["anchor"] or "")

    return TARGET.sub(target, text)
