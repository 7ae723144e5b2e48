"""What may stand under `scene:`: the geometry of a case, one model per kind.

Lengths are millimetres in the file and metres in the properties, which have no unit in their name.
"""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from lithofrac.config.base import MM, Length, Section
from lithofrac.config.gmsh_file import GmshFile


class SingleElement(Section):
    """One right-angled triangle with its legs on the two symmetry planes.

    Confinement acts on its hypotenuse, which gives a uniform stress: a material point driven
    through the whole code.
    """

    kind: Literal["single_element"]
    size_mm: Length
    """Length of both legs."""
    axisymmetric: bool = True
    """Triaxial test; `false` is plane strain."""

    @property
    def height(self) -> float:
        """Extent along the axis of loading [m]."""
        return self.size_mm * MM

    @property
    def element_size(self) -> float:
        """Nominal edge length of the largest elements [m]."""
        return self.size_mm * MM


class Specimen(Section):
    """What all uniformly meshed, upright specimens share."""

    height_mm: Length
    """Height of the whole specimen."""
    element_size_mm: Length
    """Nominal edge length of the elements."""
    structured: bool = False
    """Rows of equal right-angled triangles instead of an unstructured mesh."""

    @property
    def height(self) -> float:
        """Height of the whole specimen [m]."""
        return self.height_mm * MM

    @property
    def element_size(self) -> float:
        """Nominal edge length of the elements [m]."""
        return self.element_size_mm * MM


class Triaxial(Specimen):
    """Cylinder under fluid pressure, axisymmetric (Klerck 2004, Fig. 8c)."""

    kind: Literal["triaxial"]
    diameter_mm: Length
    """Of the cylinder."""
    whole_height: bool = False
    """Mesh the whole height; `false` meshes the upper half, as the paper does."""

    @property
    def radius(self) -> float:
        """Radius of the cylinder [m]."""
        return 0.5 * self.diameter_mm * MM


class PlaneStrain(Specimen):
    """Prism under lateral confinement, plane strain (Klerck 2004, Fig. 8a).

    Without a section `platens:` its ends are on rollers and the lateral stiffness is a spring on
    its faces; with one, its ends are pressed by platens.
    """

    kind: Literal["plane_strain"]
    width_mm: Length
    """Width across the confined faces."""
    lateral_platens: bool = False
    """Platens on the lateral faces as well: pressure and spring act on their backs."""

    @property
    def width(self) -> float:
        """Width across the confined faces [m]."""
        return self.width_mm * MM


class HoleInBlock(Section):
    """What all square blocks with a central hole share."""

    hole_radius_mm: Length
    """Radius of the hole."""
    block_over_radius: float = Field(default=8.0, gt=2.0, le=1e4)
    """Width and height of the whole block, in hole radii."""
    wall_elements_per_radius: float = Field(default=12.0, ge=1.0, le=1e4)
    """Elements on a length of one radius at the wall of the hole."""
    far_elements_per_radius: float = Field(default=3.0, ge=1e-2, le=1e4)
    """The same at the outer faces."""

    @property
    def radius(self) -> float:
        """Radius of the hole [m]."""
        return self.hole_radius_mm * MM

    @property
    def height(self) -> float:
        """Height of the whole block [m]."""
        return self.block_over_radius * self.radius

    @property
    def wall_size(self) -> float:
        """Nominal edge length at the wall of the hole [m]."""
        return self.radius / self.wall_elements_per_radius

    @property
    def element_size(self) -> float:
        """Nominal edge length of the largest elements [m]."""
        return self.radius / min(self.far_elements_per_radius, self.wall_elements_per_radius)


class HoleQuarter(HoleInBlock):
    """Quarter of a square block with a central hole, plane strain (Klerck 2004, Fig. 13).

    The hole is in the lower left corner, both symmetry planes run through its centre, and the
    load acts on the upper face.
    """

    kind: Literal["hole_quarter"]


class Hole(HoleInBlock):
    """Upper half of a square block with a central hole under a platen, plane strain.

    Klerck 2004, section 3.3 and Fig. 13. The plane of symmetry runs through the centre of the
    hole across the load; the other one, along the load, is where the primary crack opens.
    """

    kind: Literal["hole"]


class Bar(Specimen):
    """Upright bar on a frictionless base, plane strain; for waves and crack bands."""

    kind: Literal["bar"]
    width_mm: Length
    """Width of the bar."""
    structured: bool = True
    """Rows of equal right-angled triangles instead of an unstructured mesh."""
    laterally_fixed: bool = False
    """Both long faces on rollers: plane waves, uniaxial strain."""

    @property
    def width(self) -> float:
        """Width of the bar [m]."""
        return self.width_mm * MM


class Punch(Section):
    """Square block with a raised strip on top, punched between lateral platens, plane strain.

    Klerck 2004, section 3.1 and Fig. 5: the strip is machined out of the block, so that it is of
    the same rock. Height and axial strain count from the base to the top of the strip.
    """

    kind: Literal["punch"]
    width_mm: Length
    """Width of the block."""
    block_height_mm: Length
    """Height of the block below the strip."""
    strip_width_mm: Length
    """Width of the strip, on which the punch acts."""
    strip_height_mm: Length
    """Height by which the strip stands out of the block."""
    strip_element_size_mm: Length
    """Nominal edge length in the strip and within `fine_radius_mm` of its foot."""
    fine_radius_mm: Length
    """Distance from the foot of the strip up to which elements are as small as in the strip."""
    element_size_mm: Length
    """Nominal edge length at a distance of one block height from the strip, and beyond."""

    @model_validator(mode="after")
    def _strip_fits(self):
        if self.strip_width_mm >= self.width_mm:
            raise ValueError(
                f"strip_width_mm = {self.strip_width_mm:g}: expected below width_mm, "
                f"{self.width_mm:g}"
            )
        if self.fine_radius_mm >= self.block_height_mm:
            raise ValueError(
                f"fine_radius_mm = {self.fine_radius_mm:g}: expected below block_height_mm, "
                f"{self.block_height_mm:g}"
            )
        if self.strip_element_size_mm > self.element_size_mm:
            raise ValueError(
                f"strip_element_size_mm = {self.strip_element_size_mm:g}: expected not above "
                f"element_size_mm, {self.element_size_mm:g}"
            )
        return self

    @property
    def width(self) -> float:
        """Width of the block [m]."""
        return self.width_mm * MM

    @property
    def block_height(self) -> float:
        """Height of the block below the strip [m]."""
        return self.block_height_mm * MM

    @property
    def strip_width(self) -> float:
        """Width of the strip, on which the punch acts [m]."""
        return self.strip_width_mm * MM

    @property
    def height(self) -> float:
        """Height of block and strip [m]."""
        return (self.block_height_mm + self.strip_height_mm) * MM

    @property
    def fine_size(self) -> float:
        """Nominal edge length in and under the strip [m]."""
        return self.strip_element_size_mm * MM

    @property
    def fine_radius(self) -> float:
        """Distance from the foot of the strip up to which elements are small [m]."""
        return self.fine_radius_mm * MM

    @property
    def element_size(self) -> float:
        """Nominal edge length of the largest elements [m]."""
        return self.element_size_mm * MM


class Brazilian(Section):
    """Disc squeezed between two platens, plane strain; two flats give the platens a hold."""

    kind: Literal["brazilian"]
    diameter_mm: Length
    """Of the disc."""
    flat_angle_deg: float = Field(ge=1.0, le=40.0)
    """Angle at the centre that each loaded flat spans."""
    element_size_mm: Length
    """Nominal edge length of the elements."""

    @property
    def radius(self) -> float:
        """Radius of the disc [m]."""
        return 0.5 * self.diameter_mm * MM

    @property
    def flat_width(self) -> float:
        """Width of each flat [m]."""
        return 2 * self.radius * math.sin(math.radians(self.flat_angle_deg) / 2)

    @property
    def height(self) -> float:
        """Distance of the flats [m]."""
        return 2 * self.radius * math.cos(math.radians(self.flat_angle_deg) / 2)

    @property
    def element_size(self) -> float:
        """Nominal edge length of the elements [m]."""
        return self.element_size_mm * MM


Scene = Annotated[
    SingleElement
    | Triaxial
    | PlaneStrain
    | HoleQuarter
    | Hole
    | Bar
    | Punch
    | Brazilian
    | GmshFile,
    Field(discriminator="kind"),
]

SIZE_KEYS = {
    "single_element": "size_mm",
    "hole_quarter": "far_elements_per_radius",
    "hole": "far_elements_per_radius",
}  # key that sets the size of the largest elements, where it is not `element_size_mm`
