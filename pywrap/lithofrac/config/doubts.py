"""What a case may well mean, but seldom does: sentences that warn and stop nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lithofrac.config.material import Material

if TYPE_CHECKING:
    from lithofrac.config.case import Case

SLOWEST, FASTEST = 10.0, 20_000.0  # pressure waves [m/s]: loose sand to diamond


def doubts(case: Case) -> list[str]:
    """Sentences, each beginning with the key that is doubtful."""
    named = {"material": case.material}
    if case.platens is not None:
        named["platens.material"] = case.platens.material
    return [
        sentence
        for key, material in named.items()
        for sentence in (*_flow_doubts(key, material), *_unit_doubts(key, material))
    ]


def _flow_doubts(key: str, material: Material) -> list[str]:
    """Flow that dilates more than friction resists; the first such row is named.

    Its work is negative under a pressure that is high enough.
    """
    if material.elastic or not material.compression or material.plastic_strain is None:
        return []
    rows = zip(material.friction_angle_deg, material.dilation_angle_deg, strict=True)
    for row, (friction, dilation) in enumerate(rows):
        if dilation > friction:
            return [
                f"{key}.dilation_angle_deg.{row} = {dilation:g}: above friction_angle_deg.{row} = "
                f"{friction:g}, where flow under a high pressure gives off energy"
            ]
    return []


def _unit_doubts(key: str, material: Material) -> list[str]:
    speed = material.wave_speed
    if SLOWEST <= speed <= FASTEST:
        return []
    return [
        f"{key}: pressure waves run at {speed:.3g} m/s, usual are {SLOWEST:g} to {FASTEST:g}; are "
        f"young_modulus_GPa = {material.young_modulus_GPa:g} and density_kg_m3 = "
        f"{material.density_kg_m3:g} in these units?"
    ]
