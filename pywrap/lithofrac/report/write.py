"""What `lithofrac report OUT_DIR --out FILE` does."""

import datetime
import os
import platform
from pathlib import Path

import pandas as pd

from lithofrac.data import DataError
from lithofrac.report.blocks import fill, has_blocks
from lithofrac.report.markdown import to_html, to_markdown

SHEETS = Path("reports", "sheets")
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
FIGURES = {
    "stress_strain.svg": "Axial stress against axial strain of sandstone, compare Fig. 9",
    "strength.svg": "Strength of sandstone against confinement, compare Fig. 10",
    "stiffness_sweep.svg": "Sandstone in plane strain at several lateral stiffnesses",
    "measured.svg": "Table 1 beside TauTona quartzite, a fitted line beside Zigong sandstone",
    "sandstone.png": "Where the specimens failed: plastic strain at the end",
    "punch.svg": "Stress under the strip punch against axial strain, compare Fig. 6",
    "punch_patterns.svg": "What forms beneath the strip punch, compare Fig. 7",
    "fracture_evolution.svg": "Cracks in sandstone in plane strain as they grow, compare Fig. 11a",
    "fracture_series.svg": "Cracks in sandstone blocks under soft pressure, compare Fig. 11",
    "variants.svg": "What the open choices change: stress-strain curves beside their twins",
    "hole_patterns.svg": "Cracks about a hole right after initiation, compare Fig. 14",
    "hole_gauges.svg": "Axial stress against strain of gauges about a hole, compare Fig. 15",
    "size_effect.svg": "Initiation stress against hole radius, compare Fig. 16",
}
CRACKS = {
    "fractures": "cracks on the deformed mesh, by mode and by time",
    "events": "stress, and when each crack opened",
    "energy": "where the energy went",
}  # figures of each case with discrete cracks, in order


def write_report(out_dir: Path, file: Path, sheets: Path = SHEETS) -> None:
    """Write Markdown, or a web page when `file` ends in `.html`.

    A file that is there and has marked blocks (README.md, a sheet) gets its tables refreshed in
    place and keeps the rest. Otherwise a file named like a sheet becomes that sheet, filled, and
    any other name becomes the whole report: results, all sheets, costs.

    Parameters
    ----------
    out_dir : folder of the pipeline; tables are read from `tables/` in it
    file : what to write; written whole or not at all
    sheets : folder of the V&V sheets

    Raises
    ------
    DataError
        When there are no tables, or a block asks for one that is not there.
    """
    tables = read_tables(out_dir)
    old = file.read_text(encoding="utf-8") if file.is_file() else ""
    sheet = sheets / f"{file.stem}.md"
    committed = linked(tables, sheets.parent / GALLERY, file.parent)
    if has_blocks(old) and file.suffix == ".md" and not file.is_relative_to(out_dir):
        text = fill(old, committed, str(file))
    elif sheet.is_file():
        text = fill(sheet.read_text(encoding="utf-8"), committed, str(sheet))
    else:
        pictures = out_dir / "figures" if file.suffix == ".md" else None
        text = whole_report(tables, sheets, pictures, file.parent)
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
        try:
            tables[path.stem] = pd.read_csv(path, keep_default_na=False, na_values=[""])
        except pd.errors.EmptyDataError:
            tables[path.stem] = pd.DataFrame()
    return tables


def whole_report(
    tables: dict[str, pd.DataFrame], sheets: Path, pictures: Path | None, here: Path
) -> str:
    """Provenance and results first, then figures, every sheet, and costs.

    Figures are linked from the folder `pictures` relative to `here`; a page that is embedded
    elsewhere has none.
    """
    if pictures is not None:
        tables = linked(tables, pictures, here)
    parts = ["# lithofrac: report of the suite\n", provenance(tables)]
    shown = [name for name in TITLES if name in tables]
    for name in shown:
        if name == "run_time":
            for path in sorted(sheets.glob("*.md")):
                text = fill(path.read_text(encoding="utf-8"), tables, str(path))
                parts.append(text.replace("\n## ", "\n### ").replace("# ", "## ", 1))
        parts.append(f"## {TITLES[name]}\n\n{to_markdown(tables[name])}")
        if name == "results" and pictures is not None:
            parts += [
                f"![{alt}]({os.path.relpath(pictures / name, here)})\n\n*{alt}*\n"
                for name, alt in {**FIGURES, **_crack_figures(tables)}.items()
                if (pictures / name).is_file()
            ]
    return "\n".join(parts)


def linked(tables: dict[str, pd.DataFrame], pictures: Path, here: Path) -> dict[str, pd.DataFrame]:
    """The tables with links, relative to `here`, for the figures they name that are there."""

    def link(name: str) -> str:
        picture = pictures / str(name)
        return f"[{name}]({os.path.relpath(picture, here)})" if picture.is_file() else name

    return {
        key: table.assign(**{DRAWN: table[DRAWN].map(link)}) if DRAWN in table else table
        for key, table in tables.items()
    }


def _crack_figures(tables: dict[str, pd.DataFrame]) -> dict[str, str]:
    """File -> words, for every case with discrete cracks."""
    cases = tables["cracks"]["case"] if "cracks" in tables else ()
    return {
        f"{kind}_{case}.svg": f"{case}: {alt}" for case in cases for kind, alt in CRACKS.items()
    }


def provenance(tables: dict[str, pd.DataFrame]) -> str:
    """What made the numbers: version, commit and machine."""
    runs = tables.get("run_time", pd.DataFrame())
    known = {
        name: ", ".join(runs[name].dropna().astype(str).unique()) if name in runs else ""
        for name in ("version", "commit")
    }
    return (
        f"Version {known['version'] or 'unknown'}, commit {known['commit'] or 'unknown'}; written"
        f" {datetime.date.today()} on {platform.system()} {platform.machine()},"
        f" {os.cpu_count()} cores.\n"
    )
