"""Fields over the mesh, and the cracks as lines, as a VTU series with a .pvd that ParaView opens.

A series has the mesh as part 0 and, where cracks may open, their faces as part 1. Both stand at
reference positions with `displacement_m`: one "Warp By Vector" deforms both alike.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from xml.sax.saxutils import quoteattr

import meshio
import numpy as np
import pandas as pd

from lithofrac.core import Run
from lithofrac.results.files import write_text, write_whole

TENSOR, AXES = ("xx", "yy", "zz", "xy"), ("axis_1", "axis_2", "zz")
COMPONENTS = {
    "stress_Pa": TENSOR,
    "strain": TENSOR,
    "tensile_strength_Pa": AXES,
    "fracturing_strain": AXES,
}  # names that ParaView shows for the components of an array
MODES = ("tensile", "compressive_dilation")  # the numbers 0 and 1 of the field `mode`


def write_frame(path: Path, run: Run, numbered: bool = False) -> None:
    """Write the mesh of now with displacement, velocity and element state as one VTU file.

    Elements that were cut are left out; copies of a node share its reference position.
    Stress and strain are in the frame that rotates with the material; SI units in the names.

    Parameters
    ----------
    numbered : also the numbers that messages give to nodes and elements, from 1
    """
    nodes, triangles, body, alive = run.mesh()
    displacement, velocity, _ = run.nodes()
    state = run.elements(np.flatnonzero(alive))
    points = {"displacement_m": _with_zero(displacement), "velocity_m_s": _with_zero(velocity)}
    cells = {
        "stress_Pa": state.stress,
        "strain": state.strain,
        "plastic_strain": state.plastic_strain,
        "tensile_strength_Pa": state.tensile_strength,
        "fracturing_strain": state.fracturing_strain,
        "crack_angle_rad": state.crack_angle,
        "body": body[alive],
    }
    if run.problem.contact is not None:
        points["contact_force_N"] = _with_zero(run.contact_forces())
    if run.problem.fracture is not None:
        cells["failure_factor"] = run.failure()[0][alive]
    if numbered:
        points["node"] = np.arange(1, len(nodes) + 1)
        cells["element"] = np.flatnonzero(alive) + 1
    grid = meshio.Mesh(
        _with_zero(nodes),
        [("triangle", triangles[alive])],
        point_data=points,
        cell_data={name: [np.ascontiguousarray(values)] for name, values in cells.items()},
    )
    write_whole(path, lambda part: _write(part, grid))


def write_cracks(
    path: Path, nodes: np.ndarray, displacement: np.ndarray, edges: np.ndarray, rows: pd.DataFrame
) -> None:
    """Write the faces of cracks as lines with what is known of their cracks, one VTU file.

    Parameters
    ----------
    path : file to write
    nodes : (n, 2) reference positions of a mesh [m]
    displacement : (n, 2) [m]
    edges : (k, 2) nodes of each face; the two faces of a crack have nodes of their own
    rows : (k) rows of the table of cracks, one an edge; k = 0 writes an empty file
    """
    used, ends = np.unique(edges, return_inverse=True)
    cells = {
        "crack": rows["crack"].to_numpy(int),
        "mode": (rows["mode"] == MODES[1]).to_numpy(int),
        "time_s": rows["time_s"].to_numpy(float),
        "failure_factor": rows["failure_factor"].to_numpy(float),
    }
    grid = meshio.Mesh(
        _with_zero(nodes[used]),
        [("line", ends.reshape(-1, 2))],
        point_data={"displacement_m": _with_zero(displacement[used])},
        cell_data={name: [values] for name, values in cells.items()},
    )
    write_whole(path, lambda part: _write(part, grid))


def write_series(path: Path, frames: list[tuple]) -> None:
    """Write the .pvd that lists the frames.

    A frame is its time [s] and the names of its files relative to the .pvd, one a part.
    """
    rows = "".join(
        f'    <DataSet timestep="{time:.9e}" part="{part}" file={quoteattr(name)}/>\n'
        for time, *names in frames
        for part, name in enumerate(names)
    )
    text = (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n'
        f"  <Collection>\n{rows}  </Collection>\n</VTKFile>\n"
    )
    write_text(path, text)


def _write(path: Path, grid: meshio.Mesh) -> None:
    """Write a VTU file, and in it the names of components, which meshio leaves out."""
    meshio.write(path, grid, file_format="vtu")
    tree = ElementTree.parse(path)
    for array in tree.iter("DataArray"):
        for number, name in enumerate(COMPONENTS.get(array.get("Name"), ())):
            array.set(f"ComponentName{number}", name)
    tree.write(path, xml_declaration=True, encoding="utf-8")


def _with_zero(plane: np.ndarray) -> np.ndarray:
    """Append a zero third component, (n, 3)."""
    return np.column_stack([plane, np.zeros(len(plane))])
