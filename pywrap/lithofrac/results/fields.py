"""Fields over the mesh as a VTU series with a .pvd that ParaView opens."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

import meshio
import numpy as np

from lithofrac.core import Run
from lithofrac.results.files import write_text, write_whole


def write_frame(path: Path, run: Run) -> None:
    """Write the mesh of now with displacement, velocity and element state as one VTU file.

    Elements that were cut are left out; copies of a node share its reference position.
    Stress and strain are in the frame that rotates with the material; SI units in the names.
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
    grid = meshio.Mesh(
        _with_zero(nodes),
        [("triangle", triangles[alive])],
        point_data=points,
        cell_data={name: [np.ascontiguousarray(values)] for name, values in cells.items()},
    )
    write_whole(path, lambda part: meshio.write(part, grid, file_format="vtu"))


def write_series(path: Path, frames: list[tuple[float, str]]) -> None:
    """Write the .pvd that lists the frames (time [s], file name relative to the .pvd)."""
    rows = "".join(
        f'    <DataSet timestep="{time:.9e}" part="0" file={quoteattr(name)}/>\n'
        for time, name in frames
    )
    text = (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n'
        f"  <Collection>\n{rows}  </Collection>\n</VTKFile>\n"
    )
    write_text(path, text)


def _with_zero(plane: np.ndarray) -> np.ndarray:
    """Append a zero third component, (n, 3)."""
    return np.column_stack([plane, np.zeros(len(plane))])
