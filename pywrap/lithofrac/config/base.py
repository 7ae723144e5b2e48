"""What all models of a config share: the section and the kinds of number.

Units stand in the key names (`_mm`, `_MPa`, `_deg`) and become SI in properties of the models.
Only `lithofrac.config` knows these factors; everything after it reads SI numbers.
"""

from typing import Annotated, ClassVar

from pydantic import BaseModel, ConfigDict, Field

MM = 1e-3  # metres
MPA = 1e6  # pascals
GPA = 1e9  # pascals

Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]


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
