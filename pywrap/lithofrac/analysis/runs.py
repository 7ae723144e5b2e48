"""Results folders read back: what a run was, and what it gave."""

import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.analysis.bench import is_bench
from lithofrac.analysis.frames import Frame, last_frame
from lithofrac.analysis.reading import Summary, read_summary, read_table
from lithofrac.analysis.strength import Peak, first_peak
from lithofrac.config.contact import ROCK
from lithofrac.config.material import Material
from lithofrac.config.yaml_file import read_yaml
from lithofrac.data import DataError
from lithofrac.errors import FileError
from lithofrac.problem import Mesh

# Columns that every run has written, whichever version made it.
LEDGER = (
    "time_s",
    "kinetic_J",
    "elastic_J",
    "compressive_dissipation_J",
    "fracture_dissipation_J",
    "external_J",
    "damping_J",
    "residual_J",
)
SECTIONS = ("material", "scene", "loading")  # that every case has
ENDS = ("x1_mm", "y1_mm", "x2_mm", "y2_mm")  # of a crack


@dataclass(frozen=True)
class Run:
    """One results folder; files are read when they are asked for."""

    folder: Path

    @property
    def name(self) -> str:
        """Name of the case, which is the name of its folder."""
        return self.folder.name

    @property
    def family(self) -> str:
        """Name without confinement and what follows it: all runs of one test."""
        return re.sub(r"_p\d.*$", "", self.name)

    @cached_property
    def summary(self) -> Summary:
        """`summary.json`."""
        return read_summary(self.folder / "summary.json")

    @cached_property
    def case(self) -> dict:
        """The case as it was run (`case.yaml`)."""
        path = self.folder / "case.yaml"
        values = read_yaml(path)
        for key in SECTIONS:
            if not isinstance(values.get(key, {}), dict):
                raise FileError(f"{path}: {key}: expected that section of a case that was run")
        if not isinstance(values.get("scene", {}).get("kind"), str):
            raise FileError(f"{path}: scene.kind: expected a text, as in a case that was run")
        return values

    @property
    def has_axial_stress(self) -> bool:
        """Whether the history tells an axial stress; a wave in a bar and a hole under traction have
        none."""
        return "axial_stress_MPa" in self.records

    @cached_property
    def records(self) -> pd.DataFrame:
        """`history.parquet`, all of it."""
        return read_table(self.folder / "history.parquet", "time_s")

    @cached_property
    def history(self) -> pd.DataFrame:
        """`history.parquet` of the axial loading: from the last row without axial strain on."""
        axial = ("time_s", "axial_strain", "axial_stress_MPa")
        table = read_table(self.folder / "history.parquet", *axial)
        before = np.flatnonzero(table["axial_strain"] <= 0.0)
        return table.iloc[before[-1] if before.size else 0 :].reset_index(drop=True)

    @cached_property
    def energy(self) -> pd.DataFrame:
        """`energy.parquet`."""
        return read_table(self.folder / "energy.parquet", *LEDGER)

    @cached_property
    def probes(self) -> pd.DataFrame:
        """`probes.parquet`, a row a probe and record."""
        return read_table(self.folder / "probes.parquet", "time_s", "plastic_strain")

    @property
    def discrete(self) -> bool:
        """Whether cracks could open in the run."""
        return (self.folder / "cracks.parquet").is_file()

    @property
    def fracture(self) -> str:
        """How cracks are inserted: off, inter_element or intra_element."""
        return self.case.get("fracture", {}).get("mode", "off")

    @cached_property
    def cracks(self) -> pd.DataFrame:
        """`cracks.parquet`, a row for each opened edge, in the order of opening."""
        if not self.discrete:
            raise DataError(
                f"{self.folder}: holds no cracks.parquet, expected a run with discrete cracks"
            )
        table = read_table(self.folder / "cracks.parquet", "time_s", *ENDS, empty=True)
        return table.sort_values("time_s", kind="stable", ignore_index=True)

    @cached_property
    def last_frame(self) -> Frame:
        """Mesh and fields at the end."""
        return last_frame(self.folder)

    def is_rock(self, frame: Frame) -> np.ndarray:
        """Which elements of a frame of this run are of the specimen, (m,) bool.

        In a geometry of one's own: those of the material of the case.
        """
        names = Mesh.load(self.folder / "mesh.npz").body_names
        if self.test == "gmsh_file":
            others = self.case["scene"].get("materials", {})
            return np.isin(frame.body, [i for i, name in enumerate(names) if name not in others])
        return frame.body == names.index(ROCK)

    @cached_property
    def rock(self) -> Material:
        """Material of the specimen."""
        return Material.from_values(self.case["material"], str(self.folder / "case.yaml"))

    @property
    def test(self) -> str:
        """Kind of the scene: triaxial, plane_strain, ..."""
        return self.case["scene"]["kind"]

    @property
    def axisymmetric(self) -> bool:
        """Whether forces and energies are per radian instead of per metre of depth."""
        return self.test == "triaxial" or bool(self.case["scene"].get("axisymmetric", False))

    @property
    def confinement_MPa(self) -> float:
        """Lateral pressure at the start of axial loading."""
        return float(self.case["loading"].get("confinement_MPa", 0.0))

    @property
    def stiffness(self) -> float:
        """Lateral stiffness over Young's modulus; 0 is a soft pressure."""
        return float(self.case["loading"].get("lateral_stiffness_over_young", 0.0))

    @cached_property
    def peak(self) -> Peak | None:
        """First peak of the axial stress [MPa], or None."""
        return first_peak(self.history["axial_strain"], self.history["axial_stress_MPa"])


def find_runs(paths: list[Path]) -> list[Run]:
    """Runs of folders, or of files that lie in them; each once, in the order given.

    Curves of the bench among the files are left out.
    """
    paths = [Path(path) for path in paths if not is_bench(path)]
    folders = [path if path.is_dir() else path.parent for path in paths]
    return [Run(folder) for folder in dict.fromkeys(folders)]


def only_run(paths: list[Path], kind: str) -> Run:
    """The run of folders or files of which there must be one, for a plot of a kind.

    Raises
    ------
    DataError
        When there are several, or none.
    """
    runs = find_runs(paths)
    if len(runs) != 1:
        raise DataError(f"plot {kind}: {len(runs)} runs, expected one")
    return runs[0]
