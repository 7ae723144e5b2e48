"""What a run finds in its results folder, what of it goes, and what is put there first."""

from __future__ import annotations

from pathlib import Path

from lithofrac.config import Case, ConfigError
from lithofrac.config.setting import text_of
from lithofrac.errors import CheckpointError, CoreError
from lithofrac.problem import Mesh, Problem
from lithofrac.results import checkpoint
from lithofrac.results.checkpoint import Checkpoint
from lithofrac.results.files import part_of, write_text, write_whole

OWN_FILES = (
    "summary.json",
    "history.parquet",
    "energy.parquet",
    "probes.parquet",
    "cracks.parquet",
    "fragments.parquet",
    checkpoint.NAME,
    checkpoint.PREVIOUS,
    "fields.pvd",
    "fields/frame_[0-9]*.vtu",
    "fields/failed.vtu",
    "mesh.npz",
    "case.yaml",
)  # what a run writes and the next one may delete


def prepare(out: Path, case: Case, named: Path, mesh: Mesh) -> None:
    """Delete what an earlier run left, also half files of one that was killed; save the input.

    Parameters
    ----------
    named : the case file that the user gave, if it is one

    Raises
    ------
    ConfigError
        If the case file lies where its copy would go.
    """
    copy = out / "case.yaml"
    if copy.exists() and named.exists() and copy.samefile(named):
        raise ConfigError(f"--out {out}: the run would replace its case file {named}")
    for pattern in OWN_FILES:
        for path in (*out.glob(pattern), *out.glob(str(part_of(Path(pattern))))):
            path.unlink()
    write_whole(out / "mesh.npz", mesh.save)
    write_text(copy, text_of(case))


def to_resume(out: Path, problem: Problem) -> Checkpoint:
    """What `--resume` goes on from.

    Raises
    ------
    CheckpointError
        If nothing fits; nothing has been written then.
    """
    try:
        return checkpoint.read(out, checkpoint.fingerprint(problem))
    except CoreError as error:
        raise CheckpointError(f"--resume: {error}") from None


def cut_off(out: Path, problem: Problem) -> Checkpoint | None:
    """The same if a run of this very problem by this very build was stopped here, else None."""
    try:
        found = checkpoint.read(out, checkpoint.fingerprint(problem))
    except CoreError:
        return None
    return found if found.same_build and not found.arrays["finished"] else None


def way_on(out: Path) -> str:
    """End of a sentence on a run that was stopped: how it goes on, if it can."""
    if any((out / name).exists() for name in (checkpoint.NAME, checkpoint.PREVIOUS)):
        return f"; the same command with --resume goes on from {out}"
    return ""
