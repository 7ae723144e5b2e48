"""Axes of the figures (pywrap/lithofrac/data/axes.py) and tables of commas (csv_file.py)."""

import pytest

from lithofrac.data import DataError, measured_strength
from lithofrac.data.axes import FACTORS, load_axes

pytestmark = pytest.mark.no_core

HEAD = "figure,axis,quantity,unit,printed_min,printed_max\n"
GOOD = HEAD + "9,x,strain,1,,\n9,y,stress,MPa,0,300\n"


def refusal(path) -> str:
    with pytest.raises(DataError) as caught:
        load_axes(path)
    return str(caught.value).removeprefix(f"{path}: ")


def test_the_axes_of_the_paper_are_right(data_folder):
    axes = load_axes(data_folder / "klerck2004" / "figure_axes.csv")
    assert (axes["15"]["y"].unit, axes["15"]["y"].printed_max) == ("MPa", 24.0)
    assert axes["9"]["x"].printed_min is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not a CSV file (No columns to parse from file)"),
        (HEAD, "has no rows, expected the axes of the figures"),
        (
            "figure,axis\n9,x\n",
            "column 'quantity' is missing, expected figure, axis, quantity, unit, printed_min, "
            "printed_max at least",
        ),
        (GOOD.replace("9,x", "9,z"), "line 2: axis 'z', expected x or y"),
        (
            GOOD.replace(",1,", ",mile,"),
            f"line 2: unit 'mile', expected one of {', '.join(FACTORS)}",
        ),
        (GOOD.replace("300", "many"), "line 3: 'many', expected a finite number or nothing"),
        (GOOD.replace("300", "1e400"), "line 3: '1e400', expected a finite number or nothing"),
        (HEAD + "9,x,strain,1,,\n", "figure '9' has one axis, expected x and y"),
        (
            HEAD + "9,x,strain,1,,,,\n9,y,stress,MPa,0,300,,\n",
            "has rows of more cells than headings, expected the axes of the figures",
        ),
    ],
    ids=["empty", "no_rows", "column", "axis", "unit", "word", "infinite", "one_axis", "cells"],
)
def test_wrong_axes_are_refused(tmp_path, text, message):
    path = tmp_path / "figure_axes.csv"
    path.write_text(text)
    assert refusal(path) == message


def test_other_bytes_and_other_kinds_of_file_are_refused(tmp_path):
    path = tmp_path / "figure_axes.csv"
    assert refusal(path) == "no such file, expected the axes of the figures"
    path.mkdir()
    assert refusal(path) == "is no regular file, expected the axes of the figures"
    path.rmdir()
    path.write_bytes(b"figure,axis\n\xff\xfe,x\n")
    assert refusal(path).startswith("not a CSV file (")


def test_measured_values_of_other_bytes_are_refused(tmp_path):
    (tmp_path / "rock").mkdir()
    path = tmp_path / "rock" / "triaxial_strength.csv"
    path.write_bytes(b"confinement_MPa,strength_MPa\n\xff,1\n")
    with pytest.raises(DataError, match="not a CSV file"):
        measured_strength(tmp_path, "rock")
