"""Marked blocks in Markdown files (report/blocks.py)."""

import pandas as pd
import pytest

from lithofrac.data import DataError
from lithofrac.report.blocks import fill, has_blocks

pytestmark = pytest.mark.no_core
TABLES = {
    "strength": pd.DataFrame(
        {
            "case": ["soft_p00", "soft_p10", "stiff_p00"],
            "test": ["soft", "soft", "stiff"],
            "strength_MPa": [100.16, 186.94, 113.5],
        }
    )
}
HEAD = "| case | test | strength [MPa] |\n| --- | --- | --- |\n"


def block(options="", inside=""):
    return f"before\n<!-- table: strength{options} -->\n{inside}<!-- end -->\nafter\n"


def test_table_fills_its_block_and_nothing_else_changes():
    text = fill(block(), TABLES, "a.md")
    assert text.startswith("before\n<!-- table: strength -->\n" + HEAD)
    assert text.endswith("| stiff_p00 | stiff | 113.5 |\n<!-- end -->\nafter\n")


def test_filling_twice_changes_nothing():
    once = fill(block(inside="old\n"), TABLES, "a.md")
    assert fill(once, TABLES, "a.md") == once


def test_rows_and_columns_are_chosen():
    text = fill(block(" test=soft columns=case,strength_MPa"), TABLES, "a.md")
    assert "| soft_p10 | 186.9 |\n" in text
    assert "stiff_p00" not in text


def test_star_stands_for_anything():
    text = fill(block(" case=*_p00"), TABLES, "a.md")
    assert ("soft_p00" in text, "stiff_p00" in text, "soft_p10" in text) == (True, True, False)


def test_rows_are_chosen_of_a_table_that_has_none():
    tables = {"strength": TABLES["strength"].iloc[:0]}
    text = fill(block(" test=soft columns=case,strength_MPa"), tables, "a.md")
    assert "Nothing of this kind was run." in text


def test_block_may_keep_what_it_has_where_there_is_no_table():
    text = "<!-- table: speed else=keep columns=x -->\nold\n<!-- end -->\n"
    assert fill(text, TABLES, "a.md") == text
    filled = fill(text, {"speed": pd.DataFrame({"x": [1.5], "y": [2.5]})}, "a.md")
    assert "| 1.5 |\n<!-- end -->" in filled and "old" not in filled


def test_two_blocks_do_not_swallow_the_text_between_them():
    text = fill(block() + block(), TABLES, "a.md")
    assert text.count("after") == 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<!-- table: speed -->\n<!-- end -->", "a.md: table: 'speed', expected one of strength"),
        (block(" tset=soft"), "a.md: table strength: 'tset', expected one of its columns case,"),
        (block(" columns=case,x"), "a.md: table strength: 'x', expected one of its columns case,"),
    ],
)
def test_unknown_table_or_column_is_refused(text, words):
    with pytest.raises(DataError) as caught:
        fill(text, TABLES, "a.md")
    assert str(caught.value).startswith(words)


def test_text_without_blocks_has_none():
    assert not has_blocks("# Title\n")
    assert has_blocks(block())
