"""Unlike neighbours: ratios of stiffness and of density across an interface and across contact."""

from lithofrac.stability.cell import CONTACT, CONTINUUM, CRACKED, CRACKS, Cell, Stable, Trial
from lithofrac.stability.models import (
    ELASTIC,
    ROCK,
    block,
    cracked,
    cracking,
    elastic,
    pressed,
    right_half,
    stacked,
    two_bodies,
)

STIFFNESSES = (1.0, 1e3, 1e6)
DENSITIES = (1.0, 1e3, 1e4, 1e6)
STEPS = 4000  # of contact: the slower body hardly moves in fewer


def softer(ratio: float):
    """Elastic sandstone with its stiffness divided."""
    return elastic(young_modulus_GPa=ELASTIC.young_modulus_GPa / ratio)


def denser(ratio: float):
    """Elastic sandstone with its density multiplied; from 1 kg/m3 on, so that files allow it."""
    base = ELASTIC.density_kg_m3 if ratio < 1e2 else 1.0
    return elastic(density_kg_m3=base), elastic(density_kg_m3=base * ratio)


def stiffness() -> list[Cell]:
    """The softer body right of, below and above the other."""

    def cell(extreme, mesh, make, **more):
        return Cell("stiffness", extreme, mesh, Stable(make, **more))

    found = []
    for ratio in STIFFNESSES:
        words = f"E ratio {ratio:g}"
        soft = softer(ratio)
        mesh = two_bodies(block(), right_half)
        torn = two_bodies(cracked(block()), right_half)
        found += [
            cell(words, CONTINUUM, lambda s=soft, m=mesh: Trial(pressed(m, ELASTIC, s))),
            cell(f"{words}, soft below", CONTACT, lambda s=soft: _slid(ELASTIC, s)),
            cell(words, CRACKED, lambda s=soft, m=torn: Trial(cracking(m, ROCK, s)), limits=CRACKS),
        ]
        if ratio > 1.0:
            found.append(cell(f"{words}, soft above", CONTACT, lambda s=soft: _slid(s, ELASTIC)))
    return found


def density() -> list[Cell]:
    """The denser body right of, below and above the other."""

    def cell(extreme, mesh, make, **more):
        return Cell("density", extreme, mesh, Stable(make, **more))

    found = []
    for ratio in DENSITIES:
        words = f"density ratio {ratio:g}"
        light, heavy = denser(ratio)
        mesh = two_bodies(block(), right_half)
        torn = two_bodies(cracked(block()), right_half)
        own = ROCK.model_copy(update={"density_kg_m3": light.density_kg_m3})
        found += [
            cell(words, CONTINUUM, lambda a=light, b=heavy, m=mesh: Trial(pressed(m, a, b))),
            cell(f"{words}, heavy below", CONTACT, lambda a=light, b=heavy: _slid(a, b)),
            cell(
                words,
                CRACKED,
                lambda a=own, b=heavy, m=torn: Trial(cracking(m, a, b)),
                limits=CRACKS,
            ),
        ]
        if ratio > 1.0:
            found.append(
                cell(f"{words}, heavy above", CONTACT, lambda a=light, b=heavy: _slid(b, a))
            )
    return found


def _slid(upper, lower) -> Trial:
    return Trial(stacked(upper, lower, steps=STEPS))
