"""The committed pictures (report/gallery.py)."""

import re
from pathlib import Path

import pandas as pd
import pytest

from lithofrac.data import DataError
from lithofrac.report import write_gallery
from lithofrac.report.gallery import LARGEST

pytestmark = pytest.mark.no_core
ROOT = Path(__file__).parents[3]
CAPTIONS = ROOT / "reports" / "captions"
GALLERY = ROOT / "reports" / "gallery"


@pytest.fixture
def out(tmp_path):
    """Folder of a pipeline: two runs on one machine, and a picture."""
    (tmp_path / "out" / "tables").mkdir(parents=True)
    ends = ["2026-01-02 10:00 UTC", "2026-01-02 10:20 UTC"]
    pd.DataFrame(
        {"case": ["a", "b"], "version": "0.1.0", "commit": "0123456789ab", "native": True,
         "machine": "Linux, x86_64, 2 cores", "finished": ends}
    ).to_csv(tmp_path / "out" / "tables" / "run_time.csv", index=False)  # fmt: skip
    (tmp_path / "out" / "punch.png").write_bytes(b"picture")
    return tmp_path / "out"


def test_gallery_shows_its_pictures_with_captions_and_what_made_them(out, tmp_path):
    folder = tmp_path / "gallery"
    folder.mkdir()
    (folder / "old.png").touch()
    write_gallery(out, [out / "punch.png"], folder, CAPTIONS)
    assert sorted(path.name for path in folder.iterdir()) == ["README.md", "punch.png", "tables"]
    text = (folder / "README.md").read_text()
    assert 'src="punch.png"' in text
    assert "Stress under the strip punch" in text
    assert (
        "2 runs of version 0.1.0, commit 0123456789ab, on Linux, x86_64, 2 cores (native build:"
        " true), 2026-01-02 10:00 UTC to 2026-01-02 10:20 UTC." in text
    )


def test_tables_of_the_run_are_copied_and_linked_and_those_of_an_older_one_go(out, tmp_path):
    folder = tmp_path / "gallery"
    (folder / "tables").mkdir(parents=True)
    (folder / "tables" / "old.csv").touch()
    write_gallery(out, [], folder, CAPTIONS)
    assert [path.name for path in (folder / "tables").iterdir()] == ["run_time.csv"]
    copied = (folder / "tables" / "run_time.csv").read_bytes()
    assert copied == (out / "tables" / "run_time.csv").read_bytes()
    assert "Tables: [run_time](tables/run_time.csv)." in (folder / "README.md").read_text()


@pytest.mark.parametrize(
    ("name", "size", "words"),
    [
        ("strength.png", LARGEST + 1, "expected at most"),
        ("strength.svg", 1, "expected a .png"),
        ("absent.png", None, "no such picture"),
    ],
)
def test_picture_that_does_not_fit_is_refused_and_the_old_ones_stay(
    out, tmp_path, name, size, words
):
    folder = tmp_path / "gallery"
    folder.mkdir()
    (folder / "old.png").touch()
    if size:
        (out / name).write_bytes(bytes(size))
    with pytest.raises(DataError, match=words):
        write_gallery(out, [out / "punch.png", out / name], folder, CAPTIONS)
    assert [path.name for path in folder.iterdir()] == ["old.png"]


def test_committed_gallery_is_whole_and_small():
    text = (GALLERY / "README.md").read_text(encoding="utf-8")
    pictures = list(GALLERY.glob("*.png"))
    assert len(pictures) > 3
    assert text.count("<img ") == len(pictures)
    for path in pictures:
        assert f'src="{path.name}"' in text
        assert path.stat().st_size <= LARGEST
    assert "runs of version" in text


def test_committed_gallery_has_its_tables_and_every_figure_that_compares():
    text = (GALLERY / "README.md").read_text(encoding="utf-8")
    tables = sorted((GALLERY / "tables").glob("*.csv"))
    assert {"claims", "results", "run_time", "hole_checks"} <= {path.stem for path in tables}
    for path in tables:
        assert f"({path.relative_to(GALLERY)})" in text
    pictures = {path.stem for path in GALLERY.glob("*.png")}
    compared = re.findall(r'compared == "(\w+)"', (CAPTIONS / "compared.rst").read_text())
    assert pictures >= {*compared, "stress_strain", "strength", "sandstone"}
