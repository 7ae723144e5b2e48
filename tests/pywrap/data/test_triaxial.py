"""Triaxial tests of one's own rock from CSV files (data/triaxial.py)."""

import numpy as np
import pytest

from lithofrac.data import DataError
from lithofrac.data.triaxial import load_triaxial

pytestmark = pytest.mark.no_core
CURVE = "confinement_MPa,axial_strain,axial_stress_MPa,lateral_strain\n"
ROWS = "".join(f"5,{0.001 * i:g},{5 + 20 * i:g},{0.0002 * i:g}\n" for i in range(6))


@pytest.fixture
def written(tmp_path):
    """written(text, name) -> path of a CSV."""

    def made(text, name="tests.csv"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return made


def test_the_data_files_of_the_repository_are_read(data_folder):
    zigong = load_triaxial([data_folder / "zigong" / "triaxial_strength.csv"])
    assert [test.strength_MPa for test in zigong][:2] == [182.9, 235.3]
    assert not any(test.has_curve for test in zigong)
    assert len(load_triaxial([data_folder / "tautona" / "triaxial_strength.csv"])) == 5


def test_strengths_and_curves_come_together_by_rising_confinement(written):
    strengths = written("confinement_MPa,strength_MPa\n20,300\n0,80\n0,90\n\n", "peaks.csv")
    tests = load_triaxial([strengths, written(CURVE + ROWS)])
    assert [test.name for test in tests] == ["0 MPa", "0 MPa, 2", "5 MPa", "20 MPa"]
    curve = tests[2]
    assert curve.strength_MPa == 105.0
    np.testing.assert_allclose(curve.axial_strain, 0.001 * np.arange(6))
    np.testing.assert_allclose(curve.lateral_strain, 0.0002 * np.arange(6))


def test_a_volumetric_strain_gives_the_lateral_one(written):
    """Dilation positive: volume = 2 lateral - axial."""
    head = CURVE.replace("lateral", "volumetric")
    rows = "".join(f"5,{0.001 * i:g},{5 + 20 * i:g},{-0.0004 * i:g}\n" for i in range(6))
    test = load_triaxial([written(head + rows)])[0]
    np.testing.assert_allclose(test.lateral_strain, 0.0003 * np.arange(6), atol=1e-15)


def test_a_column_of_names_parts_tests_of_one_confinement(written):
    rows = "".join(f"{row},{name}\n" for name in "ab" for row in ROWS.splitlines())
    tests = load_triaxial([written(CURVE.replace("\n", ",test\n") + rows)])
    assert [(test.name, test.confinement_MPa) for test in tests] == [("a", 5.0), ("b", 5.0)]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not a CSV file (No columns to parse from file)"),
        (
            "confinement_MPa,strength_MPa\n1,2,3\n",
            "has rows of more cells than headings, expected as many",
        ),
        (
            "confinement_MPa;strength_MPa\n0;62,1\n20;167\n",
            "columns are separated by semicolons, expected commas, and points in numbers",
        ),
        (
            "confinement_MPa;strength_MPa\n0;62.1\n20;167\n",
            "columns are separated by semicolons, expected commas, and points in numbers",
        ),
        ("confinement_MPa\tstrength_MPa\n0\t62.1\n", "columns are separated by tabs, expected"),
        (
            f"confinement_MPa,strength_MPa\n1,{'9' * 400}x\n",
            f"line 2, column 'strength_MPa': '{'9' * 57}...', expected a number from 0 to 1e+06",
        ),
        ("confinement_MPa,strength_MPa\n", "holds no rows, expected one a test or"),
        ("confinement,strength_MPa\n1,2\n", "column 'confinement_MPa' is missing, expected"),
        ("confinement_MPa,axial_strain\n1,2\n", "column 'axial_stress_MPa' is missing, expected"),
        (
            "confinement_MPa,strength_MPa,lateral_strian\n1,2,3\n",
            "column 'lateral_strian': unknown, expected one of: confinement_MPa, strength_MPa",
        ),
        (
            CURVE.replace("lateral", "latral") + ROWS,
            "column 'latral_strain': unknown, did you mean 'lateral_strain'?",
        ),
        (
            "confinement_MPa,strength_MPa\n1,2\n2,\n",
            "line 3, column 'strength_MPa': '', expected a number from 0 to 1e+06",
        ),
        (
            "confinement_MPa,strength_MPa\n-1,20\n",
            "line 2, column 'confinement_MPa': '-1', expected a number from 0 to 1e+06",
        ),
        (
            "confinement_MPa,strength_MPa\n10,50\n20,15\n",
            "line 3, column 'strength_MPa': 15, expected the major principal stress, above the "
            "confinement of 20 MPa",
        ),
        (
            CURVE + ROWS.replace("0.003", "0.3").replace("0.004", "0.6"),
            "line 6, column 'axial_strain': '0.6', expected a number from 0 to 0.5 (a fraction, "
            "not percent)",
        ),
        (
            CURVE + ROWS + ROWS,
            "line 8, column 'axial_strain': 0, expected more than in the line before (test '5 MPa'",
        ),
        (
            CURVE + "".join(ROWS.splitlines(keepends=True)[:2]),
            "test '5 MPa': 2 points, expected at least 5",
        ),
        (
            "volumetric_strain," + CURVE + "".join(f"0,{row}\n" for row in ROWS.splitlines()),
            "column 'volumetric_strain': stands beside lateral_strain, expected one",
        ),
    ],
)
def test_a_wrong_file_gets_one_sentence(written, text, message):
    path = written(text)
    with pytest.raises(DataError) as refused:
        load_triaxial([path])
    assert str(refused.value).startswith(f"{path}: {message}")
    assert "\n" not in str(refused.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(DataError, match=r"lost\.csv: no such file, expected triaxial tests as CSV"):
        load_triaxial([tmp_path / "lost.csv"])
