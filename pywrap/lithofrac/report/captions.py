"""Captions of figures: written once for Snakemake's report, shown on the pages as well.

A figure `KIND_CASE` has the caption `KIND.rst`; a figure that has none of its own name is one that
compares runs and has `compared.rst`. What the templates call `snakemake` is made up here.
"""

from pathlib import Path
from types import SimpleNamespace

from docutils.core import publish_parts
from docutils.utils import SystemMessage
from jinja2 import Environment, StrictUndefined, TemplateError

from lithofrac.data import DataError

COMPARED = "compared"
WILDCARDS = ("case", "rock", "sheet")  # of the rules that draw one figure for each

STRICT = {"report_level": 5, "halt_level": 2, "file_insertion_enabled": False}  # of docutils


def template_of(figure: str, folder: Path) -> tuple[Path, str]:
    """Caption file of a figure, and what follows its kind in the name of the figure."""
    kinds = [path.stem for path in folder.glob("*.rst")]
    own = [kind for kind in kinds if figure == kind or figure.startswith(f"{kind}_")]
    if not own:
        return folder / f"{COMPARED}.rst", figure
    kind = max(own, key=len)
    return folder / f"{kind}.rst", figure.removeprefix(kind).removeprefix("_")


def is_of_a_run(figure: str, folder: Path, cases: set[str]) -> bool:
    """False for a figure of a case that is not among the runs: one that an older suite left."""
    path, rest = template_of(figure, folder)
    return rest in cases or "wildcards.case" not in path.read_text("utf-8")


def caption(figure: str, folder: Path, out_dir: Path) -> str:
    """Caption of a figure as HTML without blank lines.

    Parameters
    ----------
    figure : file name without suffix
    folder : of the `.rst` files
    out_dir : folder of the pipeline

    Raises
    ------
    DataError
        When there is no such caption, or it asks for what a figure does not have.
    """
    path, rest = template_of(figure, folder)
    if not path.is_file():
        raise DataError(f"{path}: no such file, expected the caption of figure {figure}")
    wildcards = SimpleNamespace(**dict.fromkeys(WILDCARDS, rest), compared=figure)
    known = SimpleNamespace(wildcards=wildcards, config={"out": str(out_dir)})
    try:
        template = Environment(undefined=StrictUndefined).from_string(path.read_text("utf-8"))
        text = template.render(snakemake=known)
        html = publish_parts(text, writer="html5", settings_overrides=STRICT)["fragment"]
    except (TemplateError, SystemMessage) as error:
        raise DataError(f"{path}: {error}, for figure {figure}") from None
    return "\n".join(line for line in html.splitlines() if line.strip())
