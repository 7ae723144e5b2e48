"""Read a CSV file with named columns, or say in one sentence why not."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from lithofrac.config.errors import one_line
from lithofrac.data.errors import DataError
from lithofrac.errors import FileError
from lithofrac.plain_file import refuse_other


def read_columns(
    path: Path,
    columns: Sequence[str],
    what: str,
    numbers: Sequence[str] = (),
    empty: bool = False,
    **options,
) -> pd.DataFrame:
    """Table of a CSV file.

    Parameters
    ----------
    columns : that it must have at least
    what : it holds, for messages
    numbers : those columns whose cells are numbers, or empty
    empty : whether a table without rows is right, and a file without a heading where no column is
        asked for
    options : for `pandas.read_csv`

    Raises
    ------
    DataError
        When there is no such file, it is no CSV file, or it lacks a column or any row.
    """
    path = Path(path)
    try:
        refuse_other(path, what)
        table = pd.read_csv(path, **options)
    except FileError as error:
        raise DataError(str(error)) from None
    except pd.errors.EmptyDataError as error:
        if not empty or columns:
            raise DataError(f"{path}: not a CSV file ({error})") from None
        return pd.DataFrame()
    except (ValueError, OverflowError) as error:  # ParserError, not UTF-8
        raise DataError(f"{path}: not a CSV file ({one_line(error, 200)})") from None
    if not isinstance(table.index, pd.RangeIndex):
        raise DataError(f"{path}: has rows of more cells than headings, expected {what}")
    for column in columns:
        if column not in table:
            raise DataError(
                f"{path}: column '{column}' is missing, expected {', '.join(columns)} at least"
            )
    if table.empty and not empty:
        raise DataError(f"{path}: has no rows, expected {what}")
    for column in numbers:
        table[column] = _numbers(path, table[column], what)
    return table


def _numbers(path: Path, cells: pd.Series, what: str) -> pd.Series:
    """The cells of a column as numbers, NaN where they are empty."""
    values = pd.to_numeric(cells, errors="coerce")
    bad = values.isna() & cells.notna()
    if bad.any():
        row = int(bad.to_numpy().argmax())
        raise DataError(
            f"{path}: line {row + 2}, column '{cells.name}': '{one_line(cells.iloc[row])}', "
            f"expected a number of {what}"
        )
    return values


def read_bands(path: Path) -> pd.Series:
    """Bands by their quantity, of a file like `reports/bands.csv`; raises as `read_columns`."""
    table = read_columns(path, ("quantity", "band"), "bands", ("band",))
    return table.set_index("quantity")["band"]
