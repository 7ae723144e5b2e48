"""Tables as Markdown, Markdown as a page (report/markdown.py)."""

import pandas as pd
import pytest

from lithofrac.report.markdown import header, to_html, to_markdown

pytestmark = pytest.mark.no_core


@pytest.mark.parametrize(
    ("column", "shown"),
    [
        ("strength_min_MPa", "strength min [MPa]"),
        ("rms_percent", "rms [%]"),
        ("case", "case"),
        ("cracks", "crack events"),
        ("energy_residual", "energy residual"),
        ("crack_energy_at_1_mm_J_m2", "crack energy at 1 mm [J/m²]"),
    ],
)
def test_unit_of_a_column_stands_in_brackets(column, shown):
    assert header(column) == shown


def test_numbers_have_four_digits_and_gaps_a_dash():
    table = pd.DataFrame({"a": [186.9443, 2.5e-9, float("nan")], "b": ["x|y", None, "z"]})
    lines = to_markdown(table).splitlines()
    assert lines[2:] == ["| 186.9 | x\\|y |", "| 2.50e-09 | - |", "| - | z |"]


def test_empty_table_says_so():
    assert to_markdown(pd.DataFrame()) == "Nothing of this kind was run.\n"


def test_page_holds_the_table_and_the_title():
    page = to_html("# Sheet\n\n| a |\n| --- |\n| 1 |\n")
    assert "<title>Sheet</title>" in page
    assert "<td>1</td>" in page
