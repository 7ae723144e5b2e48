"""Inputs of `plot` and `report` that make no sense (pywrap/lithofrac/cli.py, plots/draw.py)."""

import pytest

from lithofrac.cli import main

pytestmark = pytest.mark.no_core


def test_an_unknown_kind_lists_all(tmp_path, capsys):
    assert main(["plot", "foo", "x", "--out", str(tmp_path / "a.svg")]) == 2
    said = capsys.readouterr().err
    assert said.startswith("lithofrac: plot: no figure 'foo', expected one of single_element, ")
    assert "energy" in said and "kirsch" in said


def test_an_input_that_is_no_result_gets_a_reason(tmp_path, capsys):
    page = tmp_path / "report.md"
    page.write_text("words")
    assert main(["plot", "energy", str(page), "--out", str(tmp_path / "a.svg")]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"lithofrac: plot energy: {tmp_path}/")
    assert "no such file, expected an input in a results folder of `lithofrac run`" in said
    assert list(tmp_path.iterdir()) == [page]


def test_a_report_of_another_format_is_refused(tmp_path, capsys):
    out = tmp_path / "report.pdf"
    assert main(["report", str(tmp_path), "--out", str(out)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --out {out}: expected a file that ends in .md or .html\n"
    )
