"""Intake of digitised curves: what is taken, and what is refused in which words."""

import numpy as np
import pytest

from lithofrac.data import DataError, load_curves

pytestmark = pytest.mark.no_core
POINTS = [(0.1, 20.0), (0.2, 41.5), (0.4, 120.0)]
FIGURE_15 = {"figure": "15", "x": {"unit": "microstrain"}, "y": {"unit": "MPa"}}


def refusal(data):
    with pytest.raises(DataError) as caught:
        load_curves(data, "9")
    message = str(caught.value)
    assert "\n" not in message
    return message


def test_curve_comes_in_the_units_of_its_figure(digitise):
    (curve,) = load_curves(digitise(POINTS), "9")
    np.testing.assert_allclose(curve.x, [0.001, 0.002, 0.004])
    np.testing.assert_allclose(curve.y, [20.0, 41.5, 120.0])
    assert (curve.x_error, curve.y_error) == (pytest.approx(1e-4), 2.0)
    assert curve.sheet.series == "triaxial, 10 MPa"


def test_curves_are_found_by_figure(digitise):
    assert load_curves(digitise(POINTS), "10") == []


def test_number_stands_for_the_name_of_a_figure(digitise):
    assert len(load_curves(digitise(POINTS, figure=9), "9")) == 1


def test_no_folder_means_no_curves(tmp_path):
    assert load_curves(tmp_path, "9") == []


def test_printed_range_is_taken_from_the_paper_where_it_is_known(digitise):
    assert len(load_curves(digitise([(-5000.0, 12.0)], **FIGURE_15), "15")) == 1


def test_empty_lines_at_the_end_are_no_points(digitise):
    assert load_curves(digitise("0.1, 20\n0.2,30\n\n"), "9")[0].x.size == 2


def test_committed_intake_is_in_order(data_folder):
    for figure in ("6a", "6b", "9", "10", "15", "16a", "16b", "16c"):
        assert isinstance(load_curves(data_folder, figure), list)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ("0.1; 20", "a.csv: line 1: '0.1; 20', expected two numbers parted by a comma"),
        ("0.1, 20\nx, y", "a.csv: line 2: 'x, y', expected two numbers parted by a comma"),
        ("0.1, 20, 3", "a.csv: line 1: '0.1, 20, 3', expected two numbers parted by a comma"),
        ("0.1, nan", "a.csv: line 1: '0.1, nan', expected finite numbers"),
        ("", "a.csv: holds no points, expected two numbers a line"),
        ("0.1, 301", "a.csv: y value 301 MPa, expected 0 to 300 MPa, the printed axis of"
         " axial_stress"),
        ("-0.1, 1", "a.csv: x value -0.001 1, expected 0 to 0.02 1, the printed axis of"
         " axial_strain"),
    ],
)  # fmt: skip
def test_bad_points_are_refused(digitise, points, words):
    assert refusal(digitise(points)).endswith(words)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"figure": "12"}, "a.yaml: figure: '12', expected one of 10, 15, 16a, 16b, 16c, 6a, 6b,"
         " 9"),
        ({"y": {"unit": "psi", "printed_min": 0, "printed_max": 1}},
         "a.yaml: y.unit: 'psi', expected one of Pa, kPa, MPa, GPa (axial_stress)"),
        ({"x": {"unit": "percent"}}, "a.yaml: x.printed_min: missing key, expected the end of the"
         " printed axis, which figure_axes.csv does not know for this figure"),
        ({**FIGURE_15, "y": {"unit": "MPa", "printed_max": 20}}, "a.yaml: y.printed_max: 20 MPa,"
         " expected 24 MPa, the printed axis in figure_axes.csv"),
        ({"x": {"unit": "percent", "printed_min": 2, "printed_max": 1}},
         "a.yaml: x.printed_max: 0.01 1, expected more than x.printed_min, 0.02 1"),
    ],
)  # fmt: skip
def test_sheet_that_does_not_fit_its_figure_is_refused(digitise, changes, words):
    assert refusal(digitise(POINTS, **changes)).endswith(words)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"digitised_by": None}, "a.yaml: digitised_by"),
        ({"origin": "guess"}, "a.yaml: origin"),
        ({"uncertainty": {"x": -1.0, "y": 1.0}}, "a.yaml: uncertainty.x"),
        ({"serie": "typo"}, "a.yaml: serie"),
    ],
)
def test_sheet_with_a_wrong_key_is_refused_by_file_and_key(digitise, changes, words):
    assert words in refusal(digitise(POINTS, **changes))


def test_empty_sheet_is_refused(digitise):
    assert "a.yaml: file is empty" in refusal(digitise(POINTS, sheet=""))


def test_csv_without_a_sheet_is_refused(digitise):
    data = digitise(POINTS)
    (data / "klerck2004" / "digitised" / "lost.csv").write_text("1, 2")
    assert refusal(data).endswith(
        "lost.csv: has no lost.yaml beside it, expected one that says what it is"
    )


def test_sheet_without_a_csv_is_refused(digitise):
    data = digitise(POINTS)
    (data / "klerck2004" / "digitised" / "a.csv").unlink()
    assert refusal(data).endswith("a.csv: no such file, expected the points of the curve")


def test_bad_file_of_another_figure_is_found_at_once(digitise):
    data = digitise("nonsense", name="b", **FIGURE_15)
    assert "b.csv" in refusal(data)
