"""What `lithofrac plot KIND INPUT... --out FILE` does: a figure, or its numbers as CSV."""

from collections.abc import Callable
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from lithofrac.analysis import (
    discrete,
    hole_checks,
    hole_tables,
    options,
    results,
    size_law,
    tables,
)
from lithofrac.analysis.claims import claims
from lithofrac.analysis.punch import punch as punch_table
from lithofrac.analysis.variants import variants as variants_table
from lithofrac.data import DataError
from lithofrac.plots import (
    energy,
    events,
    evolution,
    fractures,
    gallery,
    hole,
    measured,
    mesh,
    punch,
    punch_patterns,
    sandstone,
    single_element,
    size_effect,
    stability,
    stiffness,
    style,
    variants,
)

FIGURES: dict[str, Callable[[list[Path], Path], Figure]] = {
    "single_element": single_element.figure,
    "stress_strain": sandstone.stress_strain,
    "strength": sandstone.strength,
    "stiffness_sweep": stiffness.figure,
    "measured": measured.figure,
    "mesh": mesh.figure,
    "energy": energy.figure,
    "gallery": gallery.figure,
    "fractures": fractures.figure,
    "fracture_series": fractures.series,
    "fracture_evolution": evolution.figure,
    "events": events.figure,
    "punch": punch.figure,
    "hole_gauges": hole.gauges,
    "hole_patterns": hole.patterns,
    "size_effect": size_effect.figure,
    "punch_patterns": punch_patterns.figure,
    "variants": variants.figure,
    "stability": stability.figure,
}
TABLES: dict[str, Callable[[list[Path], Path], pd.DataFrame]] = {
    "single_element": tables.single_element,
    "options": options.options,
    "strength": tables.strength,
    "errors": tables.errors,
    "tautona": tables.tautona,
    "zigong": tables.zigong,
    "zigong_fit": tables.zigong_fit,
    "kirsch": tables.kirsch,
    "run_time": tables.run_time,
    "cracks": discrete.cracks,
    "bands": discrete.bands,
    "punch": punch_table,
    "hole_initiation": hole_tables.hole_initiation,
    "size_effect": hole_tables.size_effect,
    "hole_fits": size_law.hole_fits,
    "hole_checks": hole_checks.hole_checks,
    "variants": variants_table,
    "results": results.verdicts,
    "claims": claims,
}
FORMATS = (".svg", ".png", ".pdf")


def draw(kind: str, inputs: list[Path], out: Path, data: Path | None = None) -> None:
    """Draw a figure, or write a table when `out` ends in `.csv`.

    Parameters
    ----------
    kind : a key of `FIGURES` or `TABLES`
    inputs : results folders or files in them, bench curves, or a material; what the kind needs
    out : file to write, .svg, .png, .pdf or .csv
    data : the folder `data/`, by default that of the working folder

    Raises
    ------
    DataError
        When the kind or format is unknown, an input is missing, or a data file is wrong.
    """
    data = Path("data") if data is None else data
    known = TABLES if out.suffix == ".csv" else FIGURES
    if out.suffix not in (*FORMATS, ".csv"):
        raise DataError(
            f"{out}: format {out.suffix!r}, expected one of {', '.join((*FORMATS, '.csv'))}"
        )
    if kind not in known:
        what, suffixes, other = "figure", ".csv", TABLES
        if known is TABLES:
            what, suffixes, other = "table", "/".join(FORMATS), FIGURES
        raise DataError(
            f"plot: no {what} {kind!r}, expected one of {', '.join(known)}; "
            f"with --out *{suffixes}: {', '.join(other)}"
        )
    missing = [str(path) for path in inputs if not Path(path).exists()]
    if missing:
        raise DataError(f"{missing[0]}: no such file or folder, expected an input of the plot")
    if known is FIGURES and not inputs:
        raise DataError(f"plot {kind}: no input, expected results folders or files to draw")
    try:
        made = known[kind](inputs, data)
    except FileNotFoundError as error:  # an input that lies in no results folder
        raise DataError(
            f"plot {kind}: {error.filename or error}: no such file, expected an input in a results "
            "folder of `lithofrac run`"
        ) from None
    if known is FIGURES:
        style.save(made, out)
        return
    out.parent.mkdir(parents=True, exist_ok=True)
    part = out.with_name(f".{out.name}.part")
    made.to_csv(part, index=False)
    part.replace(out)
