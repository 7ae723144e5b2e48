"""`lithofrac accuracy`: a tiny sweep, its tables, an unknown problem."""

import pandas as pd

from lithofrac.accuracy.sweep import COLUMNS
from lithofrac.cli import main


def test_a_problem_is_swept_and_its_tables_are_written(tmp_path, capsys):
    assert main(["accuracy", "--out", str(tmp_path), "--only", "bar_wave"]) == 0
    table = pd.read_csv(tmp_path / "accuracy.csv")
    assert tuple(table) == COLUMNS
    assert set(table["problem"]) == {"bar_wave"}
    assert (table["error_percent"] > 0.0).all()
    assert (table["elements"] > 0).all()
    assert (table["core_seconds"] > 0.0).all()
    summary = pd.read_csv(tmp_path / "accuracy_summary.csv").iloc[0]
    assert 1.8 < summary["order_in_size"] < 2.2
    assert summary["default_error_percent"] < 0.2
    assert (tmp_path / "accuracy.parquet").exists()
    assert "bar_wave, element_size_mm = 2.5" in capsys.readouterr().out


def test_an_unknown_problem_lists_all(tmp_path, capsys):
    assert main(["accuracy", "--out", str(tmp_path / "new"), "--only", "kirch"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("lithofrac: --only kirch: no such problem, expected one of material_po")
    assert not (tmp_path / "new").exists()
