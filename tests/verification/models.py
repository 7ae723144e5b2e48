"""Small meshes and problems for the verification tests, made on the spot."""

from dataclasses import dataclass

import numpy as np

from lithofrac import kernels
from lithofrac.core import element_states
from lithofrac.problem import Mesh, Problem, VelocityLoad

NO_OPTIONS = np.array([0, 0, 1, 0], dtype=np.int32)  # compressive, implicit, planes on, no yield


@dataclass(frozen=True)
class Elastic:
    """An elastic body, as the core takes a material [SI]."""

    young: float = 70e9
    poisson: float = 0.25
    density: float = 2700.0
    tensile_strength: float = 0.0
    fracture_energy: float = 0.0
    reference_width: float = 0.0
    band_width: str = "sqrt_2A"

    @property
    def table(self):
        return np.array([[0.0], [0.0], [0.0], [0.0]])

    @property
    def options(self):
        return NO_OPTIONS

    @property
    def modulus(self):
        """P-wave modulus K + 4G/3 [Pa]."""
        nu = self.poisson
        return self.young * (1 - nu) / ((1 + nu) * (1 - 2 * nu))


def rectangle(nx, ny, width=1.0, height=1.0, jitter=0.0, seed=1):
    """Triangles on an nx by ny grid with alternating diagonals and moved interior nodes."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(0, width, nx + 1), np.linspace(0, height, ny + 1))
    nodes = np.column_stack([x.ravel(), y.ravel()])
    inside = (nodes[:, 0] > 0) & (nodes[:, 0] < width) & (nodes[:, 1] > 0) & (nodes[:, 1] < height)
    step = np.array([width / nx, height / ny])
    nodes[inside] += jitter * step * rng.uniform(-1, 1, (inside.sum(), 2))
    i, j = (a.ravel() for a in np.meshgrid(np.arange(nx), np.arange(ny)))
    a = j * (nx + 1) + i
    b, c, d = a + 1, a + nx + 2, a + nx + 1
    even = ((i + j) % 2 == 0)[:, None]
    first = np.where(even, np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    second = np.where(even, np.column_stack([a, c, d]), np.column_stack([b, c, d]))
    triangles = np.stack([first, second], axis=1).reshape(-1, 3).astype(np.int32)
    body = np.zeros(len(triangles), dtype=np.int32)
    return Mesh(nodes, triangles, body, ("rock",), edges_of_rectangle(nodes, width, height))


def edges_of_rectangle(nodes, width, height):
    """Edge sets left, right, bottom, top, material on the left."""
    near = 1e-9 * max(width, height)
    sets = {}
    for name, column, value, along, sign in (
        ("bottom", 1, 0.0, 0, 1),
        ("right", 0, width, 1, 1),
        ("top", 1, height, 0, -1),
        ("left", 0, 0.0, 1, -1),
    ):
        on = np.flatnonzero(abs(nodes[:, column] - value) < near)
        on = on[np.argsort(sign * nodes[on, along])]
        sets[name] = np.column_stack([on[:-1], on[1:]]).astype(np.int32)
    return sets


def one_triangle(size=1e-3):
    """A right isosceles triangle."""
    nodes = size * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    return Mesh(nodes, np.array([[0, 1, 2]], np.int32), np.zeros(1, np.int32), ("rock",), {})


def problem(mesh, material=None, **changes):
    """A free elastic problem in plane strain, with changes."""
    given = {
        "mesh": mesh,
        "axisymmetric": False,
        "materials": (material or Elastic(),),
        "velocity_loads": (),
        "pressure_loads": (),
        "end_time": 1.0,
    }
    return Problem(**(given | changes))


def hold(name, nodes, component, speed=0.0, **ramp):
    """A prescribed velocity; speed 0 holds the nodes."""
    return VelocityLoad(name, np.asarray(nodes, np.int32), component, speed, **ramp)


def element_path(material, nodes, path, axisymmetric=False, band_width=1e-3):
    """Lead one triangle through displacements (n, 3, 2); `(ElementState, forces, dissipated)`."""
    values, forces, dissipated, critical = kernels.element_path(
        nodes.T,
        int(axisymmetric),
        kernels.pack(material).constants,
        material.table,
        material.options,
        band_width,
        np.asarray(path).transpose(2, 1, 0),
    )
    return element_states(values.T), forces.transpose(2, 1, 0), dissipated, critical
