"""Curves of the material-point bench read back (`lithofrac point`)."""

import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import pandas as pd

from lithofrac.analysis.reading import read_table
from lithofrac.analysis.strength import Peak, first_peak
from lithofrac.config.material import Material

NAME = re.compile(r"^(?P<test>\w+)_p(?P<confinement>\d+(\.\d+)?)$")


@dataclass(frozen=True)
class Bench:
    """One curve, kept as `ROCK/TEST_pCONFINEMENT.parquet`."""

    path: Path

    @property
    def rock(self) -> str:
        """Name of the rock, a file in `configs/materials/`."""
        return self.path.parent.name

    @property
    def test(self) -> str:
        """Test that was driven: triaxial, plane_strain, ..."""
        return self._name["test"]

    @property
    def confinement_MPa(self) -> float:
        """Confinement of the test."""
        return float(self._name["confinement"])

    @cached_property
    def curve(self) -> pd.DataFrame:
        """The curve, columns as `point.drive` gives them."""
        return read_table(self.path, "axial_strain", "axial_stress_MPa")

    @cached_property
    def material(self) -> Material:
        """The rock."""
        return Material.load(self.rock)

    @cached_property
    def peak(self) -> Peak | None:
        """First peak of the axial stress [MPa], or None."""
        return first_peak(self.curve["axial_strain"], self.curve["axial_stress_MPa"])

    @property
    def first_yield_MPa(self) -> float:
        """Axial stress at which the plastic strain leaves 0; NaN without two plastic rows.

        From the first two plastic rows back to no plastic strain, so that the step of the curve
        enters with its square only.
        """
        plastic = self.curve[self.curve["plastic_strain"] > 0.0].iloc[:2]
        if len(plastic) < 2:
            return float("nan")
        (near, far), (stress, later) = plastic["plastic_strain"], plastic["axial_stress_MPa"]
        return float(stress - near * (later - stress) / (far - near))

    @property
    def residual_MPa(self) -> float:
        """Axial stress at the end of the curve."""
        return float(self.curve["axial_stress_MPa"].iloc[-1])

    @property
    def _name(self) -> re.Match:
        found = NAME.match(self.path.stem)
        if found is None:
            raise ValueError(f"{self.path}: file name, expected TEST_pCONFINEMENT.parquet")
        return found


def is_bench(path: Path) -> bool:
    """Whether a file is a curve of the bench, by its name."""
    return Path(path).suffix == ".parquet" and NAME.match(Path(path).stem) is not None


def find_bench(paths: list[Path], test: str | None = None) -> list[Bench]:
    """Curves among files, of one test or of all, by rock, test and confinement."""
    curves = [Bench(Path(path)) for path in paths if is_bench(path)]
    curves = [curve for curve in curves if test in (None, curve.test)]
    return sorted(curves, key=lambda curve: (curve.rock, curve.test, curve.confinement_MPa))
