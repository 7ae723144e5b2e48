"""Two generations of checkpoints; a broken one is refused and the one before is used.

The archive has a check sum of its own over names, types, shapes and values: that of the zip format
is not looked at where a flipped bit in a header makes an array shorter.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from lithofrac.errors import CheckpointError
from lithofrac.problem import Problem
from lithofrac.results.files import write_whole

FORMAT = 5  # raise it whenever the meaning of a stored number changes
NAME, PREVIOUS = "checkpoint.npz", "checkpoint_previous.npz"
FAILED = "checkpoint_failed.npz"  # to look at; nothing resumes from it
# Beside the compiled core, what decides the numbers of a run once there is a problem.
DRIVERS = ("core.py", "run.py", "results")


def fingerprint(problem: Problem) -> str:
    """Hash of all that a checkpoint takes for granted: mesh, materials, loads, settings."""
    digest = hashlib.sha256()
    mesh = problem.mesh
    for array in (mesh.nodes, mesh.triangles, mesh.body):
        digest.update(np.ascontiguousarray(array).tobytes())
    for material in problem.materials:
        digest.update(repr(material).encode())
    for load in (*problem.velocity_loads, *problem.pressure_loads):
        for name, value in vars(load).items():
            digest.update(name.encode())
            is_array = isinstance(value, np.ndarray)
            digest.update(value.tobytes() if is_array else repr(value).encode())
    settings = (problem.axisymmetric, problem.damping, problem.time_step_factor, problem.records)
    settings = (*settings, problem.probes, problem.end_time, problem.contact, problem.fracture)
    digest.update(repr(settings).encode())
    for name, edges in sorted(mesh.edge_sets.items()):
        digest.update(name.encode() + edges.tobytes())
    return digest.hexdigest()


@cache
def build() -> str:
    """Hash of the compiled core and of what drives it: with another one the bits may differ."""
    digest = hashlib.sha256(Path(find_spec("lithofrac._core").origin).read_bytes())
    package = Path(__file__).parents[1]
    for driver in DRIVERS:
        path = package / driver
        for source in sorted(path.glob("*.py")) if path.is_dir() else [path]:
            digest.update(source.name.encode() + source.read_bytes())
    return digest.hexdigest()


@dataclass(frozen=True)
class Checkpoint:
    """A good checkpoint.

    path : where it was found
    arrays : what `write` was given
    same_build : whether this very build has written it
    notes : a sentence for every newer one that was refused, and on what else is amiss
    """

    path: Path
    arrays: dict[str, np.ndarray]
    same_build: bool
    notes: list[str]


def write(folder: Path, mark: str, arrays: dict[str, np.ndarray]) -> None:
    """Write a checkpoint; the one of before is kept as the previous one.

    Raises
    ------
    OSError
        From the disk; both generations stay as they were.
    """
    _write(folder / NAME, mark, arrays, older=folder / PREVIOUS)


def write_failed(folder: Path, mark: str, arrays: dict[str, np.ndarray]) -> None:
    """Write a state that no run may go on from; both good generations stay as they are."""
    _write(folder / FAILED, mark, arrays)


def _write(path: Path, mark: str, arrays: dict[str, np.ndarray], older: Path | None = None) -> None:
    stamp = {"format": np.array(FORMAT), "fingerprint": np.array(mark), "build": np.array(build())}
    arrays = {**stamp, **arrays}
    digest = np.array(_digest(arrays))
    write_whole(path, lambda part: np.savez(part, digest=digest, **arrays), older=older)


def read(folder: Path, mark: str) -> Checkpoint:
    """The newest good checkpoint of the run with this fingerprint.

    Raises
    ------
    CheckpointError
        If none is good; the message says why for each.
    """
    refused = []
    for name in (NAME, PREVIOUS):
        path = folder / name
        try:
            arrays = _load(path, mark)
        except FileNotFoundError:
            continue
        except CheckpointError as error:
            refused.append(str(error))
            continue
        same = str(arrays.pop("build")) == build()
        other = f"{path}: made by another build, bits may differ from those of an unbroken run"
        return Checkpoint(path, arrays, same, refused if same else [*refused, other])
    raise CheckpointError("; ".join(refused) or f"{folder}: there is no checkpoint to resume from")


def recover(folder: Path, mark: str) -> Checkpoint:
    """As `read`; what was good becomes the newest, or the next `write` would give it up."""
    found = read(folder, mark)
    if found.path.name == PREVIOUS:
        found.path.replace(folder / NAME)
    return found


def _load(path: Path, mark: str) -> dict[str, np.ndarray]:
    """Arrays of a checkpoint, `build` among them.

    Raises
    ------
    CheckpointError
        In one sentence, if it is damaged, of another format or of another run.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file}
        kind = int(arrays["format"])
        said = str(arrays.pop("digest", ""))
    except FileNotFoundError:
        raise
    except Exception as error:  # a damaged archive ends in nearly any kind of error
        words = " ".join(f"{type(error).__name__}: {error}".split())
        raise CheckpointError(f"{path}: not a whole checkpoint ({words})") from None
    if kind != FORMAT:
        raise CheckpointError(f"{path}: written in format {kind}, expected {FORMAT}")
    if said != _digest(arrays):
        raise CheckpointError(f"{path}: not a whole checkpoint (its check sum is another one)")
    if str(arrays.pop("fingerprint", "")) != mark:
        raise CheckpointError(f"{path}: it belongs to another case, mesh or material")
    del arrays["format"]
    return arrays


def _digest(arrays: dict[str, np.ndarray]) -> str:
    """Check sum over names, types, shapes and values."""
    digest = hashlib.sha256()
    for name, array in sorted(arrays.items()):
        digest.update(f"{name} {array.dtype.str} {array.shape} ".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
