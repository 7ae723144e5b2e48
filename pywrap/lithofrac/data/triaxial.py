"""Triaxial tests of one's own rock, from CSV files.

Two kinds of file, told apart by their columns; compression positive, strains as fractions and
counted from the isotropic state at the confinement:

strengths : `confinement_MPa`, `strength_MPa` (largest major principal stress), one row a test or
    a mean; `strength_min_MPa`, `strength_max_MPa` and `tests` may stand beside them
curves : `confinement_MPa`, `axial_strain`, `axial_stress_MPa` (not the difference from the
    confinement), with `lateral_strain` (extension positive) or `volumetric_strain` (dilation
    positive) where it was measured, and `test`, a name, where two tests share a confinement; one
    row a point, in the order of loading
"""

import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.config.errors import one_line, suggestion
from lithofrac.data.errors import DataError
from lithofrac.errors import FileError
from lithofrac.plain_file import refuse_other

STRENGTHS = ("confinement_MPa", "strength_MPa")
BESIDE_STRENGTHS = ("strength_min_MPa", "strength_max_MPa", "tests")
CURVES = ("confinement_MPa", "axial_strain", "axial_stress_MPa")
BESIDE_CURVES = ("lateral_strain", "volumetric_strain", "test")
OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}
FEWEST_POINTS = 5  # of a curve
MOST_STRESS = 1e6  # MPa
MOST_STRAIN = 0.5  # a curve beyond it is in percent


@dataclass(frozen=True)
class Triaxial:
    """One test, or the mean of several.

    strength_MPa : measured, or the largest stress of the curve
    axial_strain, axial_stress_MPa : (n,) the curve, empty where the strength alone is known
    lateral_strain : (n,), None where it was not measured
    """

    name: str
    confinement_MPa: float
    strength_MPa: float
    axial_strain: np.ndarray
    axial_stress_MPa: np.ndarray
    lateral_strain: np.ndarray | None = None

    @property
    def has_curve(self) -> bool:
        """Whether more than the strength is known."""
        return len(self.axial_strain) > 0


def load_triaxial(paths: list[Path]) -> list[Triaxial]:
    """All tests of some files, by rising confinement.

    Raises
    ------
    DataError
        One sentence on the first thing that is wrong: file, line, column, value, what was expected.
    """
    tests = [test for path in paths for test in _tests_of(Path(path))]
    return sorted(_named_apart(tests), key=lambda test: test.confinement_MPa)


def _tests_of(path: Path) -> list[Triaxial]:
    table = _read(path)
    if "strength_MPa" in table:
        _check_columns(path, table, STRENGTHS, BESIDE_STRENGTHS)
        return _strengths(path, _numbers(path, table))
    _check_columns(path, table, CURVES, BESIDE_CURVES)
    numbers = _numbers(path, table.drop(columns="test", errors="ignore"))
    names = numbers["confinement_MPa"].map("{:g} MPa".format)
    names = table["test"].fillna("") if "test" in table else names
    order = dict.fromkeys(names)
    return [_curve(path, one_line(name), numbers[names == name]) for name in order]


def _read(path: Path) -> pd.DataFrame:
    """Cells as texts; the index is the line of the file less 2."""
    try:
        refuse_other(path, "triaxial tests as CSV")
        with warnings.catch_warnings():  # pandas warns of cells that it leaves out
            warnings.simplefilter("error", pd.errors.ParserWarning)
            table = pd.read_csv(
                path, dtype=str, skip_blank_lines=False, skipinitialspace=True, index_col=False
            )
    except FileError as error:
        raise DataError(str(error)) from None
    except pd.errors.ParserWarning:
        wrong = _other_separator(path) or "has rows of more cells than headings, expected as many"
        raise DataError(f"{path}: {wrong}") from None
    except (ValueError, OverflowError) as error:  # ParserError, EmptyDataError, not UTF-8
        raise DataError(f"{path}: not a CSV file ({one_line(error, 200)})") from None
    if len(table.columns) == 1 and (wrong := _other_separator(path)):
        raise DataError(f"{path}: {wrong}")
    table = table.rename(columns=lambda name: str(name).strip()).dropna(how="all")
    if table.empty:
        raise DataError(f"{path}: holds no rows, expected one a test or one a point of a curve")
    return table


def _other_separator(path: Path) -> str:
    """What is wrong with the headings of a file that spreadsheets of some countries write."""
    with path.open(encoding="utf-8", errors="replace") as file:
        head = file.readline(10_000)
    apart = [words for sign, words in OTHER_SEPARATORS.items() if sign in head]
    if "," in head or not apart:
        return ""
    return f"columns are separated by {apart[0]}, expected commas, and points in numbers"


def _check_columns(path: Path, table: pd.DataFrame, needed: tuple, beside: tuple) -> None:
    for column in needed:
        if column not in table:
            raise DataError(
                f"{path}: column '{column}' is missing, expected {', '.join(STRENGTHS)}"
                f" or {', '.join(CURVES)} at least"
            )
    for column in table:
        if column not in (*needed, *beside):
            near = suggestion(column, [*needed, *beside])
            raise DataError(f"{path}: column '{one_line(column)}': unknown, {near}")
    if {"lateral_strain", "volumetric_strain"} <= set(table):
        raise DataError(
            f"{path}: column 'volumetric_strain': stands beside lateral_strain, expected one"
        )


def _numbers(path: Path, table: pd.DataFrame) -> pd.DataFrame:
    """All cells as numbers within their range."""
    found = table.apply(pd.to_numeric, errors="coerce")
    for column in table:
        low, high = _range(column)
        bad = ~found[column].between(low, high)  # also NaN
        if bad.any():
            line = bad.idxmax()
            shown = "" if pd.isna(table[column][line]) else one_line(table[column][line])
            fraction = " (a fraction, not percent)" if "strain" in column else ""
            raise DataError(
                f"{path}: line {line + 2}, column '{column}': '{shown}', expected"
                f" a number from {low:g} to {high:g}{fraction}"
            )
    return found


def _range(column: str) -> tuple[float, float]:
    if column in ("lateral_strain", "volumetric_strain"):
        return -MOST_STRAIN, MOST_STRAIN
    if column == "axial_stress_MPa":  # a load cell reads about 0, also below
        return -MOST_STRESS, MOST_STRESS
    return 0.0, MOST_STRAIN if column == "axial_strain" else MOST_STRESS


def _strengths(path: Path, table: pd.DataFrame) -> list[Triaxial]:
    nothing = np.zeros(0)
    for line, row in table.iterrows():
        _check_strength(f"{path}: line {line + 2}, column 'strength_MPa'", row)
    pairs = zip(table["confinement_MPa"], table["strength_MPa"], strict=True)
    return [Triaxial(f"{p:g} MPa", p, strength, nothing, nothing) for p, strength in pairs]


def _check_strength(where: str, row) -> None:
    if not row["strength_MPa"] > row["confinement_MPa"]:
        raise DataError(
            f"{where}: {row['strength_MPa']:g}, expected the major principal stress, above the "
            f"confinement of {row['confinement_MPa']:g} MPa"
        )


def _curve(path: Path, name: str, table: pd.DataFrame) -> Triaxial:
    where = f"{path}: test '{name}'"
    if len(table) < FEWEST_POINTS:
        raise DataError(f"{where}: {len(table)} points, expected at least {FEWEST_POINTS}")
    if table["confinement_MPa"].nunique() > 1:
        raise DataError(f"{where}: several confinements, expected one a test")
    falls = table["axial_strain"].diff() <= 0.0
    if falls.any():
        line = falls.idxmax()
        raise DataError(
            f"{path}: line {line + 2}, column 'axial_strain': {table['axial_strain'][line]:g}, "
            f"expected more than in the line before (test '{name}'; a column 'test' parts tests of "
            "one confinement)"
        )
    confinement, stress = table["confinement_MPa"].iloc[0], table["axial_stress_MPa"].to_numpy()
    top = {"strength_MPa": stress.max(), "confinement_MPa": confinement}
    _check_strength(f"{where}, column 'axial_stress_MPa', largest value", top)
    strain = table["axial_strain"].to_numpy()
    lateral = None
    if "lateral_strain" in table:
        lateral = table["lateral_strain"].to_numpy()
    elif "volumetric_strain" in table:
        lateral = 0.5 * (table["volumetric_strain"].to_numpy() + strain)
    return Triaxial(name, float(confinement), float(stress.max()), strain, stress, lateral)


def _named_apart(tests: list[Triaxial]) -> list[Triaxial]:
    """The tests with names of their own: "10 MPa", "10 MPa, 2", ..."""
    seen: dict[str, int] = {}
    apart = []
    for test in tests:
        seen[test.name] = seen.get(test.name, 0) + 1
        count = seen[test.name]
        apart.append(test if count == 1 else replace(test, name=f"{test.name}, {count}"))
    return apart
