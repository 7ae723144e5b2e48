"""The command line: `lithofrac check | mesh | run | plot | report | ...`.

Exit codes: 0 good, 2 bad input, 3 numerical failure, 4 numbers moved, 130 interrupted. Heavy
modules are imported by the command that needs them.
"""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from lithofrac.arguments import parser

if TYPE_CHECKING:
    from argparse import Namespace

    from lithofrac.config import Case
    from lithofrac.problem import Mesh, Problem

GOOD, BAD_INPUT, NUMERICAL_FAILURE, MOVED, INTERRUPTED = 0, 2, 3, 4, 130
MOST_STEPS = 1_000_000_000
OWN_FILES = (
    "summary.json",
    "history.parquet",
    "energy.parquet",
    "probes.parquet",
    "cracks.parquet",
    "fragments.parquet",
    "checkpoint.npz",
    "checkpoint_previous.npz",
    "fields.pvd",
    "fields/frame_[0-9]*.vtu",
    "fields/failed.vtu",
    "mesh.npz",
    "case.yaml",
    "geometry.geo",
    "geometry.msh",
)  # what a run writes and the next one may delete


def main(arguments: list[str] | None = None) -> int:
    """Run one command; returns its exit code."""
    options = parser().parse_args(arguments)
    _print_anything()
    try:
        return COMMANDS[options.command](options)
    except KeyboardInterrupt:
        print("lithofrac: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # `lithofrac check | head`
        sys.stderr.close()
        return GOOD
    except Exception as error:
        code = _exit_code(error)
        if code is None:
            raise
        from lithofrac.config.errors import printable

        for line in (str(error) or "not enough memory").split("\n"):
            print(f"lithofrac: {printable(line)}", file=sys.stderr)
        return code


def _exit_code(error: Exception) -> int | None:
    """Exit code of a failure that a user can act on; None for a defect of the program."""
    from lithofrac.config import ConfigError

    names = {base.__name__ for base in type(error).__mro__}
    known = {"DataError", "CheckpointError", "FileError"}
    if isinstance(error, (ConfigError, OSError, MemoryError)) or names & known:
        return BAD_INPUT
    return NUMERICAL_FAILURE if names & {"CoreError", "MeshError"} else None


def check(options: Namespace) -> int:
    """Say what a run would use, and whether its input is right."""
    from lithofrac.config import load_suite
    from lithofrac.config.suite import default_suite

    names = options.case or list(load_suite(options.suite or default_suite()).names)
    if len(names) == 1:
        case = _case(names[0], options)
        _print_plan(names[0], case)
        _warn(names[0], case)
        return GOOD
    for name in names:
        case = _case(name, options)
        print(f"{name}: {case.title}")
        _warn(name, case)
    print(f"{len(names)} cases are right")
    return GOOD


def mesh(options: Namespace) -> int:
    """Mesh a case and save it."""
    from lithofrac.config import ConfigError
    from lithofrac.results.files import write_whole

    if options.out.exists() and not options.out.is_file():
        raise ConfigError(f"--out {options.out}: is no regular file, expected a file to write")
    made = _made(options.case, _case(options.case, options), options.seed)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    write_whole(options.out, lambda part: _save(made, part))
    print(f"{options.out}: {len(made.triangles)} elements, {len(made.nodes)} nodes")
    return GOOD


def run(options: Namespace) -> int:
    """Run a case into its results folder."""
    from lithofrac.progress import Progress
    from lithofrac.run import simulate

    case = _case(options.case, options)
    made = _mesh_of(case, options)
    problem, _ = _accepted(options.case, case, made)
    if options.resume:
        _find_checkpoint(options.out, problem)
    name = Path(options.case).stem if options.case.endswith((".yaml", ".yml")) else options.case
    _prepare(options, case, made)
    warnings = _warn(name, case, quiet=options.quiet)
    progress = Progress(name)
    before = signal.signal(signal.SIGTERM, _as_keyboard_interrupt)
    try:
        summary = simulate(
            problem,
            options.out,
            threads=options.threads,
            resume=options.resume,
            progress=None if options.quiet else progress,
            meta={
                "case": name,
                "title": case.title,
                "commit": _commit(),
                "input_warnings": warnings,
            },
        )
    except KeyboardInterrupt:
        print(
            f"lithofrac: interrupted; the same command with --resume goes on from {options.out}",
            file=sys.stderr,
        )
        return INTERRUPTED
    finally:
        progress.close()
        signal.signal(signal.SIGTERM, before)
    if not options.quiet:
        _print_summary(name, summary, options.out)
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


COMMANDS = {
    "check": check,
    "mesh": mesh,
    "run": run,
    "plot": plot,
    "report": report,
    "gallery": gallery,
    "point": point,
    "compare": compare,
    "references": references,
}


def _print_anything() -> None:
    """A name that the terminal cannot show is shown by its codes; it stops nothing."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def _warn(name: str, case: Case, quiet: bool = False) -> list[str]:
    """Print and return what is doubtful about a case."""
    from lithofrac.config.doubts import doubts

    found = doubts(case)
    for sentence in [] if quiet else found:
        print(f"lithofrac: warning: {name}: {sentence}", file=sys.stderr)
    return found


def _save(mesh: Mesh, path: Path) -> None:
    with open(path, "wb") as file:  # a handle, so that no suffix is added
        mesh.save(file)


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


def _case(name: str, options: Namespace) -> Case:
    from lithofrac.config.setting import settings
    from lithofrac.config.suite import find_case

    return find_case(name, options.suite, settings(options.set))


def _mesh_of(case: Case, options: Namespace) -> Mesh:
    """Mesh of the folder that is resumed, of the file that is named, or a new one."""
    from lithofrac.config import ConfigError
    from lithofrac.problem import Mesh

    path = options.out / "mesh.npz" if options.resume else options.mesh
    if path is None:
        return _made(options.case, case)
    if options.resume and not path.exists():
        raise ConfigError(f"{path}: no such file, there is no run to resume in {options.out}")
    return Mesh.load(path)


def _made(name: str, case: Case, seed: int | None = None) -> Mesh:
    """A new mesh of a case."""
    from lithofrac.config import ConfigError
    from lithofrac.scenes import make_mesh

    try:
        return make_mesh(case, seed)
    except ConfigError as error:
        raise ConfigError(f"{name}: {error}") from None


def _accepted(name: str, case: Case, mesh: Mesh) -> tuple[Problem, dict]:
    """Problem of a case and its plan, once scene and core have taken both; nothing is written."""
    from lithofrac.config import ConfigError
    from lithofrac.errors import CoreError
    from lithofrac.run import plan
    from lithofrac.scenes import make_problem

    try:
        problem = make_problem(case, mesh)
        expected = plan(problem)
    except (ConfigError, CoreError) as error:
        lines = str(error).splitlines()
        raise ConfigError("\n".join(f"{name}: {line}" for line in lines)) from None
    if expected["steps"] > MOST_STEPS:
        key = "hold_transits" if getattr(case.loading, "speed_m_s", None) is None else "speed_m_s"
        raise ConfigError(
            f"{name}: loading.{key} = {getattr(case.loading, key):g}: the run takes "
            f"{expected['steps']:.3g} steps, expected at most {MOST_STEPS}"
        )
    elements, steps = expected["elements"], expected["steps"]
    if elements * steps > case.budget_element_steps:
        raise ConfigError(
            f"{name}: budget_element_steps = {case.budget_element_steps:g}: the run takes "
            f"{elements} elements times {steps} steps, {elements * steps:.3g}"
        )
    return problem, expected


def _find_checkpoint(out: Path, problem: Problem) -> None:
    """Refuse to resume before anything is written when no checkpoint fits."""
    from lithofrac.errors import CheckpointError, CoreError
    from lithofrac.results import checkpoint

    try:
        checkpoint.read(out, checkpoint.fingerprint(problem))
    except CoreError as error:
        raise CheckpointError(f"--resume: {error}") from None


def _prepare(options: Namespace, case: Case, mesh: Mesh) -> None:
    """Make the results folder; what an earlier run left there goes, unless it is resumed."""
    from lithofrac.config import ConfigError
    from lithofrac.config.setting import kept, text_of
    from lithofrac.results.files import write_whole

    out, named = options.out, Path(options.case)
    copy, (case, beside) = out / "case.yaml", kept(case)
    try:
        out.mkdir(parents=True, exist_ok=True)
        if options.resume:
            return
        if copy.exists() and named.exists() and copy.samefile(named):
            raise ConfigError(f"--out {out}: the run would replace its case file {named}")
        for geometry, source in beside.items():
            if (out / geometry).exists() and source.samefile(out / geometry):
                raise ConfigError(f"--out {out}: the run would replace its geometry {source}")
        for pattern in OWN_FILES:
            for path in out.glob(pattern):
                path.unlink()
        write_whole(out / "mesh.npz", mesh.save)
        write_whole(copy, lambda part: part.write_text(text_of(case)))
        for geometry, source in beside.items():
            write_whole(out / geometry, lambda part, source=source: shutil.copyfile(source, part))
    except OSError as error:
        raise ConfigError(f"--out {out}: cannot be written ({error.strerror})") from None


def _print_plan(name: str, case: Case) -> None:
    import numpy as np

    made = _made(name, case)
    problem, expected = _accepted(name, case, made)
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
