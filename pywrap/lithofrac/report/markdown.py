"""Tables as Markdown, Markdown as a web page."""

import numpy as np
import pandas as pd
from markdown_it import MarkdownIt

from lithofrac.results.columns import WORDS

UNITS = {
    "MPa": "MPa",
    "mm": "mm",
    "percent": "%",
    "deg": "°",
    "seconds": "s",
    "J": "J",
    "J_m2": "J/m²",
    "MJ_m3": "MJ/m³",
}  # end of a column name -> unit shown in brackets

PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>
body {{ font: 15px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }}
table {{ border-collapse: collapse; margin: 1em 0; font-size: 13px; }}
th, td {{ border: 1px solid #ccc; padding: 0.25em 0.6em; text-align: left; }}
th {{ background: #f2f2f2; }}
figure {{ margin: 1.5em 0; border-top: 1px solid #ccc; }}
figure img {{ max-width: 100%; height: auto; }}
figcaption {{ font-size: 13px; color: #444; }}
</style></head><body>
{body}{script}</body></html>
"""

# A page inside Snakemake's report has no folder: what links to its neighbours keeps its words.
SCRIPT = """<script>
if (!/^(file|https?):$/.test(location.protocol)) {
  const links = document.querySelectorAll('a:not([href^="#"]):not([href*=":"])');
  for (const link of links) link.replaceWith(link.textContent);
}
</script>
"""


def to_markdown(table: pd.DataFrame) -> str:
    """A table with readable headers and four significant digits."""
    if table.empty:
        return "Nothing of this kind was run.\n"
    head = [header(str(name)) for name in table]
    lines = [_row(head), _row(["---"] * len(head))]
    lines += [_row([_cell(value) for value in row]) for row in table.itertuples(index=False)]
    return "\n".join(lines) + "\n"


def to_html(text: str) -> str:
    """A page of its own from Markdown; links and pictures stay as they are."""
    title = next((line.lstrip("# ") for line in text.splitlines() if line.startswith("#")), "")
    body = MarkdownIt("commonmark").enable("table").render(text)
    return PAGE.format(title=title, body=body, script=SCRIPT)


def header(column: str) -> str:
    """`strength_min_MPa` becomes `strength min [MPa]`."""
    for end, unit in UNITS.items():
        if column.endswith(f"_{end}"):
            return f"{column.removesuffix(f'_{end}').replace('_', ' ')} [{unit}]"
    return WORDS.get(column, column.replace("_", " "))


def _row(cells: list[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _cell(value) -> str:
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return "-"
    if isinstance(value, float | np.floating):
        if value != 0.0 and not 1e-3 <= abs(value) < 1e6:
            return f"{value:.2e}"
        return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"
    return str(value)
