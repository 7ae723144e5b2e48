"""What may stand under `fracture:`: discrete cracks (Klerck, Sellers & Owen 2004, section 2.5)."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from lithofrac.config.base import Section


def _off(value: Any) -> Any:
    """The word `off`, which YAML reads as false."""
    return "off" if value is False else value


class FractureSection(Section):
    """How failed material is cut into discrete cracks; `fracture: off` is the continuum."""

    mode: Annotated[
        Literal["off", "inter_element", "intra_element"], BeforeValidator(_off)
    ] = "off"  # fmt: skip
    """No cracks, cracks along the edges of elements, or through elements where that leaves good
    ones."""
    weights: Literal["volume", "failure_factor"] = "volume"
    """Weights of the non-local averages about a node (eq. 22)."""
    release_steps: int | None = Field(default=None, ge=0, le=1_000_000)
    """Steps over which the traction on a new crack fades; without it, twice the way of a shear
    wave along the crack; 0 is at once, as in the paper."""
    reset: Literal["normal", "paper"] = "normal"
    """Failed elements count their failure anew across the crack and keep all else, or regain all
    their state as in the paper. An element that stands alone regains it either way when it has
    failed twice over."""
    interval_steps: int = Field(default=5, ge=1, le=1_000_000)
    """Steps from one search for failed nodes to the next."""

    @model_validator(mode="before")
    @classmethod
    def _one_word(cls, values: Any) -> Any:
        return {"mode": "off"} if _off(values) == "off" else values

    @property
    def on(self) -> bool:
        """Whether cracks are inserted at all."""
        return self.mode != "off"
