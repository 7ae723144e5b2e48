"""A results folder of the strip punch whose damage, strain and cracks are known exactly."""

import json

import meshio
import numpy as np
import pandas as pd
import yaml

from lithofrac.problem import Mesh
from lithofrac.results.fields import write_series

SIDE, STRIP = 8, 2  # mm: of the square block, and of the strip on its middle
CRACKS = [(4.0, 6.0, 4.0, 3.0), (4.0, 4.0, 4.0, 1.0), (3.0, 8.0, 2.0, 7.0), (0.0, 1.0, 2.0, 1.0)]
#        on the axis, overlapping it, from an edge of the strip, far away and level: x1 y1 x2 y2


def block(squares: int = SIDE) -> Mesh:
    """Rock of 8 x 8 mm, so many squares a side, two triangles each."""
    x, y = np.meshgrid(*2 * [np.linspace(0.0, SIDE, squares + 1)])
    number = np.arange((squares + 1) ** 2).reshape(squares + 1, squares + 1)
    a, b, c, d = (
        part.ravel()
        for part in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    )
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    nodes = 1e-3 * np.column_stack([x.ravel(), y.ravel()])
    body = np.zeros(len(triangles), dtype=np.int32)
    return Mesh(nodes, triangles.astype(np.int32), body, ("rock",))


def write_field(path, mesh, plastic=0.0, strain=None, opening=0.0, displacement=None, stress=None):
    """One frame; strain (m, 4) and stress (m, 4) as the core has them, all else per element."""
    n, m = len(mesh.nodes), len(mesh.triangles)
    zero = np.zeros((n, 1))
    moved = np.zeros((n, 2)) if displacement is None else displacement
    grid = meshio.Mesh(
        np.hstack([mesh.nodes, zero]), [("triangle", mesh.triangles)],
        point_data={"displacement_m": np.hstack([moved, zero])},
        cell_data={
            "plastic_strain": [np.broadcast_to(plastic, m).astype(float)],
            "body": [mesh.body],
            "stress_Pa": [np.zeros((m, 4)) if stress is None else stress],
            "strain": [np.zeros((m, 4)) if strain is None else strain],
            "fracturing_strain": [np.outer(np.broadcast_to(opening, m), [1.0, 0.0, 0.0])],
        },
    )  # fmt: skip
    meshio.write(path, grid)


def as_punch(folder, gf=60.0, compression=True, cracks=None):
    """Give a folder of `make_run` the scene, three frames, gauges and cracks of a punch.

    The first frame is whole. In the second, elements beside the edges of the strip have yielded.
    In the last, at the end, two flanks one element wide run from the edges to the axis, 4 mm
    below. There the plastic strain is 0.1, with -0.06 and 0.04 as principal values. Below, the
    column on the axis is open by 0.02.
    """
    mesh = block()
    mesh.save(folder / "mesh.npz")
    x, y = 1e3 * mesh.centroids().T
    history = pd.read_parquet(folder / "history.parquet")
    end = float(history["time_s"].iloc[-1])
    (folder / "fields").mkdir()
    aside, depth = np.abs(x - 0.5 * SIDE), SIDE - y
    write_field(folder / "fields" / "frame_0000.vtu", mesh)
    corner = (np.abs(aside - 1.0) < 0.5) & (depth < 1.0)
    write_field(folder / "fields" / "frame_0001.vtu", mesh, plastic=1e-4 * corner * (2.0 - depth))
    flank = (np.abs(aside - (1.0 - 0.25 * depth)) < 0.4) & (depth < 4.0)
    axial = (aside < 1.0) & (depth > 4.0)
    strain = np.zeros((len(x), 4))
    strain[flank, :2] = 0.04, -0.06
    strain[axial, 0] = 0.02
    write_field(
        folder / "fields" / "frame_0002.vtu", mesh, 0.1 * flank, strain, opening=0.02 * axial
    )
    times = [0.0, 0.1 * end, end]
    write_series(
        folder / "fields.pvd", [(t, f"fields/frame_{i:04d}.vtu") for i, t in enumerate(times)]
    )
    _write_gauges(folder, history)
    if cracks is not None:
        _write_cracks(folder, cracks, 0.05 * end)
    case = yaml.safe_load((folder / "case.yaml").read_text())
    case["material"] |= {"fracture_energy_J_m2": float(gf), "compression": compression}
    case["scene"] |= {
        "width_mm": float(SIDE), "block_height_mm": float(SIDE), "strip_width_mm": float(STRIP)
    }  # fmt: skip
    (folder / "case.yaml").write_text(yaml.safe_dump(case))
    summary = json.loads((folder / "summary.json").read_text())
    summary |= {"time_step_min_s": 1e-8, "time_step_continuum_s": 1e-8}
    (folder / "summary.json").write_text(json.dumps(summary))
    return folder


def _write_gauges(folder, history):
    """Edge of the strip yields from a tenth of the run on, the axis from two tenths."""
    end, rows = float(history["time_s"].iloc[-1]), []
    for probe, share in (("strip_edge", 0.1), ("axis", 0.2)):
        plastic = np.where(history["time_s"] >= share * end * (1 - 1e-9), 1e-4, 0.0)
        strengths = {f"tensile_strength_{i}_MPa": 4.0 for i in (1, 2, 3)}
        rows.append(
            pd.DataFrame(
                {"probe": probe, "time_s": history["time_s"], "plastic_strain": plastic}
            ).assign(**strengths)
        )
    pd.concat(rows).to_parquet(folder / "probes.parquet")


def _write_cracks(folder, cracks, time_s):
    table = pd.DataFrame(cracks, columns=["x1_mm", "y1_mm", "x2_mm", "y2_mm"])
    length = np.hypot(table["x2_mm"] - table["x1_mm"], table["y2_mm"] - table["y1_mm"])
    table.assign(time_s=time_s, length_mm=length, mode="tensile", compressive_share=0.1).to_parquet(
        folder / "cracks.parquet"
    )
