"""What `lithofrac plot KIND INPUT... --out FILE` does: a figure, its numbers, or a GIF."""

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
    speed,
    tables,
)
from lithofrac.analysis.claims import claims
from lithofrac.analysis.punch import punch as punch_table
from lithofrac.analysis.study import study_table
from lithofrac.analysis.variants import variants as variants_table
from lithofrac.analysis.zigong_prediction import zigong_prediction, zigong_prediction_error
from lithofrac.config.errors import one_line
from lithofrac.data import DataError
from lithofrac.plots import (
    accuracy,
    animation,
    curves,
    energy,
    events,
    evolution,
    fractures,
    gallery,
    gauges,
    hole,
    measured,
    mesh,
    needs,
    pattern,
    punch,
    punch_patterns,
    sandstone,
    single_element,
    size_effect,
    stability,
    stiffness,
    study,
    style,
    variants,
)
from lithofrac.plots import speed as speed_figure
from lithofrac.results.files import write_table, write_whole

FIGURES: dict[str, Callable[[list[Path], Path], Figure]] = {
    "single_element": single_element.figure,
    "stress_strain": sandstone.stress_strain,
    "strength": sandstone.strength,
    "stiffness_sweep": stiffness.figure,
    "measured": measured.figure,
    "mesh": mesh.figure,
    "curves": curves.figure,
    "pattern": pattern.figure,
    "gauges": gauges.figure,
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
    "accuracy": accuracy.figure,
    "study": study.figure,
    "speed": speed_figure.figure,
}
TABLES: dict[str, Callable[[list[Path], Path], pd.DataFrame]] = {
    "single_element": tables.single_element,
    "options": options.options,
    "strength": tables.strength,
    "errors": tables.errors,
    "tautona": tables.tautona,
    "zigong": tables.zigong,
    "zigong_fit": tables.zigong_fit,
    "zigong_prediction": zigong_prediction,
    "zigong_prediction_error": zigong_prediction_error,
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
    "study": study_table,
    "speed_rows": speed.speed_rows,
    "speed_targets": speed.speed_targets,
}
MOVIES: dict[str, Callable[[list[Path], Path, Path], None]] = {"animation": animation.write}
FORMATS = (".svg", ".png", ".pdf")
NUMBERS = (".csv", ".parquet")


def draw(kind: str, inputs: list[Path], out: Path, data: Path | None = None) -> None:
    """Draw a figure, write a table when `out` ends in `.csv` or `.parquet`, an animation in `.gif`.

    Parameters
    ----------
    kind : a key of `FIGURES`, `TABLES` or `MOVIES`
    inputs : results folders or files in them, bench curves, or a material; what the kind needs
    out : file to write, .svg, .png, .pdf, .csv, .parquet or .gif
    data : the folder `data/`, by default that of the working folder

    Raises
    ------
    DataError
        When the kind or format is unknown, an input is missing, or a data file is wrong.
    """
    data = Path("data") if data is None else data
    known = _known(kind, out)
    needs.check(kind, inputs, known is TABLES)
    try:
        made = known[kind](inputs, data, out) if known is MOVIES else known[kind](inputs, data)
    except FileNotFoundError as error:  # an input that lies in no results folder
        raise DataError(
            f"plot {kind}: {error.filename or error}: no such file, expected an input in a results "
            "folder of `lithofrac run`"
        ) from None
    except KeyError as error:  # a column or key of tables that are read as they are
        wanted = needs.of(kind, known is TABLES).words
        raise DataError(
            f"plot {kind}: the inputs lack {one_line(error.args[0])!r}, expected {wanted}"
        ) from error
    if known is FIGURES:
        style.save(made, out)
    if known is not TABLES:
        return
    out.parent.mkdir(parents=True, exist_ok=True)
    if out.suffix == ".parquet":
        write_table(out, made)
    else:
        write_whole(out, lambda part: made.to_csv(part, index=False))


def _known(kind: str, out: Path) -> dict[str, Callable]:
    """The kinds that a format can hold, once `kind` is one of them.

    Raises
    ------
    DataError
        When it is not, or the format is none.
    """
    groups = {"figure": (FORMATS, FIGURES), "table": (NUMBERS, TABLES)}
    groups["animation"] = ((".gif",), MOVIES)
    for what, (suffixes, known) in groups.items():
        if out.suffix not in suffixes:
            continue
        if kind in known:
            return known
        others = "; ".join(
            f"with --out *{'/'.join(other)}: {', '.join(kinds)}"
            for other, kinds in groups.values()
            if kinds is not known
        )
        raise DataError(f"plot: no {what} {kind!r}, expected one of {', '.join(known)}; {others}")
    formats = [suffix for suffixes, _ in groups.values() for suffix in suffixes]
    raise DataError(f"{out}: format {out.suffix!r}, expected one of {', '.join(formats)}")
