"""Two materials that share their nodes, one up to a million times as stiff as the other."""

from dataclasses import replace

import numpy as np
import pytest
from models import Elastic, hold, problem, rectangle

from lithofrac.core import Run

pytestmark = pytest.mark.verification
COLUMNS = 160  # of either side
CENTRE, WIDTH = -90.0, 14.0  # of the pulse
SIZE = 1e-6  # its largest velocity


def bar(ratio):
    """Soft columns of width 1 left of x = 0, stiff ones right of it, between rollers.

    These are as wide as a wave runs in the same time, so that both sides tell the pulse apart as
    well, and have the same step.
    """
    wide = np.sqrt(ratio)
    mesh = rectangle(2 * COLUMNS, 1, 2.0 * COLUMNS, wide)
    nodes = mesh.nodes - [COLUMNS, 0.0]
    nodes[:, 0] = np.where(nodes[:, 0] > 0.0, wide * nodes[:, 0], nodes[:, 0])
    mesh = replace(mesh, nodes=nodes)
    body = (mesh.centroids()[:, 0] > 0.0).astype(np.int32)
    mesh = replace(mesh, body=body, body_names=("soft", "stiff"))
    rollers = tuple(hold(name, mesh.nodes_of(name), 1) for name in ("bottom", "top"))
    materials = tuple(Elastic(young=young, poisson=0.0, density=1.0) for young in (1.0, ratio))
    return problem(mesh, materials=materials, velocity_loads=rollers)


def sent(ratio):
    """A run with a pulse in the soft side that moves towards the interface at speed 1."""
    run = Run(bar(ratio))
    x = run.problem.mesh.nodes[:, 0]
    grid = np.linspace(CENTRE - 10 * WIDTH, CENTRE + 10 * WIDTH, 20_001)
    height = np.exp(-(((grid - CENTRE) / WIDTH) ** 2))
    way = np.cumsum(height) * (grid[1] - grid[0])
    u, v = np.zeros_like(run.problem.mesh.nodes), np.zeros_like(run.problem.mesh.nodes)
    u[:, 0] = SIZE * np.interp(x, grid, way[-1] - way)  # du/dx = -v/c
    v[:, 0] = SIZE * np.interp(x, grid, height)
    run.set_motion(u, v)
    run.advance(0)
    return run


def test_a_wave_is_reflected_as_the_impedances_say_and_nothing_grows(n_random):
    """(Z1 - Z2)/(Z1 + Z2) of the velocity at three contrasts; bounded for 10^5 steps at 1e6."""
    for ratio in (4.0, 1e2, 1e6):
        run = sent(ratio)
        soft = run.problem.mesh.nodes[:, 0] < -20.0
        run.advance(round(-2 * CENTRE / run.dt))  # back where it was
        velocity = run.nodes()[1][soft, 0] / SIZE
        exact = (1.0 - np.sqrt(ratio)) / (1.0 + np.sqrt(ratio))
        found = velocity[np.argmax(abs(velocity))]
        print(f"ratio {ratio:g}: {run.step} steps, reflected {found:.5f}, exact {exact:.5f}")
        assert found == pytest.approx(exact, rel=5e-3)
    start = run.energy().initial
    run.advance(n_random(100_000, least=2000))
    energy = run.energy()
    assert abs(energy.kinetic + energy.elastic - start) < 1e-8 * start
