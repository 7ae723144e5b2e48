"""The extremes of the matrix, by family."""

from functools import cache

from lithofrac.stability.cell import Cell
from lithofrac.stability.families import loads, ratios, scales, shapes, strength

FAMILIES = {
    "stiffness": ratios.stiffness,
    "density": ratios.density,
    "poisson": strength.poisson,
    "friction_angle": strength.angles,
    "strength": strength.strengths,
    "confinement": loads.confinement,
    "contact_friction": loads.friction,
    "loading_rate": loads.rates,
    "impact": loads.impact,
    "strain_step": loads.strain_steps,
    "slivers": shapes.slivers,
    "every_edge_cut": shapes.every_edge,
    "one_element": shapes.one_element,
    "many_elements": shapes.many_elements,
    "units": scales.units,
    "offset": scales.offsets,
    "drift": scales.drift,
}


@cache
def cells_of(families: tuple[str, ...]) -> list[Cell]:
    """All cells of some families, in the order of the matrix."""
    return [cell for name, make in FAMILIES.items() if name in families for cell in make()]
