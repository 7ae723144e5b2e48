"""A bar that cracks along a weakened row: what it costs, and whether the mesh turns the answer."""

import numpy as np
import pytest
from fracture_models import aligned_bar, brittle, energy_factor, pulled_bar, turned_bar, weakened

from lithofrac.core import Run
from lithofrac.problem import Fracture

pytestmark = pytest.mark.verification
WIDTH, HEIGHT = 6e-3, 18e-3  # m
SPEED = 0.01  # m/s
WEAK = 0.9


def pull(mesh, material, openings):
    """Run until the row has opened `openings` times as far as it can carry stress.

    Returns the run, the highest force [N] and the last one.
    """
    height = mesh.nodes[:, 1].max()
    strength = material.tensile_strength
    critical = 2 * material.fracture_energy / strength  # opening without stress [m], eq. 15
    strain = strength / material.young + openings * critical / height
    fracture = Fracture("inter_element")
    run = Run(pulled_bar(mesh, material, SPEED, strain, WEAK, fracture))
    forces = []
    while run.step * run.dt < run.problem.end_time:
        run.advance(40)
        forces.append(run.loads()[2, 0])
    return run, max(forces), forces[-1]


@pytest.mark.parametrize("columns", [3, 5, 9])
def test_a_crack_along_an_aligned_row_takes_its_fracture_energy(columns):
    """Smeared to exhaustion, then parted: nothing is spent twice, and nothing is carried on.

    Nodes beside the row lie half in sound rock, so that they fail at twice the critical opening.
    """
    mesh = weakened(aligned_bar(columns, 3 * columns, WIDTH / columns))
    material = brittle(fracture_energy=20.0)
    run, peak, last = pull(mesh, material, 4.0)
    spent = run.energy().fracture / (material.fracture_energy * WIDTH)
    print(f"{spent:.5f} of Gf times the area, peak {peak / WIDTH / material.tensile_strength:.4f}")
    assert energy_factor(mesh) == pytest.approx(1.0, rel=1e-12)
    assert spent == pytest.approx(1.0, rel=0.02)
    # the reaction swings a little about the static force
    assert peak == pytest.approx(WEAK * material.tensile_strength * WIDTH, rel=0.02)
    assert abs(last) < 0.01 * peak
    assert len(np.unique(run.parts())) >= 2
    assert abs(run.energy().insertion) < 0.01 * run.energy().fracture
    assert run.energy().residual < 1e-6


def test_a_mesh_turned_against_the_load_does_not_change_the_strength():
    peaks = []
    for angle in np.radians([0.0, 30.0, 45.0]):
        mesh = weakened(turned_bar(0.6e-3, angle, WIDTH, HEIGHT / 2))
        run, peak, _ = pull(mesh, brittle(fracture_energy=1.0), 1.0)
        peaks.append(peak / WIDTH / (WEAK * brittle().tensile_strength))
        assert run.sizes().cracks > 0
    print(f"peak over the strength of the weak row: {np.round(peaks, 4)}")
    assert peaks == pytest.approx([1.0] * 3, rel=0.05)
