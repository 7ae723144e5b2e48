"""Series of a run that cracks, read back by meshio and by VTK (pywrap/lithofrac/results/fields.py).

VTK reads what ParaView reads, but unpacked it is 570 MB: it is no requirement of the tests.
`pip install vtk` brings the tests that are skipped without it.
"""

import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import meshio
import numpy as np
import pandas as pd
import pytest
from fracture_models import brittle, pulled_bar, turned_bar, weakened

from lithofrac.analysis.frames import frame_times
from lithofrac.problem import Contact, Fracture
from lithofrac.results.fields import MODES
from lithofrac.run import simulate

FRAMES = 6
COLUMNS = ["crack", "mode", "time_s", "failure_factor"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Run of a bar that is pulled until it has parted."""
    bar = pulled_bar(
        weakened(turned_bar(0.8e-3, 0.3, 6e-3, 9e-3, jitter=0.25)),
        brittle(fracture_energy=1.0),
        speed=0.1,
        strain=1.5e-3,
        fracture=Fracture("inter_element"),
        contact=Contact(),
    )
    out = tmp_path_factory.mktemp("series")
    simulate(replace(bar, fields=FRAMES, records=60), out)
    return out


@pytest.fixture(scope="module")
def series(folder):
    """Rows (time, part, file) of the .pvd."""
    entries = ElementTree.parse(folder / "fields.pvd").getroot().iter("DataSet")
    return [(float(e.get("timestep")), int(e.get("part")), folder / e.get("file")) for e in entries]


@pytest.fixture(scope="module")
def cracks(folder):
    return pd.read_parquet(folder / "cracks.parquet")


def test_every_moment_has_the_mesh_and_the_cracks(folder, series):
    assert [part for _, part, _ in series] == FRAMES * [0, 1]
    assert all(path.is_file() for *_, path in series)
    assert len({moment for moment, *_ in series}) == FRAMES
    assert frame_times(folder) == [(moment, path) for moment, part, path in series if part == 0]


def test_arrays_are_named_with_their_unit(series):
    grid, lines = (meshio.read(path) for *_, path in series[-2:])
    assert set(grid.point_data) == {"displacement_m", "velocity_m_s", "contact_force_N"}
    assert {"stress_Pa", "tensile_strength_Pa", "crack_angle_rad", "strain"} <= set(grid.cell_data)
    assert set(lines.point_data) == {"displacement_m"}
    assert set(lines.cell_data) == set(COLUMNS)


def cells_of(path) -> int:
    """Cells that a file says it has; meshio cannot read one that has none."""
    return int(ElementTree.parse(path).find(".//Piece").get("NumberOfCells"))


def test_lines_are_both_faces_of_the_cracks_opened_by_then(series, cracks):
    """One row a face; the first frame has none, the last has all."""
    counts = []
    for moment, part, path in series:
        if part == 0:
            continue
        opened = cracks[cracks["time_s"] <= moment * (1 + 1e-9)]
        counts.append(cells_of(path))
        if opened.empty:
            continue
        lines = meshio.read(path)
        found = {name: values[0] for name, values in lines.cell_data.items()}
        found["mode"] = np.array(MODES)[found["mode"]]
        rows = sorted(zip(*(found[name] for name in COLUMNS), strict=True))
        expected = opened[COLUMNS].itertuples(index=False, name=None)
        assert rows == sorted(2 * list(expected))
    assert counts[0] == 0
    assert counts[-1] == 2 * len(cracks) > 0


def test_faces_move_with_the_mesh_and_apart(series):
    """Each end of a face is a node of the mesh, and moves as that node; pulled, cracks gape."""
    grid, lines = (meshio.read(path) for *_, path in series[-2:])
    moved = [part.points + part.point_data["displacement_m"] for part in (grid, lines)]
    distance = np.linalg.norm(moved[1][:, None] - moved[0][None], axis=2).min(axis=1)
    assert distance.max() < 1e-12
    height = moved[1][lines.cells[0].data].mean(axis=1)[:, 1]
    faces = pd.Series(height).groupby(lines.cell_data["crack"][0])
    assert (faces.max() - faces.min()).max() > 1e-5


@pytest.fixture(scope="module")
def vtk_read():
    """vtk_read(path) -> vtkUnstructuredGrid; fails on whatever the reader complains of."""
    why = "VTK is not installed (pip install vtk, 570 MB)"
    xml = pytest.importorskip("vtkmodules.vtkIOXML", reason=why)

    def read(path):
        said = []
        reader = xml.vtkXMLUnstructuredGridReader()
        for event in ("ErrorEvent", "WarningEvent"):
            reader.AddObserver(event, lambda _, event: said.append(event))
        reader.SetFileName(str(path))
        reader.Update()
        assert not said
        return reader.GetOutput()

    return read


def test_vtk_finds_triangles_and_lines(series, vtk_read):
    triangle, line = 5, 3  # VTK_TRIANGLE, VTK_LINE
    for _, part, path in series:
        grid = vtk_read(path)
        kinds = {grid.GetCellType(i) for i in range(grid.GetNumberOfCells())}
        assert grid.GetNumberOfCells() == cells_of(path)
        assert kinds == ({(triangle, line)[part]} if cells_of(path) else set())


def test_vtk_finds_arrays_and_the_names_of_their_components(series, vtk_read):
    grid = vtk_read(series[-2][2])
    stress = grid.GetCellData().GetArray("stress_Pa")
    assert [stress.GetComponentName(i) for i in range(4)] == ["xx", "yy", "zz", "xy"]
    strength = grid.GetCellData().GetArray("tensile_strength_Pa")
    assert [strength.GetComponentName(i) for i in range(3)] == ["axis_1", "axis_2", "zz"]
    read = meshio.read(series[-2][2]).cell_data["stress_Pa"][0]
    assert np.array_equal(read[7], stress.GetTuple(7))


def test_one_warp_of_vtk_deforms_mesh_and_cracks_alike(series, vtk_read):
    general = pytest.importorskip("vtkmodules.vtkFiltersGeneral")
    warped = []
    for *_, path in series[-2:]:
        warp = general.vtkWarpVector()
        warp.SetInputData(vtk_read(path))
        warp.SetInputArrayToProcess(0, 0, 0, 0, "displacement_m")  # 0: of points
        warp.SetScaleFactor(10.0)
        warp.Update()
        points = warp.GetOutput().GetPoints()
        warped.append(np.array([points.GetPoint(i) for i in range(points.GetNumberOfPoints())]))
    distance = np.linalg.norm(warped[1][:, None] - warped[0][None], axis=2).min(axis=1)
    assert distance.max() < 1e-12
