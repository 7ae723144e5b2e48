"""What all models of a config share: the section and the kinds of number.

Units stand in the key names (`_mm`, `_MPa`, `_deg`) and become SI in properties of the models.
Only `lithofrac.config` knows these factors; everything after it reads SI numbers.
"""

from typing import Annotated, ClassVar

from pydantic import BaseModel, ConfigDict, Field

MM = 1e-3  # metres
MPA = 1e6  # pascals
GPA = 1e9  # pascals

NonNegative = Annotated[float, Field(ge=0.0)]

# Wide enough for every rock, metal and test; outside, products of keys overflow or vanish.
Length = Annotated[float, Field(ge=1e-3, le=1e7)]  # mm
Coordinate = Annotated[float, Field(ge=-1e7, le=1e7)]  # mm
Modulus = Annotated[float, Field(ge=1e-6, le=1e7)]  # GPa
Density = Annotated[float, Field(ge=1e-3, le=1e6)]  # kg/m3
Strength = Annotated[float, Field(ge=1e-6, le=1e6)]  # MPa
Pressure = Annotated[float, Field(ge=0.0, le=1e6)]  # MPa, also cohesion
Traction = Annotated[float, Field(ge=-1e6, le=1e6)]  # MPa
FractureEnergy = Annotated[float, Field(ge=1e-6, le=1e9)]  # J/m2
Speed = Annotated[float, Field(ge=1e-9, le=1e4)]  # m/s
EndStrain = Annotated[float, Field(ge=1e-9, lt=1.0)]  # a specimen of no height is at 1
PlasticStrain = Annotated[float, Field(ge=0.0, le=1e3)]


class Section(BaseModel):
    """A part of a config: unknown keys, NaN and infinity are errors; values never change.

    Strict: a text is not a number and a number is not a switch; whole numbers count as numbers.
    """

    expected: ClassVar[str] = "a mapping of keys"  # what a message asks for in its place

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
    )
