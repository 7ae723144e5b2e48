"""What may stand under `platens:`: bodies of their own that press on the rock by contact."""

from pydantic import Field

from lithofrac.config.base import MM, Coordinate, Length, Section
from lithofrac.config.material import Material


class PlatensSection(Section):
    """All platens of a scene. They touch the rock without a gap and share no node with it."""

    material: Material
    """As `material` of the case."""
    thickness_mm: Length
    """Thickness of every platen."""
    element_size_over_rock: float = Field(default=2.0, ge=0.1, le=1e3)
    """Edge length of the elements over that of the rock; above 1 the rock sets the time step."""
    overhang_mm: Coordinate = 0.0
    """How far the loading platens reach over the rock on each side; negative: they end before."""
    rigid: bool = False
    """All nodes of the loading platens move as prescribed; `false`: those on their backs."""

    @property
    def thickness(self) -> float:
        """Thickness of every platen [m]."""
        return self.thickness_mm * MM

    @property
    def overhang(self) -> float:
        """Reach of a loading platen over the loaded face of the rock, on each side [m]."""
        return self.overhang_mm * MM

    def shortening(self, pressure: float) -> float:
        """Change of thickness [m] under a pressure [Pa] on face and back, free at the sides."""
        material = self.material
        return pressure * self.thickness * (1 - material.poisson**2) / material.young
