"""Fields of a run read back: the mesh at one moment, which grows as cracks open it."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, replace
from pathlib import Path

import meshio
import numpy as np

from lithofrac.config.errors import one_line
from lithofrac.errors import FileError
from lithofrac.plain_file import refuse_other

MM = 1e3  # millimetres in a metre


@dataclass(frozen=True)
class Frame:
    """Mesh and fields at one moment; lengths in mm.

    Attributes
    ----------
    time_s : moment
    nodes : (n, 2) reference positions; copies of a split node share theirs exactly
    displacement : (n, 2)
    triangles : (m, 3) node indices; elements that were cut are left out
    body : (m,) index of the body
    plastic_strain : (m,) effective plastic strain [-]
    """

    time_s: float
    nodes: np.ndarray
    displacement: np.ndarray
    triangles: np.ndarray
    body: np.ndarray
    plastic_strain: np.ndarray

    @classmethod
    def load(cls, path: Path, time_s: float) -> "Frame":
        """Read one `fields/frame_*.vtu`."""
        if not path.is_file():
            raise FileNotFoundError(2, "No such file or directory", str(path))
        try:
            grid = meshio.vtu.read(path)
            cells = {name: values[0] for name, values in grid.cell_data.items()}
            return cls(
                time_s,
                MM * grid.points[:, :2],
                MM * grid.point_data["displacement_m"][:, :2],
                grid.cells[0].data,
                np.ravel(cells["body"]),
                np.ravel(cells["plastic_strain"]),
            )
        except Exception:  # meshio has dozens, some of them without words
            size = path.stat().st_size
            raise FileError(f"{path}: {size} bytes that are no fields of a run in VTU") from None

    def moved(self, magnification: float = 1.0) -> np.ndarray:
        """Deformed positions, displacements magnified, (n, 2) [mm]."""
        return self.nodes + magnification * self.displacement

    def part(self, chosen: np.ndarray) -> "Frame":
        """The same with a choice of its elements, (m,) bool, and the nodes that they use."""
        used, triangles = np.unique(self.triangles[chosen], return_inverse=True)
        return replace(
            self,
            nodes=self.nodes[used],
            displacement=self.displacement[used],
            triangles=triangles.reshape(-1, 3),
            body=self.body[chosen],
            plastic_strain=self.plastic_strain[chosen],
        )

    def centroids(self) -> np.ndarray:
        """Element centroids in the reference state, (m, 2) [mm]."""
        return self.nodes[self.triangles].mean(axis=1)

    def areas(self) -> np.ndarray:
        """Element areas in the reference state, (m,) [mm2]."""
        a, b, c = (self.nodes[self.triangles[:, i]] for i in range(3))
        ab, ac = b - a, c - a
        return 0.5 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])

    def boundary(self) -> np.ndarray:
        """Edges of one triangle only, (k, 2) nodes, material on their left.

        Both faces of a crack are among them, each with nodes of its own.
        """
        edges = np.concatenate([self.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
        _, first, count = np.unique(
            np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True
        )
        return edges[np.sort(first[count == 1])]


def frame_times(folder: Path) -> list[tuple[float, Path]]:
    """Moments [s] at which a run has written fields and their files, as its `fields.pvd` says.

    Raises
    ------
    FileNotFoundError
        When the run has written no fields.
    FileError
        When the list of them is damaged, or empty.
    """
    path = folder / "fields.pvd"
    if path.exists():
        refuse_other(path, "a list of fields")
    try:
        series = ElementTree.parse(path).getroot().iter("DataSet")
        found = sorted(
            (float(entry.attrib["timestep"]), folder / entry.attrib["file"])
            for entry in series
            if entry.get("part") == "0"  # the others are lines of cracks
        )
    except (ElementTree.ParseError, ValueError, KeyError) as error:
        raise FileError(f"{path}: expected a list of fields ({one_line(error, 200)})") from None
    if not found:
        raise FileError(f"{path}: names no fields, expected those of a run")
    return found


def last_frame(folder: Path) -> Frame:
    """Fields at the last moment that a run has written; raises as `frame_times`."""
    time_s, path = frame_times(folder)[-1]
    return Frame.load(path, time_s)
