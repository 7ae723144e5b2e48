"""Two generations of checkpoints; a broken one is refused and the one before is used.

The archive has a check sum of its own over names, types, shapes and values: that of the zip format
is not looked at where a flipped bit in a header makes an array shorter.
"""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from lithofrac.errors import CheckpointError, FileError
from lithofrac.plain_file import refuse_other
from lithofrac.problem import Problem
from lithofrac.results.files import write_whole

FORMAT = 6  # raise it whenever the meaning of a stored number changes
MOST_BYTES = 100_000_000_000  # of a file; a million elements have 1.5 billion
NAME, PREVIOUS = "checkpoint.npz", "checkpoint_previous.npz"
FAILED = "checkpoint_failed.npz"  # to look at; nothing resumes from it
# Entry -> type, as numpy writes it, and shape; a size that has a name is the same everywhere.
Layout = Mapping[str, tuple[str, tuple[int | str, ...]]]
FINITE = ("clocks", "frames", "history", "guards_scale", "guards_worst")  # goes to text and JSON
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


def misfit(arrays: Mapping[str, np.ndarray], layout: Layout) -> str:
    """In what arrays differ from a layout first, or nothing; what it does not name may be there."""
    sizes: dict[int | str, int] = {}
    for name, (kind, shape) in layout.items():
        if name not in arrays:
            return f"it lacks {name!r}"
        array = arrays[name]
        fits = array.dtype.str[1:].startswith(kind) and array.ndim == len(shape)
        for size, wanted in zip(array.shape, shape, strict=False):
            known = wanted if isinstance(wanted, int) else sizes.setdefault(wanted, size)
            fits = fits and size == known
        if not fits:
            return f"{name!r} holds {array.dtype} of shape {array.shape}"
        if kind == "f8" and name in FINITE and not np.isfinite(array).all():
            return f"{name!r} holds what is no finite number"
    return ""


def read(
    folder: Path, mark: str, wrong: Callable[[dict[str, np.ndarray]], str] | None = None
) -> Checkpoint:
    """The newest good checkpoint of the run with this fingerprint.

    Parameters
    ----------
    wrong : says why arrays are not those of the run, or nothing if they are

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
            why = wrong(arrays) if wrong is not None else ""
            if why:
                raise CheckpointError(f"{path}: not a checkpoint of this run ({why})")
        except FileNotFoundError:
            continue
        except CheckpointError as error:
            refused.append(str(error))
            continue
        same = str(arrays.pop("build")) == build()
        other = f"{path}: made by another build, bits may differ from those of an unbroken run"
        return Checkpoint(path, arrays, same, refused if same else [*refused, other])
    raise CheckpointError("; ".join(refused) or f"{folder}: there is no checkpoint to resume from")


def recover(
    folder: Path, mark: str, wrong: Callable[[dict[str, np.ndarray]], str] | None = None
) -> Checkpoint:
    """As `read`; what was good becomes the newest, or the next `write` would give it up."""
    found = read(folder, mark, wrong)
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
    if not path.exists():
        raise FileNotFoundError(2, "No such file or directory", str(path))
    try:
        refuse_other(path, "a checkpoint", MOST_BYTES)
        _refuse_packed(path)
        with np.load(path, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file}
        other = [key for key, array in arrays.items() if not isinstance(array, np.ndarray)]
        if other:
            raise ValueError(f"{other[0]!r} is no array")
        kind = int(arrays["format"])
        said = str(arrays.pop("digest", ""))
    except FileError as error:
        raise CheckpointError(str(error)) from None
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


def _refuse_packed(path: Path) -> None:
    """Refuse an archive that unfolds to more than it holds; checkpoints are not packed."""
    if zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as file:
            unpacked = sum(member.file_size for member in file.infolist())
        if unpacked > path.stat().st_size:
            raise ValueError(f"it unfolds to {unpacked:.3g} bytes, more than it has")


def _digest(arrays: dict[str, np.ndarray]) -> str:
    """Check sum over names, types, shapes and values."""
    digest = hashlib.sha256()
    for name, array in sorted(arrays.items()):
        digest.update(f"{name} {array.dtype.str} {array.shape} ".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
