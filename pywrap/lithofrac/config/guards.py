"""What may stand under `guards:`: when a run is worth a warning, and when it is stopped.

Nothing in the core adds mass, so nothing guards it.
"""

from typing import Annotated

from pydantic import Field

from lithofrac.config.base import Section

Limit = Annotated[float, Field(ge=0.0, le=1e9)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]

RISING = ("energy_residual", "contact_work", "overlap", "unconverged", "speed")  # bad when large
FALLING = ("element_area", "time_step")  # bad when small


class GuardsSection(Section):
    """Thresholds; a run that passes a `stop` ends with exit code 3, its last checkpoint kept.

    A value that is not a finite number and an element without area end a run in any case.
    """

    energy_residual_warning: Limit = 1e-4
    """Residual of the energy ledger and work of turns, over the largest energy so far."""
    energy_residual_stop: Limit = 1e-2
    """The same, where the run stops."""
    contact_work_warning: Limit = 1e-3
    """Energy that contact pressure has given, over the largest energy so far; it should only take
    some. The ledger closes all the same. Only with `contact:`."""
    contact_work_stop: Limit = 0.1
    """The same, where the run stops; parts that overlap a little at the start give some as they
    are moved apart."""
    element_area_warning: Share = 0.1
    """Smallest area of an element, over that in the undeformed mesh."""
    element_area_stop: Share = 0.0
    """The same, where the run stops; 0 is an element that has turned inside out."""
    overlap_warning: Limit = 0.01
    """Depth of a boundary node in an element of which it is no corner, over the shortest edge of
    the boundary; at 0.01 contact lets go of the node. Only with `contact:`."""
    overlap_stop: Limit = 0.05
    """The same, where the run stops."""
    time_step_warning: Share = 0.39
    """Critical time step of the smallest piece of a cut element, over that of the mesh at the
    start. Cuts keep 0.4, and the step of the run allows for it from the start."""
    time_step_stop: Share = 0.36
    """The same, where the run stops; at 0.36 is the step of a run that cuts elements, with
    `time_step_factor: 0.9`."""
    unconverged_warning: Share = 0.05
    """Steps in which contact did not converge, over all steps of the run."""
    unconverged_stop: Share = 0.5
    """The same, where the run stops."""
    speed_warning: Limit = 0.1
    """Largest speed of a node, over the P wave speed of its body."""
    speed_stop: Limit = 0.2
    """The same, where the run stops."""

    def problems(self) -> list[str]:
        """Sentences about stops that come before their warnings."""
        found = []
        for name in (*RISING, *FALLING):
            warning, stop = getattr(self, f"{name}_warning"), getattr(self, f"{name}_stop")
            if (warning > stop) if name in RISING else (warning < stop):
                side = "above" if name in RISING else "below"
                found.append(
                    f"guards.{name}_warning = {warning:g}: expected a number not {side} "
                    f"guards.{name}_stop, {stop:g}"
                )
        return found
