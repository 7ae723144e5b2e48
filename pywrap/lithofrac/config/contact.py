"""What may stand under `contact:`: which surfaces rub on each other, and how much.

The surfaces of a scene are `rock` and, where it has any, `platen`, which stands for all of them.
"""

from typing import Annotated

from pydantic import Field

from lithofrac.config.base import Section
from lithofrac.config.errors import one_line, suggestion

ROCK, PLATEN = "rock", "platen"
JOINT = "-"  # between the two surfaces of a key

Friction = Annotated[float, Field(ge=0.0, le=1e3)]


class ContactSection(Section):
    """Non-penetration with Coulomb friction between all parts, and of each with itself."""

    friction: dict[str, Friction] = Field(default_factory=dict)
    """Coefficient by pair of surfaces, in either order: `rock-platen: 0.005`."""
    default_friction: Friction = 0.0
    """Coefficient of the pairs that `friction` does not name."""
    tolerance: float = Field(default=1.0, ge=1e-6, le=1e3)
    """Of the contact solver and of the penetration that is left alone, over the usual one."""

    @property
    def pairs(self) -> dict[tuple[str, str], float]:
        """(surface, surface) -> coefficient."""
        return {tuple(key.split(JOINT)): value for key, value in self.friction.items()}

    def problems(self, surfaces: list[str]) -> list[str]:
        """Sentences about keys of `friction` that do not name a pair of these surfaces once."""
        found, seen = [], set()
        for key, value in self.friction.items():
            names = key.split(JOINT)
            where = f"contact.friction.{one_line(key)} = {value:g}"
            unknown = [name for name in names if name not in surfaces]
            if len(names) != 2:
                found.append(f"{where}: expected two surfaces, as in {ROCK}{JOINT}{ROCK}")
            elif unknown:
                known = suggestion(unknown[0], surfaces)
                found.append(f"{where}: unknown surface '{one_line(unknown[0])}', {known}")
            elif frozenset(names) in seen:
                found.append(f"{where}: the pair is given twice, expected one order of the two")
            seen.add(frozenset(names))
        return found
