"""Extremes of the rock itself: Poisson's ratio, friction, cohesion, tension, fracture energy."""

from collections.abc import Callable

from lithofrac.config.setting import settings
from lithofrac.config.suite import find_case
from lithofrac.scenes import make_mesh, make_problem
from lithofrac.stability.cell import (
    CONTACT,
    CONTINUUM,
    CRACKED,
    CRACKS,
    Cell,
    Refused,
    Stable,
    Trial,
)
from lithofrac.stability.models import (
    STEPS,
    block,
    cracked,
    cracking,
    least_fracture_energy,
    pressed,
    rock,
    stacked,
)

FLAT = {"plastic_strain": [0.0]}  # tables of one row
POISSON = (0.0, 0.45, 0.499, 0.4999)


def perfect(cohesion: float, friction: float, dilation: float = 0.0, **changes):
    """Sandstone with one row of hardening: cohesion [MPa] and angles [deg] that never change."""
    table = {"cohesion_MPa": [cohesion], "friction_angle_deg": [friction]}
    return rock(**FLAT, **table, dilation_angle_deg=[dilation], **changes)


def on_all(family: str, extreme: str, material, strain: float, steps: int = STEPS) -> list[Cell]:
    """The three cells of a material."""
    makes: dict[str, tuple[Callable[[], Trial], dict]] = {
        CONTINUUM: (
            lambda: Trial(pressed(block(), material, strain=strain, steps=steps)),
            {},
        ),
        CONTACT: (
            lambda: Trial(stacked(material, material, strain=0.5 * strain, steps=2 * steps)),
            {},
        ),
        CRACKED: (
            lambda: Trial(cracking(cracked(block()), material, strain=strain, steps=steps)),
            {"limits": CRACKS},
        ),
    }
    return [
        Cell(family, extreme, mesh, Stable(make, **more)) for mesh, (make, more) in makes.items()
    ]


def from_file(**keys: float | list) -> object:
    """Problem of the material point of a case file with other keys of its material."""
    given = settings([f"material.{key}={value}" for key, value in keys.items()])
    case = find_case("single_element_sandstone", None, given)
    return make_problem(case, make_mesh(case))


def refused(family: str, extreme: str, words: str, **keys: float | list) -> list[Cell]:
    """The same refusal whatever the mesh: a material is refused before there is one."""
    return [
        Cell(family, extreme, mesh, Refused(lambda: from_file(**keys), words))
        for mesh in (CONTINUUM, CONTACT, CRACKED)
    ]


def poisson() -> list[Cell]:
    """Poisson's ratio from 0 to nearly incompressible."""
    found = []
    for value in POISSON:
        # the more incompressible, the more steps a shear wave takes: less strain in them
        strain = 0.012 if value < 0.49 else 1e-3
        found += on_all("poisson", f"nu {value:g}", rock(poisson_ratio=value), strain)
    return found + refused(
        "poisson", "nu 0.5", r"poisson_ratio = 0\.5: .*below 0\.5", poisson_ratio=0.5
    )


def angles() -> list[Cell]:
    """Friction angle 0 (Tresca) and 89 degrees, without and with associated flow."""
    found = []
    for words, material in (
        ("phi 0", perfect(20.0, 0.0)),
        ("phi 89 deg", perfect(0.5, 89.0)),
        ("phi = psi = 45 deg", perfect(10.0, 45.0, 45.0)),
        ("phi = psi = 89 deg", perfect(0.5, 89.0, 89.0)),
    ):
        found += on_all("friction angle", words, material, 0.012)
    return found + refused(
        "friction angle",
        "phi 90 deg",
        "friction_angle_deg.*expected a number below 90",
        **_row(90.0),
    )


def _row(friction: float) -> dict:
    names = ("plastic_strain", "cohesion_MPa", "dilation_angle_deg")
    return {name: [0.0] for name in names} | {"friction_angle_deg": [friction]}


def strengths() -> list[Cell]:
    """Cohesion, tensile strength and fracture energy towards 0; fracture energy to 1e6 J/m2."""
    found = []
    for words, material in (
        ("c 0", perfect(0.0, 40.0)),
        ("c 0 and ft 1 Pa", perfect(0.0, 40.0, tensile_strength_MPa=1e-6)),
        ("ft 1 Pa", rock(tensile_strength_MPa=1e-6)),
        ("Gf at its limit", rock(fracture_energy_J_m2=1.1 * least_fracture_energy())),
        ("Gf 1e6 J/m2", rock(fracture_energy_J_m2=1e6)),
    ):
        found += on_all("strength", words, material, 0.008)
    found += refused("strength", "Gf 1e-6 J/m2", "above which softening", fracture_energy_J_m2=1e-6)
    found += refused("strength", "Gf 0", "fracture_energy_J_m2", fracture_energy_J_m2=0.0)
    return found + refused("strength", "ft 0", "tensile_strength_MPa", tensile_strength_MPa=0.0)
