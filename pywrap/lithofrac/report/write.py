"""What `lithofrac report OUT_DIR --out FILE` does."""

import base64
import os
from collections.abc import Callable
from pathlib import Path

import pandas as pd

from lithofrac.data import DataError
from lithofrac.data.csv_file import read_columns
from lithofrac.plain_file import text_of
from lithofrac.report.blocks import fill, has_blocks
from lithofrac.report.captions import caption, is_of_a_run
from lithofrac.report.links import moved, to_files, to_pages
from lithofrac.report.markdown import to_html, to_markdown
from lithofrac.report.sheets import pictured, place

SHEETS = Path("reports", "sheets")
ORIGIN = ("version", "commit", "native", "machine", "finished")  # of run_time
GALLERY = "gallery"  # beside the sheets: the figures that are committed
DRAWN = "drawn"  # column that names a figure
TITLES = {
    "results": "Results",
    "cracks": "Discrete cracks: what opened and what it cost",
    "bands": "Angles of bands and cracks to the load axis",
    "variants": "What the open choices change",
    "errors": "Distance from digitised curves",
    "run_time": "Run time and energy error",
}  # tables of the whole report, in order; the others stand in the sheets
PICTURE = (
    '<figure id="{name}"><img alt="{name}" src="{source}">\n'
    "<figcaption>\n{caption}\n</figcaption></figure>\n"
)  # no blank line: Markdown would end the HTML there
TYPES = {".svg": "image/svg+xml", ".png": "image/png"}


def write_report(out_dir: Path, file: Path, sheets: Path = SHEETS) -> None:
    """Write Markdown, or a web page when `file` ends in `.html`.

    A file that is there and has marked blocks (README.md, a sheet) gets its tables refreshed in
    place, and the pictures of the gallery where it names them; the rest is kept. Otherwise a file
    named like a sheet becomes that sheet, filled, with its figures; a web page holds them in
    itself. Any other name becomes the whole report: results, all sheets, costs; as a web page it is
    part of Snakemake's, which has the figures.

    Parameters
    ----------
    out_dir : folder of the pipeline; tables are read from `tables/` in it
    file : what to write; written whole or not at all
    sheets : folder of the V&V sheets; the captions of the figures lie beside it

    Raises
    ------
    DataError
        When there are no tables, or a block asks for one that is not there.
    """
    tables, captions = read_tables(out_dir), sheets.parent / "captions"
    old = text_of(file, "a page in UTF-8 to refresh") if file.is_file() else ""
    here, html, sheet = file.parent, file.suffix == ".html", sheets / f"{file.stem}.md"
    if has_blocks(old) and not html and not file.is_relative_to(out_dir):
        pictures = sheets.parent / GALLERY
        text = fill(old, linked(tables, to_files(pictures, here)), str(file))
        names = [path.stem for path in pictures.glob("*.png")]
        text = pictured(text, names, os.path.relpath(pictures, here))
    else:
        pages = out_dir / "pages" if html else None
        link = to_pages(out_dir, sheets, here) if html else to_files(out_dir / "figures", here)
        known = linked(tables, link)
        if sheet.is_file():
            text = moved(sheet.read_text(encoding="utf-8"), sheets, here, pages)
            text = fill(text, known, str(sheet))
        else:
            text = whole_report(known, sheets, here, pages)
        if html and not sheet.is_file():
            text = place(text, [], str)  # Snakemake's report has the figures
        else:
            text = with_figures(text, tables, out_dir, None if html else here, captions)
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(f".{file.name}.part")
    part.write_text(to_html(text) if file.suffix == ".html" else text, encoding="utf-8")
    part.replace(file)


def read_tables(out_dir: Path) -> dict[str, pd.DataFrame]:
    """Tables of a pipeline's folder by name."""
    paths = sorted((out_dir / "tables").glob("*.csv"))
    if not paths:
        raise DataError(f"{out_dir / 'tables'}: holds no .csv, expected tables of a finished suite")
    tables = {}
    for path in paths:
        tables[path.stem] = read_columns(
            path, (), "a table of a finished suite", empty=True,
            keep_default_na=False, na_values=[""],
        )  # fmt: skip
    return tables


def whole_report(
    tables: dict[str, pd.DataFrame], sheets: Path, here: Path, pages: Path | None
) -> str:
    """Provenance and results first, then every sheet, and costs; links as of `links.moved`."""
    parts = ["# lithofrac: report of the suite\n", provenance(tables)]
    for name in [name for name in TITLES if name in tables]:
        if name == "run_time":
            for path in sorted(sheets.glob("*.md")):
                text = moved(path.read_text(encoding="utf-8"), sheets, here, pages)
                text = fill(text, tables, str(path))
                parts.append(text.replace("\n## ", "\n### ").replace("# ", "## ", 1))
        shown = tables[name].drop(columns=list(ORIGIN), errors="ignore")
        parts.append(f"## {TITLES[name]}\n\n{to_markdown(shown)}")
    return "\n".join(parts)


def with_figures(
    text: str, tables: dict[str, pd.DataFrame], out_dir: Path, here: Path | None, captions: Path
) -> str:
    """A text with the figures that its comments name, each with its caption.

    Figures are linked relative to the folder `here`, or embedded where there is none. What an older
    suite has left in the folder is not shown.
    """
    runs = tables.get("run_time", pd.DataFrame())
    cases = set(runs["case"]) if "case" in runs else set()
    files = {path.stem: path for path in (out_dir / "figures").glob("*.*") if path.suffix in TYPES}

    def show(name: str) -> str:
        source = os.path.relpath(files[name], here) if here else embedded(files[name])
        return PICTURE.format(name=name, source=source, caption=caption(name, captions, out_dir))

    return place(text, [name for name in files if is_of_a_run(name, captions, cases)], show)


def embedded(path: Path) -> str:
    """A picture as an address that holds the picture itself."""
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f"data:{TYPES[path.suffix]};base64,{data}"


def linked(tables: dict[str, pd.DataFrame], link: Callable[[str], str]) -> dict[str, pd.DataFrame]:
    """The tables with `link(name)` for the figures they name."""
    return {
        key: table.assign(**{DRAWN: table[DRAWN].map(link)}) if DRAWN in table else table
        for key, table in tables.items()
    }


def provenance(tables: dict[str, pd.DataFrame]) -> str:
    """What made the numbers: version, commit and machine of the runs, and when they ended."""
    runs = tables.get("run_time", pd.DataFrame())
    known = {name: [] for name in ORIGIN}
    for name in known:
        if name in runs:
            known[name] = sorted(runs[name].dropna().astype(str).unique())
    said = {name: ", ".join(values) or "unknown" for name, values in known.items()}
    ends = known["finished"]
    when = f"{ends[0]} to {ends[-1]}" if ends else "at an unknown time"
    return (
        f"{len(runs)} runs of version {said['version']}, commit {said['commit']}, on"
        f" {said['machine']} (native build: {said['native'].lower()}), {when}.\n"
    )
