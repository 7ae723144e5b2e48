"""The committed gallery: pictures and tables of the last full run, and what made them."""

import shutil
from pathlib import Path

from lithofrac.data import DataError
from lithofrac.report.captions import caption
from lithofrac.report.write import PICTURE, provenance, read_tables

LARGEST = 400_000  # bytes of a picture; all of them are fetched with the repository
HEAD = """# Gallery

Pictures and tables of the last full run, made by `snakemake --cores all pages` as all of this
folder; nothing here is written by hand.

{provenance}
Tables: {tables}.
"""
TABLES = "tables"  # in the gallery, as in the folder of the pipeline


def write_gallery(out_dir: Path, pictures: list[Path], folder: Path, captions: Path) -> None:
    """Replace pictures and tables of a folder, and the page that shows them with their origin.

    Parameters
    ----------
    out_dir : folder of the pipeline, whose tables are copied; they say what made the runs
    pictures : .png files, named as the figures whose captions they have
    folder : the gallery; other pictures and tables in it are removed
    captions : folder of the captions

    Raises
    ------
    DataError
        When a picture is no .png, is missing or too large, or has no caption; then nothing is
        written.
    """
    tables = sorted((out_dir / TABLES).glob("*.csv"))
    links = ", ".join(f"[{path.stem}]({TABLES}/{path.name})" for path in tables)
    parts = [HEAD.format(provenance=provenance(read_tables(out_dir)), tables=links)]
    for path in pictures:
        if path.suffix != ".png" or not path.is_file():
            raise DataError(f"{path}: no such picture, expected a .png file")
        if path.stat().st_size > LARGEST:
            raise DataError(f"{path}: {path.stat().st_size} bytes, expected at most {LARGEST}")
        words = caption(path.stem, captions, out_dir)
        parts.append(PICTURE.format(name=path.stem, source=path.name, caption=words))
    (folder / TABLES).mkdir(parents=True, exist_ok=True)
    for old in [*folder.glob("*.png"), *(folder / TABLES).glob("*.csv")]:
        old.unlink()
    for path in pictures:
        shutil.copyfile(path, folder / path.name)
    for path in tables:
        shutil.copyfile(path, folder / TABLES / path.name)
    (folder / "README.md").write_text("\n".join(parts), encoding="utf-8")
