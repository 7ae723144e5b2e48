"""Platens: bodies of equal right-angled triangles beside the rock, and how they are held.

Choice: loading platens move along their normal and neither turn nor slide, as in a stiff machine.
Lateral platens are pressed on from behind and may turn; only the middle of their back is held, so
that friction does not carry them off.
"""

from dataclasses import replace

import numpy as np

from lithofrac.config.case import Case
from lithofrac.config.contact import PLATEN, ROCK
from lithofrac.problem import Mesh, Ramp, VelocityLoad
from lithofrac.scenes._rectangle import rectangle

# Side of the rock a platen stands on -> component along its normal, and the way out of the rock.
SIDES = {"bottom": (1, -1.0), "right": (0, 1.0), "top": (1, 1.0), "left": (0, -1.0)}


def platen(case: Case, side: str, span: tuple[float, float], at: float, size: float) -> Mesh:
    """A platen whose face is a straight line.

    Parameters
    ----------
    side : of the rock that it stands on: bottom, right, top or left
    span : ends of its face along that side [m]
    at : coordinate of its face along its normal [m]
    size : nominal edge length of the rock in front of it [m]
    """
    thickness = case.platens.thickness
    length = span[1] - span[0]
    component, outwards = SIDES[side]
    extents = (thickness, length) if component == 0 else (length, thickness)
    mesh = rectangle(*extents, size * case.platens.element_size_over_rock, True, 1)
    nodes = mesh.nodes.copy()
    nodes[:, component] += at - (thickness if outwards < 0 else 0.0)
    nodes[:, 1 - component] += span[0]
    return replace(mesh, nodes=nodes)


def name_of(side: str) -> str:
    """Body of the platen on a side of the rock."""
    return f"{side}_{PLATEN}"


def back_of(mesh: Mesh, side: str) -> np.ndarray:
    """Edges of a platen that face away from the rock; (k, 2)."""
    return mesh.edge_sets[f"{name_of(side)}.{side}"]


def pushed(
    case: Case, mesh: Mesh, side: str, load: str, speed: float, ramp: Ramp
) -> tuple[VelocityLoad, VelocityLoad]:
    """Motion of a loading platen: along its normal, and none across.

    Parameters
    ----------
    load : name of the load that is measured
    speed : velocity along the axis of the normal [m/s]
    """
    component, _ = SIDES[side]
    nodes = np.unique(back_of(mesh, side)).astype(np.int32)
    if case.platens.rigid:
        own = mesh.body == mesh.body_names.index(name_of(side))
        nodes = np.unique(mesh.triangles[own]).astype(np.int32)
    return (
        VelocityLoad(load, nodes, component, speed, ramp),
        VelocityLoad(f"{load}_guide", nodes, 1 - component),
    )


def guided(mesh: Mesh, side: str) -> VelocityLoad:
    """Hold the middle of the back of a platen across its normal; steel may spread from there."""
    across = 1 - SIDES[side][0]
    nodes = np.unique(back_of(mesh, side)).astype(np.int32)
    along = mesh.nodes[nodes, across]
    middle = np.argmin(np.abs(along - (along.min() + along.max()) / 2))
    return VelocityLoad(f"{side}_guide", nodes[middle : middle + 1], across)


def bodies_of(surface: str, mesh: Mesh) -> list[str]:
    """Bodies that a surface of the config stands for."""
    if surface == ROCK:
        return [ROCK]
    return [name for name in mesh.body_names if name != ROCK]
