"""The command line: `lithofrac check | mesh | run | plot | report | ...`.

Exit codes: 0 good, 2 bad input or a folder that cannot be written, 3 numerical failure, 4 numbers
moved, 130 interrupted. Heavy modules are imported by the command that needs them.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from lithofrac.arguments import parser
from lithofrac.intake import (
    accepted,
    case_of,
    keep_case,
    made_of,
    mesh_of,
    prepare,
    resumed,
    warn,
    way_on,
    within_budget,
)

if TYPE_CHECKING:
    from argparse import Namespace

    from lithofrac.config import Case

GOOD, BAD_INPUT, NUMERICAL_FAILURE, MOVED, INTERRUPTED = 0, 2, 3, 4, 130
BAD_INPUT_ERRORS = {"DataError", "CheckpointError", "FileError", "FolderInUseError"}


def main(arguments: list[str] | None = None) -> int:
    """Run one command; returns its exit code."""
    with suppress(AttributeError):  # a title may hold letters that the locale lacks
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        try:
            return _one_command(arguments)
        finally:
            sys.stdout.flush()  # not when Python ends, where a closed pipe is an error
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):  # `lithofrac check | head`
            return GOOD
        _complain(str(error))  # a full disk below the output
        return BAD_INPUT


def _one_command(arguments: list[str] | None) -> int:
    options = parser().parse_args(arguments)
    try:
        _refuse_other_bytes(sys.argv[1:] if arguments is None else arguments)
        return COMMANDS[options.command](options)
    except KeyboardInterrupt:
        _complain("interrupted")
        return INTERRUPTED
    except BrokenPipeError:
        raise
    except Exception as error:
        code = _exit_code(error)
        if code is None:
            raise
        from lithofrac.config.errors import printable

        for line in (str(error) or "not enough memory").split("\n"):
            _complain(printable(line))
        return code


def _refuse_other_bytes(words: list[str]) -> None:
    """Refuse words that are not UTF-8, for no Parquet file can be written to such a path.

    Raises
    ------
    ConfigError
        At the first word that Python could not decode.
    """
    from lithofrac.config.errors import ConfigError, printable

    for word in words:
        try:
            word.encode()
        except UnicodeEncodeError:
            raise ConfigError(f"{printable(word)}: is not UTF-8, expected words in UTF-8") from None


def _complain(sentence: str) -> None:
    """Say what is wrong, unless nobody can be told."""
    with suppress(OSError):
        print(f"lithofrac: {sentence}", file=sys.stderr, flush=True)


def _exit_code(error: Exception) -> int | None:
    """Exit code of a failure that a user can act on; None for a defect of the program."""
    from lithofrac.config import ConfigError

    names = {base.__name__ for base in type(error).__mro__}
    if isinstance(error, (ConfigError, OSError, MemoryError)) or names & BAD_INPUT_ERRORS:
        return BAD_INPUT
    return NUMERICAL_FAILURE if names & {"CoreError", "MeshError"} else None


def init(options: Namespace) -> int:
    """Start a project in a new folder."""
    from lithofrac.project import make

    made = ", ".join(path.name for path in make(options.name))
    print(f"{options.name}: {made}; README.md says how to go on")
    return GOOD


def check(options: Namespace) -> int:
    """Say what a run would use, and whether its input is right."""
    from lithofrac.config import load_suite
    from lithofrac.config.suite import default_suite

    names = options.case or list(load_suite(options.suite or default_suite()).names)
    if len(names) == 1:
        case = case_of(names[0], options)
        _print_plan(names[0], case)
        warn(names[0], case)
        return GOOD
    titles = {name: within_budget(name, case_of(name, options)).title for name in names}
    for name, title in titles.items():
        print(f"{name}: {title}")
    print(f"{len(names)} cases are right")
    return GOOD


def mesh(options: Namespace) -> int:
    """Mesh a case and save it."""
    from lithofrac.config import ConfigError
    from lithofrac.results.files import write_whole

    if options.out.exists() and not options.out.is_file():
        raise ConfigError(f"--out {options.out}: is no regular file, expected a file to write")
    made = made_of(options.case, case_of(options.case, options), options.seed)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    write_whole(options.out, made.save)
    print(f"{options.out}: {len(made.triangles)} elements, {len(made.nodes)} nodes")
    return GOOD


def run(options: Namespace) -> int:
    """Run a case into its results folder."""
    from lithofrac.config import ConfigError
    from lithofrac.progress import Progress
    from lithofrac.run import simulate

    out = options.out
    case = case_of(options.case, options)
    made = mesh_of(case, options)
    problem, _ = accepted(options.case, case, made)
    resume, notes = resumed(options, problem)
    for note in notes:
        _complain(note)
    name = Path(options.case).stem if options.case.endswith((".yaml", ".yml")) else options.case
    warnings = warn(name, case, quiet=options.quiet)
    progress = Progress(name)
    before = signal.signal(signal.SIGTERM, _as_keyboard_interrupt)
    try:
        summary = simulate(
            problem,
            out,
            threads=options.threads,
            resume=resume,
            progress=None if options.quiet else progress,
            warn=None if options.quiet else progress.warn,
            meta={
                "case": name,
                "title": case.title,
                "commit": _commit(),
                "input_warnings": warnings,
            },
            prepare=partial(keep_case, out, case)
            if resume
            else partial(prepare, out, Path(options.case), case, made),
        )
    except KeyboardInterrupt:
        _complain(f"interrupted{way_on(out)}")
        return INTERRUPTED
    except OSError as error:
        why = os.strerror(error.errno) if error.errno else " ".join(str(error).split())
        raise ConfigError(f"--out {out}: cannot be written ({why}){way_on(out)}") from None
    finally:
        progress.close()
        signal.signal(signal.SIGTERM, before)
    if not options.quiet:
        _print_summary(name, summary, out)
    return GOOD


def show(options: Namespace) -> int:
    """Print the summaries of runs."""
    from lithofrac.analysis.overview import overview

    print(overview(_present(options.run)))
    return GOOD


def study(options: Namespace) -> int:
    """Run what a study lacks, and write its table and its figure."""
    from lithofrac.study import checked, start

    asked, texts = checked(options.file)
    if options.out is None:
        for name in asked.names:
            own = ", ".join(f"{key} = {value}" for key, value in asked.overrides(name).items())
            print(f"{name}: {own}" if own else f"{name}: as the base")
        print(f"{len(texts)} runs are right; --out DIR runs them")
        return GOOD
    before = signal.signal(signal.SIGTERM, _as_keyboard_interrupt)
    try:
        start(options.file, texts, options.out, options.cores, options.quiet, options.profile)
    finally:
        signal.signal(signal.SIGTERM, before)
    if not options.quiet:
        print(f"{len(texts)} runs; {options.out}/table.parquet, {options.out}/figure.svg")
    return GOOD


def plot(options: Namespace) -> int:
    """Draw a figure, or write its numbers."""
    from lithofrac.plots import draw

    draw(options.kind, options.input, options.out, data=options.data)
    return GOOD


def report(options: Namespace) -> int:
    """Write the report of a finished suite."""
    from lithofrac.config import ConfigError
    from lithofrac.report import write_report

    if options.out.suffix not in (".md", ".html"):
        raise ConfigError(f"--out {options.out}: expected a file that ends in .md or .html")

    write_report(options.folder, options.out)
    return GOOD


def gallery(options: Namespace) -> int:
    """Replace the committed pictures, and say what made them."""
    from lithofrac.report import write_gallery

    write_gallery(options.folder, options.picture, options.out, Path("reports/captions"))
    return GOOD


def point(options: Namespace) -> int:
    """Drive one material point and write its curve, or a folder of curves."""
    from lithofrac import point as bench
    from lithofrac.config import ConfigError
    from lithofrac.config.material import Material

    rock = Material.load(options.rock)
    if options.end_strain is not None and not 0.0 < options.end_strain < 1.0:
        raise ConfigError(f"--end-strain {options.end_strain:g}: expected a number between 0 and 1")
    if options.stiffness is not None and not 0.0 <= options.stiffness <= 1e3:
        raise ConfigError(f"--stiffness {options.stiffness:g}: expected a number from 0 to 1000")
    for confinement in options.confinement_MPa:
        if not 0.0 <= confinement <= 1e6:
            raise ConfigError(
                f"--confinement-MPa {confinement:g}: expected a number from 0 to 1e+06"
            )
    given = {"end_strain": options.end_strain, "stiffness": options.stiffness}
    more = {name: value for name, value in given.items() if value is not None}
    one_file = options.out.suffix == ".parquet"
    if one_file and len(options.confinement_MPa) > 1:
        raise ConfigError(f"--out {options.out}: several confinements need a folder, not a file")
    try:
        curves = {
            confinement: bench.drive(rock, test=options.test, confinement_MPa=confinement, **more)
            for confinement in options.confinement_MPa
        }
    except ValueError as error:  # a test or number that the bench refuses
        raise ConfigError(str(error)) from None
    for confinement, curve in curves.items():
        name = f"{options.test}_p{confinement:04.1f}".removesuffix(".0")
        path = options.out if one_file else options.out / f"{name}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        curve.to_parquet(path, index=False)
    return GOOD


def fit(options: Namespace) -> int:
    """Fit a rock to triaxial tests and write its material file."""
    from lithofrac.own_rock import fit as fit_to

    o = options
    if sys.stderr.isatty():
        print("fitting; stress-strain curves may take some minutes", file=sys.stderr)
    print("\n".join(fit_to(o.tests, o.out, o.base, o.set, o.fit_on, o.knots)))
    return GOOD


def compare(options: Namespace) -> int:
    """Hold runs against the references; what moved is printed."""
    from lithofrac.analysis.references import read
    from lithofrac.analysis.regression import compare, sentences
    from lithofrac.analysis.runs import find_runs

    references = read(options.references)
    found = compare(find_runs(_present(options.run)), references, Path("data"))
    for line in sentences(found, references):
        print(line)
    return MOVED if found.drifted else GOOD


def references(options: Namespace) -> int:
    """Replace the references by the numbers of runs."""
    from lithofrac.analysis.references import make, write
    from lithofrac.analysis.runs import find_runs

    runs, twins = find_runs(_present(options.run)), find_runs(_present(options.twin))
    numbers, meshes = make(runs, twins, Path("data"))
    write(options.references, numbers, meshes, options.why, runs)
    print(f"{options.references}: {len(numbers)} numbers of {len(meshes)} cases")
    return GOOD


def stability(options: Namespace) -> int:
    """Try the extremes of the model; says which cells of the matrix are not as they should be."""
    from lithofrac.stability.matrix import make_matrix

    bad = make_matrix(options.out, options.only, options.processes)
    for line in bad:
        print(f"lithofrac: {line}", file=sys.stderr)
    return NUMERICAL_FAILURE if bad else GOOD


def accuracy(options: Namespace) -> int:
    """Measure error against run time; says which runs failed and which defaults lack a reason."""
    from lithofrac.accuracy.sweep import make_sweep

    failed = make_sweep(options.out, options.only, options.processes)
    for line in failed:
        print(f"lithofrac: {line}", file=sys.stderr)
    return NUMERICAL_FAILURE if failed else GOOD


COMMANDS = {
    "init": init,
    "check": check,
    "mesh": mesh,
    "run": run,
    "study": study,
    "show": show,
    "plot": plot,
    "report": report,
    "gallery": gallery,
    "point": point,
    "fit": fit,
    "compare": compare,
    "references": references,
    "stability": stability,
    "accuracy": accuracy,
}


def _present(paths: list[Path]) -> list[Path]:
    """Paths that are there.

    Raises
    ------
    DataError
        At the first that is not.
    """
    from lithofrac.data import DataError

    for path in paths:
        if not path.exists():
            raise DataError(f"{path}: no such file or folder, expected a results folder")
    return paths


def _print_plan(name: str, case: Case) -> None:
    import numpy as np

    made = made_of(name, case)
    problem, expected = accepted(name, case, made)
    of_case = [i for i, material in enumerate(problem.materials) if material == case.material]
    rock = np.isin(made.body, of_case)
    width = float(case.material.band_width_of(made.areas()[rock].max()))
    extent = " x ".join(f"{1e3 * length:.6g}" for length in np.ptp(made.nodes, axis=0))
    used = [feature for feature, uses in expected["uses"].items() if uses]
    unused = [feature for feature, uses in expected["uses"].items() if not uses]
    rows = [
        ("case", f"{name}: {case.title}"),
        ("scene", f"{case.scene.kind}, {extent} mm, mesh {case.mesh.seed}"),
        ("material", case.material.title or "without a title"),
        ("elements", f"{expected['elements']} on {expected['nodes']} nodes"),
        ("crack band", f"{1e3 * width:.3g} mm, {_limit(case)}"),
        ("time step", f"{expected['time_step_s']:.4g} s"),
        ("steps", f"{expected['steps']} to {1e3 * problem.end_time:.4g} ms"),
        ("expected run", f"{expected['expected_seconds']:.1f} s on one core"),
        ("uses", ", ".join(used) or "nothing"),
        ("leaves out", ", ".join(unused) or "nothing"),
    ]
    for key, value in rows:
        print(f"{key:<14}{value}")


def _limit(case: Case) -> str:
    if case.material.elastic:
        return "no limit"
    limit = min(case.material.band_width_limit, case.material.compressive_width_limit)
    return f"limit {1e3 * limit:.4g} mm"


def _print_summary(name: str, summary: dict, out: Path) -> None:
    peak = summary.get("peak_stress_MPa")
    said = "no axial measure" if peak is None else f"largest axial stress {peak:.4g} MPa"
    print(
        f"{name}: {summary['status']}, {summary['steps']} steps in "
        f"{summary['wall_seconds']:.1f} s, {said}, "
        f"energy residual {summary['energy_residual']:.1e}; results in {out}"
    )


def _commit() -> str | None:
    """Commit of the working folder, None outside a repository."""
    try:
        done = subprocess.run(
            ["git", "describe", "--always", "--dirty", "--abbrev=12"],
            capture_output=True, text=True, timeout=10.0,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() or None


def _as_keyboard_interrupt(number: int, frame: object) -> None:
    """A time limit of a cluster stops a run as Ctrl-C does: with a checkpoint."""
    raise KeyboardInterrupt
