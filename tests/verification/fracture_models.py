"""Bars for the fracture tests: a weakened row, and meshes turned against the load."""

from dataclasses import replace

import numpy as np
from models import edges_of_rectangle, hold, problem, rectangle
from scipy.spatial import Delaunay

from lithofrac.config.material import Material
from lithofrac.problem import Contact, Damping, Mesh, Ramp

ROCK, WEAK = "rock", "weak"


def brittle(fracture_energy=60.0, tensile_strength=4.0, **changes):
    """Sandstone that fails in tension alone; J/m2 and MPa."""
    given = {
        "compression": False,
        "young_modulus_GPa": 28.0,
        "poisson_ratio": 0.0,  # a bar of uniform stress, whatever holds its ends
        "density_kg_m3": 2800.0,
        "tensile_strength_MPa": tensile_strength,
        "fracture_energy_J_m2": fracture_energy,
    }
    return Material(**(given | changes))


def aligned_bar(columns, rows, size):
    """Right-angled triangles on a grid of squares; an odd number of rows has one in the middle."""
    return rectangle(columns, rows, columns * size, rows * size)


def turned_bar(size, angle, width, height, seed=1, jitter=0.0):
    """Triangles on a square lattice that is turned by `angle` [rad] within a straight outline.

    Parameters
    ----------
    size : spacing of the lattice [m]
    angle : of the lattice to the axes [rad]
    jitter : random shift of inner nodes over `size`, for an unstructured mesh
    """
    reach = np.arange(-np.ceil((width + height) / size), np.ceil((width + height) / size) + 1)
    i, j = (a.ravel() * size for a in np.meshgrid(reach, reach))
    c, s = np.cos(angle), np.sin(angle)
    inner = np.column_stack([c * i - s * j, s * i + c * j]) + [width / 2, height / 2]
    # far less than an element: so that no four points lie on one circle
    shift = max(jitter, 1e-3) * size
    inner += shift * np.random.default_rng(seed).uniform(-1, 1, inner.shape)
    margin = 0.6 * size
    x, y = inner.T
    kept = (x > margin) & (x < width - margin) & (y > margin) & (y < height - margin)
    nodes = np.concatenate([_outline(width, height, size), inner[kept]])
    triangles = Delaunay(nodes).simplices
    a, b, d = (nodes[triangles[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (d - a)[:, 1] - (b - a)[:, 1] * (d - a)[:, 0]
    solid = abs(area) > 1e-9 * size**2  # slivers along the outline have no area
    turned = np.where((area < 0)[:, None], triangles[:, ::-1], triangles)[solid]
    body = np.zeros(len(turned), np.int32)
    sets = edges_of_rectangle(nodes, width, height)
    return Mesh(nodes, turned.astype(np.int32), body, (ROCK,), sets)


def _outline(width, height, size):
    """Points around a rectangle, about `size` apart."""
    across = np.linspace(0, width, max(1, round(width / size)) + 1)
    up = np.linspace(0, height, max(1, round(height / size)) + 1)[1:-1]
    return np.concatenate(
        [
            np.column_stack([across, np.full_like(across, end)]) for end in (0.0, height)
        ] + [np.column_stack([np.full_like(up, side), up]) for side in (0.0, width)]
    )  # fmt: skip


def weakened(mesh):
    """Make the elements that the line at half the height runs through a second body, `weak`.

    The two bodies share their nodes, and cracks may run in both.
    """
    height = mesh.nodes[:, 1].max()
    y = mesh.nodes[mesh.triangles, 1] - height / 2
    crossed = (y.min(axis=1) < 0) & (y.max(axis=1) > 0)
    return replace(mesh, body=crossed.astype(np.int32), body_names=(ROCK, WEAK))


def energy_factor(mesh):
    """Energy that opening the weak row takes, over Gf times the width of the bar [-].

    The band of smeared cracks is as high as the row, but every element spends its energy over its
    own width h_c = sqrt(2 A) (Klerck 2004, eq. 15). 1 for rows of right-angled triangles.
    """
    weak = mesh.body == mesh.body_names.index(WEAK)
    area = mesh.areas()[weak]
    width = np.ptp(mesh.nodes[:, 0])
    return float((area / np.sqrt(2 * area)).sum() / width)


def pulled_bar(mesh, material, speed, strain, weak_strength=0.9, fracture=None, **changes):
    """Bar on a roller, pulled at its top at a constant speed after a smooth start.

    Parameters
    ----------
    mesh : of a bar, `weakened` or not
    speed : of the top [m/s]
    strain : at the end of the run [-]
    weak_strength : tensile strength of the weak row over that of the rest; its energy is equal
    fracture : `None` for smeared cracks alone
    """
    height = mesh.nodes[:, 1].max()
    materials = [material]
    if WEAK in mesh.body_names:
        weaker = weak_strength * material.tensile_strength_MPa
        materials.append(material.model_copy(update={"tensile_strength_MPa": weaker}))
    ramp = Ramp(0.0, 10 * height / material.wave_speed)
    bottom = mesh.nodes_of("bottom")
    given = {
        "materials": tuple(materials),
        "velocity_loads": (
            hold("base", bottom, 1),
            hold("corner", bottom[np.argmin(mesh.nodes[bottom, 0])][None], 0),
            hold("top", mesh.nodes_of("top"), 1, speed, ramp=ramp),
        ),
        "end_time": ramp.duration / 2 + strain * height / speed,
        "damping": Damping(0.3),
        "contact": Contact() if fracture else None,
        "fracture": fracture,
    }
    return problem(mesh, **(given | changes))
