"""Read a CSV file with named columns, or say in one sentence why not."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from lithofrac.data.errors import DataError

MOST_BYTES = 10_000_000  # tables of stated values have some thousands


def read_columns(path: Path, columns: Sequence[str], what: str, **options) -> pd.DataFrame:
    """Table of a CSV file.

    Parameters
    ----------
    columns : that it must have at least
    what : it holds, for messages
    options : for `pandas.read_csv`

    Raises
    ------
    DataError
        When there is no such file, it is no CSV file, or it lacks a column or any row.
    """
    if not path.exists():
        raise DataError(f"{path}: no such file, expected {what}")
    if not path.is_file() or path.stat().st_size > MOST_BYTES:
        raise DataError(f"{path}: no file of at most {MOST_BYTES} bytes, expected {what}")
    try:
        table = pd.read_csv(path, **options)
    except (ValueError, OverflowError) as error:  # ParserError, EmptyDataError, not UTF-8
        raise DataError(f"{path}: not a CSV file ({' '.join(str(error).split())[:200]})") from None
    if not isinstance(table.index, pd.RangeIndex):
        raise DataError(f"{path}: has rows of more cells than headings, expected {what}")
    for column in columns:
        if column not in table:
            raise DataError(
                f"{path}: column '{column}' is missing, expected {', '.join(columns)} at least"
            )
    if table.empty:
        raise DataError(f"{path}: has no rows, expected {what}")
    return table
