"""What may stand under `loading:`: how a scene is loaded, one model per kind.

All loads rise smoothly. Ramps are counted in transits: times in which a pressure wave of the rock
runs through the height of the specimen.
"""

from typing import Annotated, Literal

from pydantic import Field

from lithofrac.config.base import MPA, EndStrain, Pressure, Section, Speed, Traction
from lithofrac.config.gmsh_file import BoundaryLoading

Transits = Annotated[float, Field(ge=0.0, le=1e6)]


class VelocityLoading(Section):
    """Loaded ends move at a constant speed, after a smooth start.

    With a confinement the pressure rises first, while the ends follow so that the axial stress
    is equal to it when it is complete. Strains are counted from there.
    """

    kind: Literal["velocity"]
    speed_m_s: Speed
    """Speed of each end of the whole specimen."""
    end_strain: EndStrain
    """Axial strain at the end of the run, counted from the end of the confinement."""
    sense: Literal["shorten", "stretch"] = "shorten"
    """Compression or tension."""
    confinement_MPa: Pressure = 0.0
    """Lateral pressure at the start of axial loading."""
    lateral_stiffness_over_young: float = Field(default=0.0, ge=0.0, le=1e3)
    """Stiffness of the lateral platens: rise of pressure per lateral strain, over E of the rock."""
    ramp_transits: float = Field(default=5.0, ge=1e-3, le=1e6)
    """Shortest duration of each ramp."""

    @property
    def speed(self) -> float:
        """Speed of each end [m/s], positive."""
        return self.speed_m_s

    @property
    def confinement(self) -> float:
        """Lateral pressure at the start of axial loading [Pa]."""
        return self.confinement_MPa * MPA


class TractionLoading(Section):
    """Uniform pressure on the loaded end, smoothly raised and then held."""

    kind: Literal["traction"]
    stress_MPa: Traction
    """Axial stress, compression positive."""
    ramp_transits: Transits = 20.0
    """Duration of the ramp; 0 is a jump."""
    hold_transits: Transits = 20.0
    """Time at full stress before the run ends."""

    @property
    def stress(self) -> float:
        """Axial stress [Pa], compression positive."""
        return self.stress_MPa * MPA


Loading = Annotated[
    VelocityLoading | TractionLoading | BoundaryLoading, Field(discriminator="kind")
]
