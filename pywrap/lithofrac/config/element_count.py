"""How many elements a scene will have, before it is meshed."""

import math

import numpy as np

from lithofrac.config.platens import PlatensSection
from lithofrac.config.scene import (
    Brazilian,
    Hole,
    HoleInBlock,
    Punch,
    Scene,
    SingleElement,
    Triaxial,
)

MOST_ELEMENTS = 2_000_000
SHAPE = 4 / math.sqrt(3)  # elements per squared edge length, of equilateral triangles


def element_count(scene: Scene) -> float:
    """Estimate of the number of elements of the rock, good to some ten percent unless tiny."""
    if isinstance(scene, SingleElement):
        return 1.0
    if isinstance(scene, HoleInBlock):
        return (2 if isinstance(scene, Hole) else 1) * _quarter_around_hole(scene)
    if isinstance(scene, Punch):
        return _under_strip(scene)
    if isinstance(scene, Brazilian):
        return SHAPE * math.pi * scene.radius**2 / scene.element_size**2
    width, height = _meshed(scene)
    columns, rows = max(1.0, width / scene.element_size), max(1.0, height / scene.element_size)
    return (2.0 if scene.structured else SHAPE) * columns * rows


def _meshed(scene) -> tuple[float, float]:
    """Width and height of the rectangle that is meshed [m]."""
    if not isinstance(scene, Triaxial):
        return scene.width, scene.height
    return scene.radius, scene.height if scene.whole_height else scene.height / 2


def _quarter_around_hole(scene: HoleInBlock) -> float:
    """Rings of the graded size field up to the half width, then the corner of the block."""
    radius, half = scene.radius, scene.height / 2
    wall, far = scene.wall_size, scene.element_size
    r = np.geomspace(radius, half, 1000)
    size = np.minimum(wall + (far - wall) * (r - radius) / (half - radius), far)
    rings = np.trapezoid(np.pi / 2 * r / size**2, r)
    corner = (1 - np.pi / 4) * half**2 / far**2
    return SHAPE * float(rings + corner)


def _under_strip(scene: Punch) -> float:
    """Sum over a raster of the block, which is much finer than the size field."""
    n = 200
    x = (np.arange(n) + 0.5) / n * scene.width - scene.width / 2
    depth = (np.arange(n) + 0.5) / n * scene.block_height
    distance = np.hypot(*np.meshgrid(x, depth))
    grown = np.clip(
        (distance - scene.fine_radius) / (scene.block_height - scene.fine_radius), 0.0, 1.0
    )
    size = scene.fine_size + grown * (scene.element_size - scene.fine_size)
    strip = scene.strip_width * (scene.height - scene.block_height) / scene.fine_size**2
    return SHAPE * float(strip + scene.width * scene.block_height * np.mean(1 / size**2))


def platen_count(scene: Scene, platens: PlatensSection) -> float:
    """The same of all platens."""
    count = 0.0
    for length, size in _platen_faces(scene, platens.overhang):
        edge = size * platens.element_size_over_rock
        count += 2.0 * max(1.0, length / edge) * max(1.0, platens.thickness / edge)
    return count


def _platen_faces(scene: Scene, overhang: float) -> list[tuple[float, float]]:
    """Length of the face of each platen and edge length of the rock before it [m]."""
    size, over = scene.element_size, 2.0 * overhang
    if isinstance(scene, Punch):
        beside = (scene.fine_size + size) / 2
        return [(scene.strip_width + over, scene.fine_size), *[(scene.block_height, beside)] * 2]
    if isinstance(scene, Hole):
        return [(scene.height + over, size)]
    if isinstance(scene, Brazilian):
        return [(scene.flat_width + over, size)] * 2
    faces = [(scene.width + over, size)] * 2
    return faces + [(scene.height, size)] * 2 if scene.lateral_platens else faces
