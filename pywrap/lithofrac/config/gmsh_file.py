"""A geometry of one's own: what a Gmsh file holds, and how its boundary is loaded.

Physical surfaces are bodies, physical curves are boundaries; both are named as in the file.
"""

import os
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from lithofrac.config.base import MM, Coordinate, Section, Speed, Traction
from lithofrac.config.errors import one_line
from lithofrac.config.material import Material

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}  # metres
SCRIPT, MESH = ".geo", ".msh"

Transits = Annotated[float, Field(ge=0.0, le=1e6)]


class GmshFile(Section):
    """Bodies and boundaries of a Gmsh file in the plane x, y, plane strain.

    A `.geo` is meshed by gmsh, with the element sizes that it asks for; a `.msh` is read as it is.
    Bodies that share curves share their nodes; bodies with curves of their own touch by contact.
    """

    kind: Literal["gmsh_file"]
    file: str
    """A `.geo` or `.msh`, relative to the file that names it."""
    length_unit: Literal["m", "cm", "mm"]
    """Unit of the coordinates in the file."""
    materials: dict[str, Material] = Field(default_factory=dict)
    """Physical surfaces that are not of the case's `material` -> what they are of."""

    @field_validator("file")
    @classmethod
    def _there(cls, file: str) -> str:
        path = Path(file)
        if path.suffix not in (SCRIPT, MESH):
            raise ValueError(
                f"{one_line(file, 200)}: expected a file that ends in {SCRIPT} or {MESH}"
            )
        if not os.path.isfile(path):  # unlike pathlib, it takes any text
            raise ValueError(f"{one_line(file, 200)}: no such file")
        return file

    @property
    def path(self) -> Path:
        """The file."""
        return Path(self.file)

    @property
    def absolute(self) -> "GmshFile":
        """The same, with a file that is found from any folder."""
        return self.model_copy(update={"file": os.path.abspath(self.file)})

    @property
    def unit(self) -> float:
        """Length of one unit of the file [m]."""
        return UNITS[self.length_unit]

    def seed_problems(self, seed: int) -> list[str]:
        """A sentence where the file has no such realisation."""
        if self.path.suffix == MESH and seed != 1:
            return [f"mesh.seed = {seed}: a {MESH} is one mesh, expected 1"]
        return []


class Way(Section):
    """How far a boundary is moved; a component that is left out stays free."""

    x_mm: Coordinate | None = None
    """Way along x."""
    y_mm: Coordinate | None = None
    """Way along y."""

    @model_validator(mode="after")
    def _anything(self):
        if self.x_mm is None and self.y_mm is None:
            raise ValueError("expected x_mm, y_mm or both")
        return self

    @property
    def components(self) -> dict[int, float]:
        """Component -> way [m] at the end of the run."""
        given = {0: self.x_mm, 1: self.y_mm}
        return {component: MM * way for component, way in given.items() if way is not None}


class BoundaryLoading(Section):
    """Named boundaries are held, pressed and driven.

    Pressures rise together and are then constant. Driven boundaries rest until the pressures are
    complete; then all of them set out at once and arrive at once, at the end of the run.
    """

    kind: Literal["boundaries"]
    held: dict[str, Literal["x", "y", "xy"]] = Field(default_factory=dict)
    """Physical curve -> components of its nodes that stay: rollers, symmetry, or both."""
    pressed_MPa: dict[str, Traction] = Field(default_factory=dict)
    """Physical curve -> pressure on it, which follows its motion; negative pulls."""
    driven: dict[str, Way] = Field(default_factory=dict)
    """Physical curve -> how far its nodes have gone at the end."""
    speed_m_s: Speed | None = None
    """Speed of the component that goes farthest; needed where any is driven."""
    ramp_transits: float = Field(default=20.0, ge=1e-3, le=1e6)
    """Duration of each ramp, in times that a pressure wave of the case's `material` takes for the
    largest extent of the geometry."""
    hold_transits: Transits = 20.0
    """Time under full pressure before the run ends; no part of it where boundaries are driven."""
    axial: str | None = None
    """Driven physical curve whose force and way are the axial stress and strain: over its own
    width, and over the extent of the geometry along its way."""

    @model_validator(mode="after")
    def _whole(self):
        ways = [abs(way) for move in self.driven.values() for way in move.components.values()]
        if self.driven and not any(ways):
            raise ValueError("driven: no curve goes anywhere, expected it under held")
        if not self.driven and not self.pressed_MPa:
            raise ValueError("driven: missing key, expected it or pressed_MPa: nothing is loaded")
        if self.driven and self.speed_m_s is None:
            raise ValueError("speed_m_s: missing key, expected a number where curves are driven")
        if not self.driven and self.speed_m_s is not None:
            raise ValueError(
                f"speed_m_s = {self.speed_m_s:g}: no curve is driven, expected driven or no speed"
            )
        if self.axial is not None:
            moved = self.driven[self.axial].components if self.axial in self.driven else {}
            if sum(way != 0.0 for way in moved.values()) != 1:
                raise ValueError(
                    f"axial = {self.axial}: expected a curve that is driven along one axis"
                )
        return self

    @property
    def curves(self) -> dict[str, str]:
        """Key of the section -> name of a curve it loads, in pairs (key.name, name)."""
        groups = {"held": self.held, "pressed_MPa": self.pressed_MPa, "driven": self.driven}
        return {f"{key}.{name}": name for key, group in groups.items() for name in group}

    @property
    def farthest(self) -> float:
        """Largest way of any component [m]; 0 where nothing is driven."""
        moves = (move.components.values() for move in self.driven.values())
        return max((abs(way) for ways in moves for way in ways), default=0.0)
