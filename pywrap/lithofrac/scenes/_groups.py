"""From what meshio read to bodies and boundaries, or one sentence on what is not right."""

import meshio
import numpy as np

from lithofrac.config.element_count import MOST_ELEMENTS
from lithofrac.config.errors import ConfigError
from lithofrac.config.gmsh_file import MESH
from lithofrac.scenes._gmsh import RawMesh

KINDS = {1: "curve", 2: "surface"}  # dimension -> words
TYPES = {"line": 1, "triangle": 2}  # that are used; a vertex is nobody's boundary
FARTHEST = 1e12  # units of length; beyond, areas overflow
FLAT = 1e-9  # of the extent: z of a plane mesh


def groups(read: meshio.Mesh, named: str) -> RawMesh:
    """Bodies and boundaries of a mesh, by the names of its physical groups.

    Parameters
    ----------
    named : key and value that name the file, for messages

    Raises
    ------
    ConfigError
        Where groups are missing or empty, or the mesh is not one of plane triangles.
    """
    wrong = _wrong_types(read) or _wrong_plane(read)
    if wrong:
        raise ConfigError(f"{named}: {wrong}")
    names = {(int(tag), int(dim)): name for name, (tag, dim) in read.field_data.items()}
    tags = read.cell_data.get("gmsh:physical", [np.zeros(len(b.data)) for b in read.cells])
    cells = {
        dim: _of_type(read, tags, kind) for kind, dim in TYPES.items()
    }  # dimension -> cells, tags
    triangles, body = cells[2]
    wrong = _wrong_groups(names, cells)
    if wrong.endswith("is empty") and named.endswith(MESH):
        wrong += "; in format 4 a curve or surface counts for one group alone, expected format 2.2"
    wrong = wrong or _wrong_triangles(read.points[:, :2], triangles)
    if wrong:
        raise ConfigError(f"{named}: {wrong}")
    numbers, body = np.unique(body, return_inverse=True)
    edges, tag = cells[1]
    lines = {name: edges[tag == number] for (number, dim), name in names.items() if dim == 1}
    found = RawMesh(
        nodes=read.points[:, :2],
        triangles=triangles,
        body=body,
        body_names=tuple(names[int(number), 2] for number in numbers),
        lines=lines,
    )
    wrong = _wrong_lines(found)
    if wrong:
        raise ConfigError(f"{named}: {wrong}")
    return found


def _of_type(read: meshio.Mesh, tags: list, kind: str) -> tuple[np.ndarray, np.ndarray]:
    chosen = [
        (block.data, tag) for block, tag in zip(read.cells, tags, strict=True) if block.type == kind
    ]
    if not chosen:
        return np.zeros((0, TYPES[kind] + 1), int), np.zeros(0, int)
    return (
        np.concatenate([data for data, _ in chosen]).astype(int),
        np.concatenate([tag for _, tag in chosen]).astype(int),
    )


def _wrong_types(read: meshio.Mesh) -> str:
    found = {block.type for block in read.cells if len(block.data)}
    others = sorted(found - {*TYPES, "vertex"})
    if others:
        return f"holds elements of type {others[0]}, expected triangles of three nodes alone"
    if "triangle" not in found:
        return "holds no triangles, expected physical surfaces that are meshed"
    return ""


def _wrong_plane(read: meshio.Mesh) -> str:
    if not np.isfinite(read.points).all():
        return "holds nodes at no place, expected numbers"
    if np.abs(read.points).max() > FARTHEST:
        return f"holds a node at {np.abs(read.points).max():g}, expected at most {FARTHEST:g}"
    z, extent = read.points[:, 2], np.ptp(read.points, axis=0).max()
    if np.abs(z).max() > FLAT * extent:
        return f"reaches from z = {z.min():g} to {z.max():g}, expected the plane z = 0"
    return ""


def _wrong_groups(names: dict, cells: dict) -> str:
    """Groups without a name or without elements, and elements in none or in two of them."""
    triangles, tags = cells[2]
    if not any(dim == 2 for _, dim in names):
        return (
            "has no physical surface with a name, expected one for each body, as in "
            'Physical Surface("rock") = {1};'
        )
    unnamed = [tag for tag in np.unique(tags) if (int(tag), 2) not in names]
    if unnamed:
        count = np.count_nonzero(tags == unnamed[0])
        said = f"{count} triangles are in no physical surface with a name, expected all in one"
        return said if unnamed[0] else f"{said} (saved with Mesh.SaveAll = 0)"
    for (tag, dim), name in names.items():
        if dim in KINDS and not np.any(cells[dim][1] == tag):
            return f"the physical {KINDS[dim]} {name!r} is empty"
    twice = len(triangles) - len(np.unique(np.sort(triangles, axis=1), axis=0))
    if twice:
        return f"{twice} triangles are in two physical surfaces, expected each in one"
    return ""


def _wrong_triangles(nodes: np.ndarray, triangles: np.ndarray) -> str:
    if len(triangles) > MOST_ELEMENTS:
        return f"{len(triangles):.2g} elements, expected at most {MOST_ELEMENTS}"
    a, b, c = (nodes[triangles[:, i]] for i in range(3))
    ab, ac = b - a, c - a
    flat = ab[:, 0] * ac[:, 1] == ab[:, 1] * ac[:, 0]
    if flat.any():
        x, y = a[np.argmax(flat)]
        return f"the triangle at ({x:g}, {y:g}) has no area"
    return ""


def _wrong_lines(raw: RawMesh) -> str:
    t = np.sort(raw.triangles, axis=1)
    n = len(raw.nodes)
    sides = np.unique(np.concatenate([t[:, i] * n + t[:, j] for i, j in ((0, 1), (0, 2), (1, 2))]))
    for name, edges in raw.lines.items():
        low, high = edges.min(axis=1), edges.max(axis=1)
        if not np.isin(low * n + high, sides).all():
            return f"the physical curve {name!r} is not made of sides of the triangles"
    return ""
