"""Results that are damaged, or are not those of a run (pywrap/lithofrac/analysis/reading.py)."""

import json
from itertools import product
from pathlib import Path

import pandas as pd
import pytest

from lithofrac.cli import main

pytestmark = pytest.mark.no_core

BROKEN = {"empty": b"", "cut": b"PAR1" + bytes(20), "foreign": b"time_s,kinetic_J\n0,0\n"}


@pytest.fixture
def said(tmp_path, capsys):
    """said(*words): what a command says of damaged results; it writes nothing."""

    def attempt(*words):
        before = sorted(tmp_path.rglob("*"))
        assert main([*map(str, words)]) == 2
        assert sorted(tmp_path.rglob("*")) == before
        out, err = capsys.readouterr()
        assert out == ""
        return err

    return attempt


@pytest.mark.parametrize("content", BROKEN.values(), ids=BROKEN)
@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("energy", "energy.parquet"),
        ("curves", "energy.parquet"),
        ("curves", "history.parquet"),
        ("stress_strain", "history.parquet"),
        ("events", "cracks.parquet"),
        ("fractures", "cracks.parquet"),
        ("gauges", "probes.parquet"),
    ],
)
def test_a_table_that_is_none(make_cracked_run, said, tmp_path, kind, name, content):
    folder = make_cracked_run("a")
    (folder / name).write_bytes(content)
    assert said("plot", kind, folder, "--out", tmp_path / "a.svg") == (
        f"lithofrac: {folder / name}: {len(content)} bytes that are no Parquet table, expected one "
        "of a run\n"
    )


@pytest.mark.parametrize(
    ("kind", "name", "column"),
    [
        ("energy", "energy.parquet", "kinetic_J"),
        ("stress_strain", "history.parquet", "axial_strain"),
        ("events", "cracks.parquet", "x1_mm"),
        ("gauges", "probes.parquet", "plastic_strain"),
    ],
)
def test_a_table_of_something_else(make_cracked_run, said, tmp_path, kind, name, column):
    folder, out = make_cracked_run("a"), tmp_path / "a.svg"
    table = pd.DataFrame({"time_s": [0.0, 1.0]})
    table.to_parquet(folder / name)
    assert said("plot", kind, folder, "--out", out) == (
        f"lithofrac: {folder / name}: has no column {column!r}, expected a table of a run\n"
    )
    table.assign(**{column: ["much", "little"]}).to_parquet(folder / name)
    assert said("plot", kind, folder, "--out", out) == (
        f"lithofrac: {folder / name}: column {column!r} holds no numbers, expected a run\n"
    )


def test_a_folder_in_the_place_of_a_table(make_cracked_run, said, tmp_path):
    path = make_cracked_run("a") / "energy.parquet"
    path.unlink()
    path.mkdir()
    assert said("plot", "energy", path.parent, "--out", tmp_path / "a.svg") == (
        f"lithofrac: {path}: is no regular file, expected a Parquet table\n"
    )


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("fields.pvd", "", "expected a list of fields (no element found: line 1, column 0)"),
        ("fields.pvd", "<VTKFile/>", "names no fields, expected those of a run"),
        ("fields.pvd", '<a><DataSet part="0"/></a>', "expected a list of fields ('timestep')"),
        ("fields/frame_0000.vtu", "", "0 bytes that are no fields of a run in VTU"),
        ("fields/frame_0000.vtu", "<a/>", "4 bytes that are no fields of a run in VTU"),
    ],
)  # fmt: skip
def test_fields_that_are_none(make_cracked_run, said, tmp_path, name, content, message):
    folder = make_cracked_run("a")
    (folder / name).write_text(content)
    assert said("plot", "pattern", folder, "--out", tmp_path / "a.svg") == (
        f"lithofrac: {folder / name}: {message}\n"
    )


SUMMARIES = {
    "{": "expected the summary of a run in JSON (Expecting property name enclosed in double quotes:"
    " line 1 column 2 (char 1))",
    "[" * 100_000: "expected the summary of a run in JSON (nested too deeply)",
    "[1]": "expected a JSON object, the summary of a run",
    '{"status": 3}': "status = 3: expected a text",
    '{"status": "completed", "notes": "none"}': "notes = none: expected a list of texts",
    '{"status": "completed", "energy": 4.0}': "energy = 4.0: expected a mapping of numbers",
    '{"status": "completed", "energy": {"kinetic_J": "x"}}': "energy.kinetic_J = x: expected a "
    "number",
}


@pytest.mark.parametrize("command", ["show", "compare"])
@pytest.mark.parametrize(
    ("text", "message"), SUMMARIES.items(), ids=[text[:30] for text in SUMMARIES]
)
def test_a_summary_that_is_none(make_run, said, command, text, message):
    path = make_run("a") / "summary.json"
    path.write_text(text)
    assert said(command, path.parent) == f"lithofrac: {path}: {message}\n"


def test_a_summary_that_lacks_what_is_asked_for(make_run, said):
    path = make_run("a") / "summary.json"
    path.write_text(json.dumps({"status": "completed"}))
    assert said("compare", path.parent) == (
        f"lithofrac: {path}: key 'energy' is missing, expected the summary of a run\n"
    )


@pytest.mark.parametrize("content", [b"a,b\n1,2,3\n1,2\n", b"a\n\xff\n", b'a\n"'])
def test_a_report_of_tables_that_are_none(said, tmp_path, content):
    path = tmp_path / "out" / "tables" / "results.csv"
    path.parent.mkdir(parents=True)
    path.write_bytes(content)
    words = said("report", tmp_path / "out", "--out", tmp_path / "report.md")
    assert words.startswith(f"lithofrac: {path}: ")
    assert words.count("\n") == 1


def test_a_report_into_a_page_of_other_bytes(said, tmp_path):
    table, page = tmp_path / "out" / "tables" / "results.csv", tmp_path / "page.md"
    table.parent.mkdir(parents=True)
    table.write_text("a\n1\n")
    page.write_bytes(b"\xff")
    assert said("report", tmp_path / "out", "--out", page) == (
        f"lithofrac: {page}: byte 0 is not UTF-8, expected a page in UTF-8 to refresh\n"
    )


@pytest.mark.parametrize(
    ("name", "content"),
    [
        *product(("numbers", "meshes", "updates"), (b"", b"a,b\n1,2\n1,2,3\n", b"\xff", "heading")),
        ("numbers", "cells"),
    ],
)
def test_references_that_are_none(make_run, said, tmp_path, name, content):
    folder = tmp_path / "references"
    folder.mkdir()
    for path in Path("tests/references").glob("*.csv"):
        (folder / path.name).write_bytes(path.read_bytes())
    path = folder / f"{name}.csv"
    lines = path.read_text().splitlines()
    if isinstance(content, str):
        cells = ",".join(["x"] * len(lines[0].split(",")))
        content = "\n".join(lines[:1] + [cells] * (content == "cells")).encode()
    path.write_bytes(content)
    words = said("compare", make_run("a"), "--references", folder)
    assert words.startswith(f"lithofrac: {path}: ")
    assert words.count("\n") == 1


def test_a_comparison_with_a_damaged_table(make_run, said):
    path = make_run("a") / "history.parquet"
    summary = json.loads((path.parent / "summary.json").read_text())
    (path.parent / "summary.json").write_text(json.dumps({**summary, "energy": {}}))
    path.write_bytes(b"PAR1")
    assert said("compare", path.parent) == (
        f"lithofrac: {path}: 4 bytes that are no Parquet table, expected one of a run\n"
    )
