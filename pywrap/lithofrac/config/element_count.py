"""How many elements a scene will have, before it is meshed."""

import math

import numpy as np

from lithofrac.config.scene import HoleQuarter, Scene, SingleElement, Triaxial

MOST_ELEMENTS = 2_000_000
SHAPE = 4 / math.sqrt(3)  # elements per squared edge length, of equilateral triangles


def element_count(scene: Scene) -> float:
    """Estimate of the number of elements, good to some ten percent for meshes that are not tiny."""
    if isinstance(scene, SingleElement):
        return 1.0
    if isinstance(scene, HoleQuarter):
        return _around_hole(scene)
    width, height = _meshed(scene)
    columns, rows = max(1.0, width / scene.element_size), max(1.0, height / scene.element_size)
    return (2.0 if scene.structured else SHAPE) * columns * rows


def _meshed(scene) -> tuple[float, float]:
    """Width and height of the rectangle that is meshed [m]."""
    if not isinstance(scene, Triaxial):
        return scene.width, scene.height
    return scene.radius, scene.height if scene.whole_height else scene.height / 2


def _around_hole(scene: HoleQuarter) -> float:
    """Rings of the graded size field up to the half width, then the corner of the block."""
    radius, half = scene.radius, scene.height / 2
    wall, far = scene.wall_size, scene.element_size
    r = np.geomspace(radius, half, 1000)
    size = np.minimum(wall + (far - wall) * (r - radius) / (half - radius), far)
    rings = np.trapezoid(np.pi / 2 * r / size**2, r)
    corner = (1 - np.pi / 4) * half**2 / far**2
    return SHAPE * float(rings + corner)
