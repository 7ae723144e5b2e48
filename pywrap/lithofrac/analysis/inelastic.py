"""Inelastic strain of the specimen at one moment, from the stress and strain of a frame."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import meshio
import numpy as np

from lithofrac.analysis.frames import Frame, frame_times
from lithofrac.analysis.runs import Run


@dataclass(frozen=True)
class Inelastic:
    """Inelastic strain of the elements of the specimen, tension positive.

    Attributes
    ----------
    frame : mesh of the specimen at that moment
    tensor : (m, 2, 2) inelastic strain in the plane, in the axes of space [-]
    opening : (m, 3) fracturing strains of the tension planes [-]
    """

    frame: Frame
    tensor: np.ndarray
    opening: np.ndarray

    @cached_property
    def principal(self) -> tuple[np.ndarray, np.ndarray]:
        """Values (m, 2), the most compressive first, and directions (m, 2, 2) in their columns."""
        return np.linalg.eigh(self.tensor)

    @property
    def damaged(self) -> np.ndarray:
        """Elements that have yielded in compression or in tension, (m,) bool."""
        return (self.frame.plastic_strain > 0.0) | np.any(self.opening > 0.0, axis=1)


def load_inelastic(run: Run, time_s: float, path: Path) -> Inelastic:
    """Total strain less the elastic strain of the stress, turned with the element.

    Frames hold both in the axes that turn with the material, where they add up exactly.
    """
    grid = meshio.read(path)
    whole = Frame.load(path, time_s)
    chosen = run.is_rock(whole)
    cells = {name: values[0][chosen] for name, values in grid.cell_data.items()}
    frame = whole.part(chosen)
    young, poisson = run.rock.young, run.rock.poisson
    stress, strain = cells["stress_Pa"], cells["strain"]
    trace = stress[:, :3].sum(axis=1)
    along = strain[:, :2] - ((1.0 + poisson) * stress[:, :2] - poisson * trace[:, None]) / young
    shear = 0.5 * strain[:, 3] - (1.0 + poisson) * stress[:, 3] / young
    tensor = np.stack([along[:, 0], shear, shear, along[:, 1]], axis=1).reshape(-1, 2, 2)
    turn = _turns(frame)
    return Inelastic(frame, turn @ tensor @ turn.transpose(0, 2, 1), cells["fracturing_strain"])


def first_damage(run: Run) -> Inelastic | None:
    """The earliest frame in which any element is damaged, or None."""
    for time_s, path in frame_times(run.folder):
        if time_s > 0.0:
            found = load_inelastic(run, time_s, path)
            if found.damaged.any():
                return found
    return None


def frame_at(run: Run, time_s: float) -> tuple[float, Path]:
    """The first frame at or after a moment [s], the last where none is as late."""
    frames = frame_times(run.folder)
    return next((one for one in frames if one[0] >= time_s * (1.0 - 1e-9)), frames[-1])


def _turns(frame: Frame) -> np.ndarray:
    """Rotation of each element, of the polar decomposition of its deformation, (m, 2, 2)."""
    corners, moved = frame.nodes[frame.triangles], frame.moved()[frame.triangles]
    before = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
    after = (moved[:, 1:] - moved[:, :1]).transpose(0, 2, 1)
    gradient = after @ np.linalg.inv(before)
    angle = np.arctan2(gradient[:, 1, 0] - gradient[:, 0, 1], gradient[:, 0, 0] + gradient[:, 1, 1])
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([cos, -sin, sin, cos], axis=1).reshape(-1, 2, 2)
