"""Run gmsh as its own process on a generated .geo, and read the triangles and lines it made.

The only place that starts gmsh. One thread, no user settings: the same text gives the same mesh.
"""

import contextlib
import errno
import io
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np

from lithofrac.config.errors import one_line

# What meshio raises: at files without elements, cut off, or of anything else.
MISREAD = (
    meshio.ReadError, ArithmeticError, AssertionError, LookupError, MemoryError, TypeError,
    ValueError,
)  # fmt: skip
NO_GROUP = "Incompatible cell data 'gmsh:physical'"  # words of meshio on format 4.1 of all elements
SAVED_ALL = (
    "holds elements in no physical group, expected those of groups alone: save it with "
    "Mesh.SaveAll = 0"
)
NOT_CLOSED = "not closed by"  # words of meshio on a section without an end
FORMATS = "Gmsh's format 2.2 or 4.1"
NAMED = "'scene.geo', "  # gmsh names its own copy of the text
TIME_LIMIT = 600.0  # seconds; meshes of the suite take less than one
OWN_TIME_LIMIT = 60.0  # of a script of anybody's, whose loops may have no end
ENDLESS = (
    "look for a loop or call that does not end, or ask for larger elements; a mesh that takes "
    "longer can be made with gmsh and named as .msh"
)

HEAD = """\
General.NumThreads = 1;
Mesh.Algorithm = 6;
Mesh.Smoothing = 10;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MshFileVersion = 2.2;
Mesh.Binary = 0;
"""


class MeshError(RuntimeError):
    """gmsh is missing or gave no mesh; the message holds its last words."""


class GeoError(MeshError):
    """A text that gmsh does not accept, or a mesh that cannot be read."""


@dataclass(frozen=True)
class RawMesh:
    """What gmsh wrote: nodes (n, 2) [m], triangles (m, 3), body (m,), named lines (k, 2)."""

    nodes: np.ndarray
    triangles: np.ndarray
    body: np.ndarray
    body_names: tuple[str, ...]
    lines: dict[str, np.ndarray]


def mesh_from(geo: str) -> RawMesh:
    """Mesh a geometry whose physical curves and surfaces are the sets and bodies.

    Raises
    ------
    MeshError
        When gmsh cannot be started, fails, or leaves no triangles.
    """
    return _raw(meshed(HEAD + geo))


def meshed(geo: str, time_limit: float = TIME_LIMIT) -> meshio.Mesh:
    """What gmsh makes of a text, which may be anybody's: see `_script` for what is refused first.

    Parameters
    ----------
    time_limit : after which gmsh is stopped [s]

    Raises
    ------
    GeoError
        When gmsh finds a mistake in it, leaves no elements, or is not done in time.
    MeshError
        When gmsh cannot be run.
    OSError
        When the disk of the temporary files is full, of which gmsh says nothing.
    """
    with tempfile.TemporaryDirectory(prefix="lithofrac-") as name:
        folder = Path(name)
        (folder / "scene.geo").write_text(geo, encoding="utf-8")
        command = [*_gmsh(), "scene.geo", "-2", "-o", "scene.msh", "-noenv", "-v", "2"]
        own_home = {**os.environ, "HOME": name, "OMP_NUM_THREADS": "1"}
        try:
            done = subprocess.run(
                command, cwd=folder, env=own_home, capture_output=True, encoding="utf-8",
                errors="replace", timeout=time_limit,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise GeoError(f"gmsh was stopped after {time_limit:g} s; {ENDLESS}") from None
        except OSError as error:
            raise MeshError(f"gmsh could not be run: {error}") from None
        _refuse_full_disk(folder)
        if done.returncode != 0 or not (folder / "scene.msh").exists():
            said = [*done.stdout.splitlines(), *done.stderr.splitlines()]
            words = [line for line in said if line.strip() and not line.startswith("Warning")]
            raise GeoError(f"gmsh gave no mesh: {words[-1] if words else 'no message'}")
        wrong = [line for line in done.stderr.splitlines() if line.startswith("Error")]
        if wrong:  # it goes on after a mistake, and ends well
            words = wrong[0].partition(":")[2].strip()
            raise GeoError(f"gmsh gave no mesh: {words.removeprefix(NAMED)}")
        return read(folder / "scene.msh")


def _refuse_full_disk(folder: Path) -> None:
    """Refuse what gmsh has written to a disk without any room left: it may lack its end."""
    if shutil.disk_usage(folder).free == 0:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder.parent))


def read(path: Path) -> meshio.Mesh:
    """Read a .msh.

    Raises
    ------
    GeoError
        When meshio cannot.
    """
    said = io.StringIO()  # meshio prints empty lines, and goes on after a lost end
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            found = meshio.gmsh.read(path)
        if NOT_CLOSED in said.getvalue():
            raise meshio.ReadError(said.getvalue().removeprefix("Warning: "))
    except MISREAD as error:
        if NO_GROUP in str(error):
            raise GeoError(SAVED_ALL) from None
        words = one_line(error, 150) or type(error).__name__
        raise GeoError(f"no mesh that can be read, expected {FORMATS} ({words})") from None
    return found


def _gmsh() -> list[str]:
    """Command that starts gmsh: the one beside this Python, else the one on the path."""
    beside = Path(sys.executable).parent / "gmsh"
    if beside.exists():
        return [sys.executable, str(beside)]
    found = shutil.which("gmsh")
    if found is None:
        raise MeshError("gmsh is not installed: no program `gmsh` beside Python or on the path")
    return [found]


def _raw(read: meshio.Mesh) -> RawMesh:
    names = {(tag, dim): name for name, (tag, dim) in read.field_data.items()}
    triangles, bodies, lines = [], [], {}
    for block, tags in zip(read.cells, read.cell_data["gmsh:physical"], strict=True):
        if block.type == "triangle":
            triangles.append(block.data)
            bodies.append(tags)
        elif block.type == "line":
            for tag in np.unique(tags):
                lines.setdefault(names[tag, 1], []).append(block.data[tags == tag])
    if not triangles:
        raise MeshError("gmsh gave no triangles")
    tags, body = np.unique(np.concatenate(bodies), return_inverse=True)
    return RawMesh(
        nodes=read.points[:, :2],
        triangles=np.concatenate(triangles),
        body=body,
        body_names=tuple(names[tag, 2] for tag in tags),
        lines={name: np.concatenate(parts) for name, parts in lines.items()},
    )
