"""From the words of a command to a case, its mesh, its problem and its results folder.

Heavy modules are imported by the function that needs them.
"""

from __future__ import annotations

import shutil
import sys
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argparse import Namespace

    from lithofrac.config import Case
    from lithofrac.problem import Mesh, Problem

MOST_STEPS = 1_000_000_000
COPY = "case.yaml"  # of a results folder


def case_of(name: str, options: Namespace) -> Case:
    """Case of a file or of the suite, with the settings of the command line."""
    from lithofrac.config.setting import settings
    from lithofrac.config.suite import find_case

    return find_case(name, options.suite, settings(options.set))


def warn(name: str, case: Case, quiet: bool = False) -> list[str]:
    """Print and return what is doubtful about a case."""
    from lithofrac.config.doubts import doubts

    found = doubts(case)
    for sentence in [] if quiet else found:
        with suppress(OSError):  # a full disk below the log is no reason to stop
            print(f"lithofrac: warning: {name}: {sentence}", file=sys.stderr)
    return found


def mesh_of(case: Case, options: Namespace) -> Mesh:
    """Mesh of the folder that is resumed, of the file that is named, or a new one."""
    from lithofrac.config import ConfigError
    from lithofrac.problem import Mesh

    path = options.out / "mesh.npz" if options.resume else options.mesh
    if path is None:
        return made_of(options.case, case)
    if options.resume and not path.exists():
        raise ConfigError(f"{path}: no such file, there is no run to resume in {options.out}")
    return Mesh.load(path)


def made_of(name: str, case: Case, seed: int | None = None) -> Mesh:
    """A new mesh of a case."""
    from lithofrac.config import ConfigError
    from lithofrac.scenes import make_mesh

    try:
        return make_mesh(case, seed)
    except ConfigError as error:
        raise ConfigError(f"{name}: {error}") from None


def accepted(name: str, case: Case, mesh: Mesh) -> tuple[Problem, dict]:
    """Problem of a case and its plan, once scene and core have taken both; nothing is written."""
    from lithofrac.config import ConfigError
    from lithofrac.errors import CoreError
    from lithofrac.plan import plan
    from lithofrac.scenes import make_problem

    try:
        problem = make_problem(case, mesh)
        expected = plan(problem)
    except (ConfigError, CoreError) as error:
        lines = str(error).splitlines()
        raise ConfigError("\n".join(f"{name}: {line}" for line in lines)) from None
    if expected["steps"] < 1:
        raise ConfigError(f"{name}: loading: the run takes no time, expected at least one step")
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


def within_budget(name: str, case: Case) -> Case:
    """The case, if it is not above its budget by prediction; nothing is meshed."""
    from lithofrac.config import ConfigError
    from lithofrac.config.cost import refuse_above_budget

    try:
        refuse_above_budget(case)
    except ConfigError as error:
        raise ConfigError(f"{name}: {error}") from None
    return case


def resumed(options: Namespace, problem: Problem) -> tuple[bool, list[str]]:
    """Whether the run goes on from a checkpoint, and sentences on what is odd about that.

    Raises
    ------
    CheckpointError
        If `--resume` finds nothing to go on from; nothing has been written then.
    """
    from lithofrac.errors import CheckpointError, CoreError
    from lithofrac.results import checkpoint
    from lithofrac.run import misfit

    if not (options.resume or options.resume_if_possible):
        return False, []
    try:
        mark = checkpoint.fingerprint(problem)
        found = checkpoint.read(options.out, mark, partial(misfit, problem))
    except CoreError as error:
        if options.resume:
            raise CheckpointError(f"--resume: {error}") from None
        found = None
    if options.resume or (found and found.same_build and not found.arrays["finished"]):
        return True, [f"{note}; going on from {found.path.name}" for note in found.notes]
    if found is None:
        why = "its checkpoint is not of this run"
    else:
        why = "its run has come to its end" if found.same_build else "another build has made it"
    return False, [f"{options.out}: {why}, starting anew"] if way_on(options.out) else []


def way_on(out: Path) -> str:
    """End of a sentence on a run that was stopped: how it goes on, if it can."""
    from lithofrac.results import checkpoint

    if any((out / name).exists() for name in (checkpoint.NAME, checkpoint.PREVIOUS)):
        return f"; the same command with --resume goes on from {out}"
    return ""


def keep_case(out: Path, case: Case) -> None:
    """Save the case with the values in force; a run that goes on may have other guards."""
    from lithofrac.config.setting import kept, text_of
    from lithofrac.results.files import write_text

    write_text(out / COPY, text_of(kept(case)[0]))


def prepare(out: Path, named: Path, case: Case, mesh: Mesh) -> None:
    """Delete what an earlier run left, half files of a killed one too, and save the input.

    Parameters
    ----------
    named : the case as the user names it, perhaps a file
    """
    from lithofrac.config import ConfigError
    from lithofrac.config.setting import kept
    from lithofrac.results import files
    from lithofrac.results.files import OWN_FILES, part_of, write_text, write_whole

    copy, beside = out / COPY, kept(case)[1]
    if copy.exists() and named.exists() and copy.samefile(named):
        raise ConfigError(f"--out {out}: the run would replace its case file {named}")
    for geometry, source in beside.items():
        if (out / geometry).exists() and source.samefile(out / geometry):
            raise ConfigError(f"--out {out}: the run would replace its geometry {source}")
    other = files.foreign(out)
    if other is not None:
        raise ConfigError(
            f"--out {out}: the run would replace {other}, which none has made; expected a new or "
            "empty folder, or one of an earlier run"
        )
    write_text(out / files.MARK, files.MARKED)
    for pattern in OWN_FILES:
        for path in (*out.glob(pattern), *out.glob(str(part_of(Path(pattern))))):
            path.unlink()
    write_whole(out / "mesh.npz", mesh.save)
    keep_case(out, case)
    for geometry, source in beside.items():
        write_whole(out / geometry, lambda part, source=source: shutil.copyfile(source, part))
