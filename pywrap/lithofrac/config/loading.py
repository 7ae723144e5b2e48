"""What may stand under `loading:`: how a scene is loaded, one model per kind.

All loads rise smoothly. Ramps are counted in transits: times in which a pressure wave of the rock
runs through the height of the specimen.
"""

from typing import Annotated, Literal

from pydantic import Field

from lithofrac.config.base import MPA, NonNegative, Positive, Section


class VelocityLoading(Section):
    """Loaded ends move at a constant speed, after a smooth start.

    With a confinement the pressure rises first, while the ends follow so that the axial stress
    is equal to it when it is complete. Strains are counted from there.
    """

    kind: Literal["velocity"]
    speed_m_s: Positive
    """Speed of each end of the whole specimen."""
    end_strain: Positive
    """Axial strain at the end of the run, counted from the end of the confinement."""
    sense: Literal["shorten", "stretch"] = "shorten"
    """Compression or tension."""
    confinement_MPa: NonNegative = 0.0
    """Lateral pressure at the start of axial loading."""
    lateral_stiffness_over_young: NonNegative = 0.0
    """Stiffness of the lateral platens: rise of pressure per lateral strain, over E of the rock."""
    ramp_transits: Positive = 5.0
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
    stress_MPa: float
    """Axial stress, compression positive."""
    ramp_transits: NonNegative = 20.0
    """Duration of the ramp; 0 is a jump."""
    hold_transits: NonNegative = 20.0
    """Time at full stress before the run ends."""

    @property
    def stress(self) -> float:
        """Axial stress [Pa], compression positive."""
        return self.stress_MPa * MPA


Loading = Annotated[VelocityLoading | TractionLoading, Field(discriminator="kind")]
