"""A rock or a metal: keys of a material file, and the SI numbers the core reads.

The law is Klerck, Sellers & Owen 2004, section 2: Mohr-Coulomb with mobilised cohesion, friction
and dilation (eqs 6-8, Table 1), cut by three tension planes that soften over the crack band
(eqs 14-18), coupled by eqs 19-20. Where the paper leaves a choice open, the first option named
below is the default.
"""

import os
from itertools import pairwise
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, ValidationError, ValidationInfo, field_validator, model_validator

from lithofrac.config.base import (
    GPA,
    MM,
    MPA,
    Density,
    FractureEnergy,
    Length,
    Modulus,
    PlasticStrain,
    Pressure,
    Section,
    Strength,
)
from lithofrac.config.errors import ConfigError, one_line, sentences, suggestion
from lithofrac.config.regularise import softening_onset, width_limit
from lithofrac.config.yaml_file import read_yaml

PACKAGED = Path(__file__).parents[1] / "_configs"  # copy of configs/ that is installed

Angle = Annotated[float, Field(ge=0.0, lt=90.0)]
Angles = tuple[Angle, ...]
COLUMNS = ("plastic_strain", "cohesion_MPa", "friction_angle_deg", "dilation_angle_deg")
TENSION = ("tensile_strength_MPa", "fracture_energy_J_m2")


class Material(Section):
    """Material of one body.

    The four columns of the hardening table have equal lengths; between their rows the law is
    linear in cohesion and in the angles, and flat beyond both ends.
    """

    expected: ClassVar[str] = "the name of a material, or its keys"

    title: str = ""
    """What the material is and where its numbers come from."""
    elastic: bool = False
    """No yield check at all; the strength keys may then be left out."""
    compression: bool = True
    """Mohr-Coulomb planes in force; `false` leaves tension alone and needs no table."""
    young_modulus_GPa: Modulus
    """Young's modulus, one for tension and compression."""
    poisson_ratio: float = Field(ge=0.0, lt=0.5)
    """Poisson's ratio."""
    density_kg_m3: Density
    """Mass density."""
    tensile_strength_MPa: Strength | None = Field(default=None, validate_default=True)
    """Direct tensile strength; needed unless `elastic`."""
    fracture_energy_J_m2: FractureEnergy | None = Field(default=None, validate_default=True)
    """Energy Gf that opening a unit of crack area uses up."""
    plastic_strain: tuple[PlasticStrain, ...] | None = Field(
        default=None, validate_default=True, strict=False
    )
    """Effective plastic strain (eq. 7), strictly increasing."""
    cohesion_MPa: tuple[Pressure, ...] | None = Field(
        default=None, validate_default=True, strict=False
    )
    """Mobilised cohesion in each row."""
    friction_angle_deg: Angles | None = Field(default=None, validate_default=True, strict=False)
    """Mobilised friction angle in each row."""
    dilation_angle_deg: Angles | None = Field(default=None, validate_default=True, strict=False)
    """Angle of the flow potential (eq. 8) in each row: how much the rock swells as it yields."""
    hardening: Literal["compressive", "total"] = "compressive"
    """Which inelastic strain feeds eq. 7: Mohr-Coulomb flow only, or all of it."""
    coupling: Literal["implicit", "explicit"] = "implicit"
    """Tension planes are checked against their softened, or against their old strength."""
    band_width: Literal["sqrt_2A", "sqrt_A"] = "sqrt_2A"
    """Crack band width h_c of a triangle of area A."""
    reference_size_mm: Length | None = None
    """Crack band width for which the table holds as it stands. In an element of width h_c the part
    beyond the largest uniaxial strength is stretched by reference_size_mm / h_c, so that a
    compressive band uses up the same energy per area in every mesh. Left out: the table holds in
    every element, as in the paper."""

    @field_validator(*TENSION, *COLUMNS)
    @classmethod
    def _needed(cls, value, info: ValidationInfo):
        """Refuse a strength key that is absent though the material can yield."""
        elastic = info.data.get("elastic", False)
        unused = not info.data.get("compression", True) and info.field_name in COLUMNS
        if value is None and not elastic and not unused:
            raise ValueError("missing key, only a material with `elastic: true` may leave it out")
        return value

    @field_validator("plastic_strain")
    @classmethod
    def _increasing(cls, value):
        if value is not None and len(value) == 0:
            raise ValueError("expected at least one row")
        if value is not None and any(b <= a for a, b in pairwise(value)):
            raise ValueError(f"expected values that increase strictly, got {_listed(value)}")
        return value

    @field_validator(*COLUMNS[1:])
    @classmethod
    def _as_long_as_plastic_strain(cls, value, info: ValidationInfo):
        rows = info.data.get("plastic_strain")
        if value is not None and rows is not None and len(value) != len(rows):
            raise ValueError(
                f"has {len(value)} values, expected {len(rows)}, as many as in plastic_strain"
            )
        return value

    @model_validator(mode="after")
    def _whole_table_or_none(self):
        if len({getattr(self, name) is None for name in COLUMNS}) > 1:
            raise ValueError(f"expected all of {', '.join(COLUMNS)}, or none")
        return self

    @model_validator(mode="after")
    def _something_to_regularise(self):
        if self.reference_size_mm is None:
            return self
        here = f"reference_size_mm = {self.reference_size_mm:g}"
        if self.elastic or not self.compression or self.plastic_strain is None:
            raise ValueError(f"{here}: there is no compressive softening to scale, leave it out")
        if softening_onset(self.table) == len(self.plastic_strain) - 1:
            raise ValueError(
                f"{here}: the uniaxial strength is largest in the last row of the table, which "
                "never softens, leave it out"
            )
        return self

    @classmethod
    def load(cls, name: str | Path, beside: Path | None = None) -> "Material":
        """Read a material by its name or by the path of its file.

        Parameters
        ----------
        name : name of a file in `configs/materials/` without its suffix, or a path
        beside : folder that a relative path is relative to, and whose neighbour `materials/` is
            searched for a name first (default: the working folder)

        Raises
        ------
        ConfigError
            When there is no such material or its file is wrong.
        """
        path = find_material(name, beside)
        return cls.from_values(read_yaml(path), str(path))

    @classmethod
    def from_values(cls, values: dict, file: str) -> "Material":
        """Check the keys of a material; `file` is named in messages."""
        try:
            return cls.model_validate(values)
        except ValidationError as error:
            raise sentences(error, cls, lambda keys: file) from None

    @property
    def young(self) -> float:
        """Young's modulus [Pa]."""
        return self.young_modulus_GPa * GPA

    @property
    def poisson(self) -> float:
        """Poisson's ratio [-]."""
        return self.poisson_ratio

    @property
    def density(self) -> float:
        """Density [kg/m3]."""
        return self.density_kg_m3

    @property
    def tensile_strength(self) -> float:
        """Virgin tensile strength [Pa]; 0 when elastic."""
        return (self.tensile_strength_MPa or 0.0) * MPA

    @property
    def fracture_energy(self) -> float:
        """Fracture energy Gf [J/m2]; 0 when elastic."""
        return self.fracture_energy_J_m2 or 0.0

    @property
    def table(self) -> np.ndarray:
        """Hardening table (4, k): plastic strain [-], cohesion [Pa], friction, dilation [rad].

        One row of zeros when there is none.
        """
        if self.plastic_strain is None:
            return np.zeros((4, 1))
        return np.array(
            [
                np.asarray(self.plastic_strain, dtype=float),
                np.asarray(self.cohesion_MPa, dtype=float) * MPA,
                np.radians(np.asarray(self.friction_angle_deg, dtype=float)),
                np.radians(np.asarray(self.dilation_angle_deg, dtype=float)),
            ]
        )

    @property
    def options(self) -> np.ndarray:
        """Switches (4,) int32: hardening, coupling, compression, yields.

        hardening: 0 compressive, 1 total; coupling: 0 implicit, 1 explicit; compression: 1 with
        Mohr-Coulomb planes; yields: 0 for an elastic material.
        """
        return np.array(
            [
                self.hardening == "total",
                self.coupling == "explicit",
                self.compression,
                not self.elastic,
            ],
            dtype=np.int32,
        )

    @property
    def wave_speed(self) -> float:
        """Speed of plane pressure waves [m/s]."""
        nu = self.poisson
        modulus = self.young * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
        return (modulus / self.density) ** 0.5

    @property
    def band_width_limit(self) -> float:
        """Crack band width [m] above which the tension return has several answers.

        From |H| = h_c ft^2 / (2 Gf) < E / (1 + nu), eq. 16 and three active planes; infinite for
        an elastic material.
        """
        if self.elastic:
            return float("inf")
        shear_twice = self.young / (1 + self.poisson)
        return 2 * self.fracture_energy * shear_twice / self.tensile_strength**2

    @property
    def reference_width(self) -> float:
        """Crack band width [m] for which the table holds as it stands; 0: for every width."""
        return (self.reference_size_mm or 0.0) * MM

    @property
    def compressive_width_limit(self) -> float:
        """Crack band width [m] above which stretched softening snaps back; infinite without."""
        if self.reference_size_mm is None:
            return float("inf")
        return width_limit(self.table, self.young, self.poisson, self.reference_width)

    def table_of_band(self, width: float) -> np.ndarray:
        """The hardening table, as `table`, that holds in a crack band of that width [m]."""
        table = self.table
        if self.reference_size_mm is not None:
            rows = slice(softening_onset(table) + 1, None)
            onset = table[0, softening_onset(table)]
            stretch = self.reference_width / width
            table[0, rows] = stretch * table[0, rows] + (1.0 - stretch) * onset
        return table

    def band_width_of(self, area):
        """Crack band width h_c [m] of triangles of the given area [m2], any shape."""
        return np.sqrt((2.0 if self.band_width == "sqrt_2A" else 1.0) * np.asarray(area))


def find_material(name: str | Path, beside: Path | None = None) -> Path:
    """File of a material, by name or path; see `Material.load`."""
    text = str(name)
    if "/" in text or text.endswith((".yaml", ".yml")):
        return (beside or Path()) / text
    folders = [Path("configs/materials"), PACKAGED / "materials"]
    if beside is not None:
        folders[:0] = [beside / "materials", beside.parent / "materials"]
    for folder in folders:
        if os.path.isfile(folder / f"{text}.yaml"):
            return folder / f"{text}.yaml"
    known = sorted({path.stem for folder in folders for path in folder.glob("*.yaml")})
    raise ConfigError(f"material '{one_line(text)}': no such material, {suggestion(text, known)}")


def _listed(values: tuple) -> str:
    return ", ".join(f"{value:g}" for value in values)
