"""The claims table: each statement of the paper that a computation can check, with a verdict.

Statements are those of `data/klerck2004/claims.csv`. Their measures and bands are fixed beforehand
in `reports/claims_bands.csv`, which is an input: a verdict never sets its own band.
"""

from pathlib import Path

import pandas as pd

from lithofrac.analysis.claim_parts import CannotCheckError, Check, Source, Value
from lithofrac.analysis.claims_hole import HOLE
from lithofrac.analysis.claims_punch import PUNCH
from lithofrac.analysis.claims_sandstone import SANDSTONE
from lithofrac.analysis.runs import find_runs
from lithofrac.analysis.verdict import FAILS, HOLDS, OPEN, verdict
from lithofrac.data import DataError
from lithofrac.data.csv_file import read_columns

CHECKS: dict[str, Check] = {**PUNCH, **SANDSTONE, **HOLE}
BANDS = "claims_bands"  # stem of the file of bands; all other CSV inputs are tables
BAND_COLUMNS = ("claim", "measure", "quantity", "least", "most", "unit")
STATED_COLUMNS = ("claim", "figure", "statement")
COLUMNS = (
    "claim", "figure", "statement", "quantity", "value", "band", "verdict", "note", "drawn",
)  # fmt: skip


def claims(inputs: list[Path], data: Path) -> pd.DataFrame:
    """All claims of the paper, one row each, as text with units.

    Parameters
    ----------
    inputs : `claims_bands.csv`, `summary.json` of runs, and the tables that claims on holes need
    data : the folder `data/`

    Raises
    ------
    DataError
        When the file of bands is missing, or lacks a claim or a measure that is computed.
    """
    paths = [Path(path) for path in inputs]
    files = {path.stem: path for path in paths if path.suffix == ".csv"}
    if BANDS not in files:
        raise DataError(f"claims: no {BANDS}.csv among the inputs, expected the bands")
    bands = read_columns(
        files.pop(BANDS), BAND_COLUMNS, "bands of the claims", ("least", "most"), empty=True
    )
    runs = find_runs([path for path in paths if path.suffix != ".csv"])
    tables = {
        name: read_columns(path, (), "a table of the pipeline", empty=True)
        for name, path in files.items()
    }
    source = Source({run.name: run for run in runs}, tables, data)
    stated = read_columns(
        data / "klerck2004" / "claims.csv", STATED_COLUMNS, "statements", dtype={"figure": str}
    )
    rows = [
        claim_row(row, bands[bands["claim"] == row.claim], source) for row in stated.itertuples()
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def claim_row(stated, bands: pd.DataFrame, source: Source) -> dict:
    """One claim: computed, held against its bands, and judged.

    Parameters
    ----------
    stated : row of `claims.csv`
    bands : rows of `claims_bands.csv` of this claim, one a measure
    """
    if bands.empty:
        raise DataError(f"{BANDS}.csv: claim '{stated.claim}' is missing, expected its bands")
    check = CHECKS[stated.claim]
    try:
        values = check.measures(source)
    except CannotCheckError as reason:
        values = dict.fromkeys(bands["measure"], Value(float("nan"), str(reason)))
    except FileNotFoundError as error:  # a run that was told to write no fields or no probes
        why = f"no {Path(error.filename).name} of {Path(error.filename).parent.name}"
        values = dict.fromkeys(bands["measure"], Value(float("nan"), why))
    missing = set(values) ^ set(bands["measure"])
    if missing:
        raise DataError(
            f"{BANDS}.csv: claim '{stated.claim}': measure '{sorted(missing)[0]}' has no band or is"
            " not computed"
        )
    verdicts = [judge(values[band.measure].value, band) for band in bands.itertuples()]
    notes = [values[name].note for name in bands["measure"]]
    return {
        "claim": stated.claim,
        "figure": stated.figure,
        "statement": stated.statement,
        "quantity": "; ".join(bands["quantity"]),
        "value": "; ".join(
            _value(values[band.measure].value, band.unit) for band in bands.itertuples()
        ),
        "band": "; ".join(band_words(band) for band in bands.itertuples()),
        "verdict": combined(verdicts),
        "note": "; ".join(dict.fromkeys(note for note in notes if note)),
        "drawn": check.drawn,
    }


def judge(value: float, band) -> str:
    """Verdict on one measure; a blank end of a band is open, a value that is not known as well."""
    if pd.isna(value):
        return OPEN
    low = pd.isna(band.least) or value >= band.least
    high = pd.isna(band.most) or value <= band.most
    return verdict(low and high)


def combined(verdicts: list[str]) -> str:
    """A claim holds when all its measures do, and fails when one of them does."""
    for word in (FAILS, OPEN):
        if word in verdicts:
            return word
    return HOLDS


def band_words(band) -> str:
    """A band as text: from one end to the other, or one end alone."""
    if pd.isna(band.least):
        return f"at most {_value(band.most, band.unit)}"
    if pd.isna(band.most):
        return f"at least {_value(band.least, band.unit)}"
    return f"{band.least:g} to {_value(band.most, band.unit)}"


def _value(value: float, unit: str) -> str:
    if pd.isna(value):
        return "-"
    shown = {"1": "", "degrees": "°"}.get(str(unit), f" {unit}")
    return f"{value:.4g}{shown}" if abs(value) >= 1e-3 or value == 0.0 else f"{value:.1e}{shown}"
