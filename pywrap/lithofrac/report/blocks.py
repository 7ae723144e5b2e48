"""Marked blocks of a Markdown file that hold a table made by the pipeline.

    <!-- table: strength test=triaxial columns=case,strength_MPa -->
    anything here is replaced
    <!-- end -->

The name is that of a table, `KEY=VALUE` keeps the rows in which that column has that value (`*`
stands for anything), and `columns` keeps columns. With `else=keep` a table that was not made leaves
its block as it is. Text outside the blocks is never touched.
"""

import re
from fnmatch import fnmatchcase

import numpy as np
import pandas as pd

from lithofrac.data import DataError
from lithofrac.report.markdown import to_markdown

BLOCK = re.compile(
    r"(?P<head><!-- table: (?P<name>\w+)(?P<options>( \w+=\S+)*) -->\n).*?(?P<tail><!-- end -->)",
    re.DOTALL,
)
KEEP = "else=keep"  # of a table that the suite does not make


def has_blocks(text: str) -> bool:
    """Whether a text has at least one block."""
    return BLOCK.search(text) is not None


def fill(text: str, tables: dict[str, pd.DataFrame], file: str) -> str:
    """Put the tables into their blocks; `file` is named in messages.

    Raises
    ------
    DataError
        When a block asks for a table or column that is not there.
    """

    def filled(block: re.Match) -> str:
        name = block["name"]
        if name not in tables and KEEP in block["options"].split():
            return block[0]
        if name not in tables:
            known = ", ".join(sorted(tables)) or "none, because nothing was run"
            raise DataError(f"{file}: table: {name!r}, expected one of {known}")
        return block["head"] + to_markdown(_chosen(block, tables[name], file)) + block["tail"]

    return BLOCK.sub(filled, text)


def _chosen(block: re.Match, table: pd.DataFrame, file: str) -> pd.DataFrame:
    """Rows and columns that a block asks for."""
    columns = list(table)
    for option in block["options"].split():
        if option == KEEP:
            continue
        key, value = option.split("=", 1)
        asked = value.split(",") if key == "columns" else [key]
        missing = [name for name in asked if name not in table]
        if missing:
            raise DataError(
                f"{file}: table {block['name']}: {missing[0]!r}, expected one of its columns"
                f" {', '.join(table)}"
            )
        if key == "columns":
            columns = asked
        else:
            kept = [fnmatchcase(str(cell), value) for cell in table[key]]
            table = table[np.array(kept, dtype=bool)]  # a list of no rows would choose columns
    return table[columns]
