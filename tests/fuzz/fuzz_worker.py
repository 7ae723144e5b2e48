"""One process that tries mutants: seeds come in on standard input, verdicts go out as JSON.

A verdict is `result` (checked and run), `large` (a right case within its budget of element-steps,
but of more than 20,000 elements, which are not run here: above its budget it has to be refused in a
sentence like any other), `refused` (exit code 2) or `stopped` (exit code 3), each with sentences;
or a failure: `traceback`, `nan`, `words` (no clear sentence), `written` (files where none should
be). Its parent adds `hang` and `crash`. The folder of the right meshes is the only argument.
"""

import contextlib
import io
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import traceback
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pandas as pd
from fuzz_bases import CASES, CHECKPOINTS, MATERIALS, OTHER_MSH, OWN, OWN_GEO, own_msh
from fuzz_mutants import Mutant, mutant

from lithofrac import cli
from lithofrac.config import load_case
from lithofrac.config.element_count import element_count, platen_count
from lithofrac.config.errors import printable
from lithofrac.config.study import load_study
from lithofrac.data import load_curves, measured_strength
from lithofrac.data.axes import load_axes
from lithofrac.data.triaxial import load_triaxial
from lithofrac.intake import within_budget
from lithofrac.scenes import _gmsh, make_mesh

GOOD = ("result", "large", "refused", "stopped")
MOST_ELEMENTS, MOST_STEPS = 20_000, 100
PROGRESS = re.compile(r"[\w.@-]+: (warning: |step \d+ of \d+ )")
MOST_LETTERS = 1500  # of a sentence: one may list all keys of a section
SCRIPT_SECONDS = 20.0  # for gmsh on a script
MOST_MEMORY = 6_000_000_000
WITH_PLATENS = ("plane_strain", "punch", "brazilian", "hole")


class TooLarge(Exception):
    """More elements than are run here, though a run would take them."""


class Failure(Exception):
    """Arguments: kind of the verdict, what was seen."""


def limit_runs() -> None:
    """Let the command line mesh and run small cases alone, and take few steps."""
    case_of, accepted = cli.case_of, cli.accepted

    def small_case(*arguments):
        case = case_of(*arguments)
        if case.scene.kind == "gmsh_file":
            return case
        count = element_count(case.scene)
        if case.platens is not None and case.scene.kind in WITH_PLATENS:
            count += platen_count(case.scene, case.platens)
        if count > MOST_ELEMENTS:
            within_budget(arguments[0], case)
            raise TooLarge(f"{count} elements by prediction")
        return case

    def short(*arguments):
        problem, expected = accepted(*arguments)  # which holds it against its budget
        if len(problem.mesh.triangles) > MOST_ELEMENTS:
            raise TooLarge(f"{len(problem.mesh.triangles)} elements")
        end = min(problem.end_time, (MOST_STEPS - 0.5) * expected["time_step_s"])
        few = {"records": min(problem.records, 20), "fields": min(problem.fields, 2)}
        return replace(problem, end_time=end, **few), expected

    cli.case_of, cli.accepted = small_case, short


def write_meshes(folder: str) -> None:
    """The right mesh of every case of `fuzz_bases`, as NAME.npz, .msh files, and checkpoints."""
    Path(folder, "own_22.msh").write_text(own_msh())
    Path(folder, "own.geo").write_text(OWN_GEO)
    for file, options in OTHER_MSH.items():
        words = [*_gmsh._gmsh(), "own.geo", "-2", "-o", file, "-v", "1", *options]
        subprocess.run(words, cwd=folder, check=True)
    with tempfile.TemporaryDirectory() as name:
        for file, text in MATERIALS.items():
            (Path(name) / file).write_text(text)
        (Path(name) / "own.msh").write_text(own_msh())
        for case, text in {**CASES, "own": OWN}.items():
            (Path(name) / "case.yaml").write_text(text)
            make_mesh(load_case(Path(name) / "case.yaml")).save(Path(folder, f"{case}.npz"))
        limit_runs()
        for case in CHECKPOINTS:
            (Path(name) / "case.yaml").write_text(CASES[case])
            out = Path(folder, f"run_{case}")
            words = ["run", f"{name}/case.yaml", "--mesh", f"{folder}/{case}.npz", "--quiet"]
            often = ["--set", "output.checkpoint_seconds=0"]
            if cli.main([*words, *often, "--out", str(out)]):
                raise RuntimeError(f"{case} cannot be run")
            (out / "checkpoint_previous.npz").rename(Path(folder, f"{case}.checkpoint"))


def read_meshes(folder: Path) -> dict[str, bytes]:
    """What `write_meshes` wrote: name of a case, or of a .msh -> content."""
    cases = {path.stem: path.read_bytes() for path in folder.glob("*.npz")}
    others = [
        path for suffix in ("msh", "geo", "checkpoint") for path in folder.glob(f"*.{suffix}")
    ]
    return cases | {path.name: path.read_bytes() for path in others}


def verdict(found: Mutant) -> dict:
    """Try a mutant in a folder of its own."""
    home = Path.cwd()
    top = Path(tempfile.mkdtemp(prefix="lithofrac-fuzz-"))
    try:
        for name, content in found.files.items():
            (top / "in" / name).parent.mkdir(parents=True, exist_ok=True)
            (top / "in" / name).write_bytes(content)
        os.chdir(top / "in")
        kind, detail = _tried(found, top)
    except Failure as failure:
        kind, detail = failure.args
    finally:
        os.chdir(home)
        shutil.rmtree(top)
    return {"seed": found.seed, "kind": kind, "target": found.target, "detail": detail}


def _tried(found: Mutant, top: Path) -> tuple[str, str]:
    """Kind of verdict and what was said."""
    before = _tree(top)
    if found.words in (("data",), ("study",)):
        code, said = _call(_read_study if found.words == ("study",) else _read_data)
        _judge_words(code, said)
        return ("result" if code == 0 else "refused"), said
    words = list(found.words)
    try:
        if words[0] == "check":
            code, said = _call(lambda: cli.main(words))
            if _tree(top) != before:
                raise Failure("written", "check has changed files")
            _judge_words(code, said)
            if code != 0:
                return ("refused" if code == 2 else "stopped"), said
            words[0] = "run"
        code, said = _call(lambda: cli.main([*words, "--out", "results"]))
    except TooLarge as large:
        return "large", str(large)
    _judge_words(code, said)
    _judge_files(code, before, top)
    return {0: "result", 2: "refused", 3: "stopped"}[code], said


def _call(function) -> tuple[int, str]:
    """Exit code and standard error of a command."""
    errors = io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(errors):
        try:
            code = function()
        except (TooLarge, Failure):
            raise
        except SystemExit as left:
            code = left.code
        except Exception:
            raise Failure("traceback", traceback.format_exc()) from None
    return code, errors.getvalue()


def _read_study() -> int:
    """What reads studies, as a command would; its cases are those of other mutants."""
    try:
        study = load_study("study.yaml")
        for name in study.names[:10]:
            if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.@-]*", name):
                raise Failure("written", f"the folder of a run: {name!r}")
            study.case(name)
    except Exception as error:
        return _refused(error)
    return 0


def _refused(error: Exception) -> int:
    """Say what a command would say of an error, unless it is a defect."""
    if cli._exit_code(error) != cli.BAD_INPUT:
        raise error
    for line in str(error).split("\n"):
        print(f"lithofrac: {printable(line)}", file=sys.stderr)
    return cli.BAD_INPUT


def _read_data() -> int:
    """What reads data files, as a command would."""
    try:
        load_axes(Path("data/klerck2004/figure_axes.csv"))
        table = measured_strength(Path("data"), "tautona")
        curves = load_curves(Path("data"), "9")
        own = load_triaxial([Path("data/own/strengths.csv"), Path("data/own/curves.csv")])
    except Exception as error:
        return _refused(error)
    numbers = [table.to_numpy(dtype=float), *(np.concatenate([c.x, c.y]) for c in curves)]
    numbers += [np.append(test.axial_stress_MPa, test.strength_MPa) for test in own]
    if not all(np.isfinite(part).all() for part in numbers):
        raise Failure("nan", "a number of a data file is not finite")
    return 0


def _judge_words(code: int, said: str) -> None:
    lines = said.splitlines()
    if code not in (0, 2, 3):
        raise Failure("words", f"exit code {code}: {said}")
    if code and not lines:
        raise Failure("words", f"exit code {code} without a word")
    progress = [line for line in lines if not line.startswith("lithofrac: ")]
    if (code == 2 and progress) or not all(PROGRESS.match(line) for line in progress):
        raise Failure("words", said)
    if any(len(line) > MOST_LETTERS or not line.isprintable() for line in lines):
        raise Failure("words", said)


def _judge_files(code: int, before: dict, top: Path) -> None:
    """A refusal leaves nothing; a run leaves whole files in its folder alone, without a NaN."""
    after = _tree(top)
    results = {name: after.pop(name) for name in list(after) if name.startswith("in/results")}
    old = {name: before.pop(name) for name in list(before) if name.startswith("in/results")}
    if after != before:
        raise Failure("written", f"outside of the results: {sorted(set(after) ^ set(before))}")
    if code == 2 and results != old:
        raise Failure("written", f"refused, and yet {sorted(set(results) ^ set(old)) or 'changed'}")
    half = [name for name in results if ".part" in Path(name).name]
    if half:
        raise Failure("written", f"half-written {half}")
    if code == 0:
        _judge_numbers(top / "in" / "results")


def _judge_numbers(results: Path) -> None:
    summary = json.loads((results / "summary.json").read_text())
    if summary["status"] != "completed" or summary["energy_residual"] is None:
        raise Failure("nan", f"summary: {summary}")
    for path in results.glob("*.parquet"):
        table = pd.read_parquet(path).select_dtypes("number")
        bad = ~np.isfinite(table.to_numpy(dtype=float)).all(axis=0)
        if bad.any():
            raise Failure("nan", f"{path.name}: {', '.join(table.columns[bad])}")
    for path in results.glob("fields/frame_*.vtu"):
        with contextlib.redirect_stdout(io.StringIO()):
            frame = meshio.read(path)
        fields = frame.point_data | {name: parts[0] for name, parts in frame.cell_data.items()}
        bad = [name for name, values in fields.items() if not np.isfinite(values).all()]
        if bad:
            raise Failure("nan", f"{path.name}: {', '.join(bad)}")


def _tree(top: Path) -> dict[str, bytes | None]:
    """Path below `top` -> content, None of a folder."""
    return {
        path.relative_to(top).as_posix(): path.read_bytes() if path.is_file() else None
        for path in top.rglob("*")
    }


def main(meshes: Path) -> None:
    if os.environ.get("LITHOFRAC_BUILD") != "sanitize":  # its shadow memory counts as well
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what compiled parts print is no answer
    limit_runs()
    _gmsh.OWN_TIME_LIMIT = SCRIPT_SECONDS
    right = read_meshes(meshes)
    for line in sys.stdin:
        print(json.dumps(verdict(mutant(int(line), right))), file=answers)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
