"""What each kind of `lithofrac plot` draws from, held against the inputs before any is read."""

from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

from lithofrac.analysis.bench import is_bench
from lithofrac.analysis.runs import find_runs
from lithofrac.data import DataError

SUMMARY = "summary.json"  # makes a folder one of results
RUN = "results folders or files in them"
HOLES = ("hole_initiation.csv",)


@dataclass(frozen=True)
class Needs:
    """Inputs of a kind; patterns are those of file names.

    Attributes
    ----------
    words : what is expected, for messages
    one : patterns, for each of which one input must be there
    beside : patterns of other files that are no results and may be there
    runs : fewest results folders among the rest; None where none is taken
    scenes : kinds of scene, of which one run at least must be; any without one
    all_of : whether every run must be
    """

    words: str = RUN
    one: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    runs: int | None = 1
    scenes: tuple[str, ...] = ()
    all_of: bool = False


MATERIAL = Needs("one material (.yaml)", ("*.yaml",), runs=None)
OWN_FILES = Needs("the files that it is drawn from", beside=("*",), runs=0)  # it looks itself
NONE = Needs("no input, its data lie in data/", beside=("*",), runs=0)
SPECIMENS = ("triaxial", "plane_strain")
OF_HOLES = Needs("results folders of the scene hole", scenes=("hole",))
OF_PUNCHES = Needs("results folders of the scene punch", scenes=("punch",))
OF_SPECIMENS = Needs("results folders of triaxial or plane strain tests", scenes=SPECIMENS)

# Those not named here take any run: a figure one at least, a table perhaps none.
FIGURES = {
    "single_element": Needs(
        "curves of `lithofrac point`, ROCK/TEST_pCONFINEMENT.parquet", runs=None
    ),
    "measured": MATERIAL,
    "stress_strain": OF_SPECIMENS,
    "strength": OF_SPECIMENS,
    "gallery": Needs(OF_SPECIMENS.words, scenes=SPECIMENS, all_of=True),
    "punch": OF_PUNCHES,
    "punch_patterns": OF_PUNCHES,
    "hole_gauges": OF_HOLES,
    "hole_patterns": OF_HOLES,
    "size_effect": Needs(OF_HOLES.words, beside=HOLES, scenes=("hole",)),
    "variants": Needs("a suite file (.yaml) and results folders", beside=("*.yaml",), runs=0),
    "stability": OWN_FILES,
    "accuracy": OWN_FILES,
    "speed": OWN_FILES,
    "study": Needs("a study file (.yaml) and its runs", beside=("*.yaml", "*.yml"), runs=0),
}
TABLES = {
    "tautona": MATERIAL,
    "zigong": NONE,
    "zigong_fit": NONE,
    "zigong_prediction": MATERIAL,
    "zigong_prediction_error": MATERIAL,
    "single_element": FIGURES["single_element"],
    "options": Needs("materials (.yaml)", beside=("*",), runs=0),
    "results": Needs("bands.csv, one material (.yaml) and runs", ("bands.csv", "*.yaml"), runs=0),
    "run_time": Needs("bands.csv and results folders", ("bands.csv",), runs=0),
    "hole_checks": Needs("bands.csv and holes", ("bands.csv",), HOLES, runs=0),
    "hole_initiation": Needs(beside=HOLES, runs=0),
    "size_effect": Needs(beside=HOLES, runs=0),
    "hole_fits": Needs(beside=HOLES, runs=0),
    "variants": FIGURES["variants"],
    "study": FIGURES["study"],
    "claims": Needs("claims_bands.csv, tables and runs", beside=("*.csv",), runs=0),
    "speed_rows": OWN_FILES,
    "speed_targets": OWN_FILES,
}


def of(kind: str, table: bool) -> Needs:
    """Needs of a kind."""
    return TABLES.get(kind, Needs(runs=0)) if table else FIGURES.get(kind, Needs())


def check(kind: str, inputs: list[Path], table: bool) -> None:
    """Refuse inputs of which a kind cannot be drawn.

    Parameters
    ----------
    table : whether it is a table, not a figure or animation

    Raises
    ------
    DataError
        In one sentence on the first that is wrong.
    """
    here, needs = f"plot {kind}", of(kind, table)
    paths = [Path(path) for path in inputs]
    for path in paths:
        if not path.exists():
            raise DataError(f"{path}: no such file or folder, expected an input of the plot")
    if not paths and (needs.one or not table):
        raise DataError(f"{here}: no input, expected {needs.words}")
    for pattern in needs.one:
        found = [path for path in paths if fnmatch(path.name, pattern)]
        if len(found) != 1:
            raise DataError(f"{here}: {len(found)} inputs {pattern}, expected {needs.words}")
        paths.remove(found[0])
    own = [path for path in paths if not any(fnmatch(path.name, name) for name in needs.beside)]
    _check_runs(here, own, needs)
    if needs.runs and not find_runs(paths) and not needs.beside:
        raise DataError(f"{here}: no run among the inputs, expected {needs.words}")


def _check_runs(here: str, paths: list[Path], needs: Needs) -> None:
    """Refuse inputs in no results folder, and runs of other scenes."""
    others = [path for path in paths if not is_bench(path)]
    if needs.runs is None and others:
        raise DataError(f"{here}: {others[0]}: is not drawn, expected {needs.words}")
    runs = find_runs(others)
    for run in runs:
        if not (run.folder / SUMMARY).is_file():
            raise DataError(
                f"{here}: {run.folder / SUMMARY}: no such file, expected an input in a results "
                "folder of `lithofrac run`"
            )
    if runs and needs.scenes:
        fitting = [run for run in runs if run.test in needs.scenes]
        if not fitting or (needs.all_of and len(fitting) < len(runs)):
            other = next(run for run in runs if run.test not in needs.scenes)
            raise DataError(
                f"{here}: {other.folder}: is a run of the scene {other.test}, "
                f"expected {needs.words}"
            )
