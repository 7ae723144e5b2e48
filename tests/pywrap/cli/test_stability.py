"""`lithofrac stability`: tables, exit codes, an unknown family."""

import pandas as pd

from lithofrac.cli import main
from lithofrac.stability.judge import COLUMNS


def test_a_family_is_tried_and_its_tables_are_written(tmp_path, capsys):
    assert main(["stability", "--out", str(tmp_path), "--only", "strain_step"]) == 0
    table = pd.read_csv(tmp_path / "stability.csv", keep_default_na=False, na_values=[""])
    assert tuple(table) == COLUMNS
    assert set(table["verdict"]) == {"stable", "refused"}
    pd.testing.assert_frame_equal(
        pd.read_parquet(tmp_path / "stability.parquet")[["family", "verdict", "note"]],
        table[["family", "verdict", "note"]],
    )
    families = pd.read_csv(tmp_path / "stability_families.csv")
    assert families["cells"].sum() == len(table)
    assert not (tmp_path / "stability_limit.csv").exists()
    assert "strain step" in capsys.readouterr().out


def test_an_unknown_family_lists_all(tmp_path, capsys):
    assert main(["stability", "--out", str(tmp_path / "new"), "--only", "denisty"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("lithofrac: --only denisty: no such family, expected one of stiffness,")
    assert not (tmp_path / "new").exists()
