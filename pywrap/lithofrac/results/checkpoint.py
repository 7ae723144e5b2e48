"""Two generations of checkpoints; a broken one is refused and the one before is used."""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path

import numpy as np

from lithofrac.errors import CheckpointError
from lithofrac.problem import Problem
from lithofrac.results.files import write_whole

FORMAT = 4  # raise it whenever the meaning of a stored number changes
NAME, PREVIOUS = "checkpoint.npz", "checkpoint_previous.npz"


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


def write(folder: Path, mark: str, arrays: dict[str, np.ndarray]) -> None:
    """Keep the last checkpoint as the previous one and write a new one."""
    new = folder / NAME
    if new.exists():
        new.replace(folder / PREVIOUS)
    stamp = {"format": np.array(FORMAT), "fingerprint": np.array(mark)}
    write_whole(new, lambda part: np.savez(part, **stamp, **arrays))


def read(folder: Path, mark: str) -> tuple[dict[str, np.ndarray], list[str]]:
    """The newest good checkpoint, and one sentence for every one that was refused.

    Raises
    ------
    CheckpointError
        If none is good; the message says why for each.
    """
    refused = []
    for name in (NAME, PREVIOUS):
        path = folder / name
        try:
            with np.load(path, allow_pickle=False) as file:
                arrays = {key: file[key] for key in file}
        except FileNotFoundError:
            continue
        except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile) as error:
            refused.append(f"{path}: not a whole checkpoint ({error})")
            continue
        if int(arrays.pop("format", -1)) != FORMAT:
            refused.append(f"{path}: written in another format than {FORMAT}")
        elif str(arrays.pop("fingerprint", "")) != mark:
            refused.append(f"{path}: it belongs to another case, mesh or material")
        else:
            return arrays, refused
    raise CheckpointError("; ".join(refused) or f"{folder}: there is no checkpoint to resume from")
