"""What contact forces must balance to in every step, and between bodies that are unlike."""

import numpy as np
import pytest
from contact_models import UNIT, contact_problem, join, moved
from models import Elastic, hold, rectangle

from lithofrac.core import Run
from lithofrac.problem import Contact

pytestmark = pytest.mark.verification


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_contact_forces_cancel_in_every_step(friction):
    """Action and reaction to 1e-13; without friction so do their moments."""
    a = moved(rectangle(4, 4, jitter=0.25), (-0.5, -0.5))
    b = moved(moved(a, turn=0.4), (1.25, 0.45))
    mesh = join(a=a, b=b)
    run = Run(contact_problem(mesh, friction=friction))
    velocity = np.zeros_like(mesh.nodes)
    velocity[: len(a.nodes), 0] = 0.02
    run.set_motion(0 * velocity, velocity)
    force_error = moment_error = 0.0
    pushed = 0
    while run.step * run.dt < 30.0:
        run.advance(1)
        force, x = run.contact_forces(), mesh.nodes + run.nodes()[0]
        size = np.hypot(*force.T)
        if not size.any():
            continue
        pushed += 1
        moment = x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]
        force_error = max(force_error, abs(force.sum(axis=0)).max() / size.sum())
        moment_error = max(moment_error, abs(moment.sum()) / (size * np.hypot(*x.T)).sum())
    print(f"{pushed} steps in contact, force {force_error:.1e}, moment {moment_error:.1e}")
    assert pushed > 10
    assert force_error < 1e-13
    if friction == 0.0:
        assert moment_error < 1e-13


@pytest.mark.parametrize("columns", [8, 5], ids=["matching", "not matching"])
@pytest.mark.parametrize("friction", [0.0, 10.0])
@pytest.mark.parametrize("poisson", [0.0, 0.4999])
@pytest.mark.parametrize(("young", "density"), [(1e6, 1.0), (1e-6, 1.0), (1.0, 1e6), (1.0, 1e-6)])
def test_unlike_blocks_carry_the_pressure_that_they_are_in(
    young, density, poisson, friction, columns
):
    """Each in uniaxial strain from the start: force to 1 %, penetration 1e-5 h.

    A coarse light side has fewer nodes than pairs on a fine heavy one. Sweeps solve that slowly,
    and the core asks more of them where densities are unlike.
    """
    materials = (Elastic(young=young, poisson=poisson, density=density), UNIT)
    low = rectangle(8, 4, 1.0, 0.5, jitter=0.2)
    high = moved(rectangle(columns, 3, 1.0, 0.5, jitter=0.2), (0.0, 0.5))
    mesh = join(low=low, high=high)
    held = (("low.bottom", 1), ("high.top", 1), ("low.left", 0), ("high.left", 0))
    held += (("low.right", 0), ("high.right", 0))
    loads = tuple(hold(name, mesh.nodes_of(name), axis) for name, axis in held)
    contact = Contact(default_friction=friction)
    run = Run(contact_problem(mesh, materials=materials, contact=contact, velocity_loads=loads))
    pressure = 2e-3 * min(material.modulus for material in materials)
    strain = [pressure / material.modulus for material in materials]
    y, n = mesh.nodes[:, 1], len(low.nodes)
    u = np.zeros_like(mesh.nodes)
    u[:n, 1] = -strain[0] * y[:n]
    u[n:, 1] = strain[1] * (1.0 - y[n:]) - 0.5 * sum(strain)
    run.set_motion(u, 0 * u)
    forces = []
    for _ in range(200):
        run.advance(10)
        forces.append(run.contact_forces()[n:, 1].sum())
    energy, statistics = run.energy(), run.contact_statistics()
    work = energy.contact / energy.initial
    error = np.mean(forces) / pressure - 1
    print(f"force off by {error:.1e}, contact work {work:.1e}, {statistics}")
    assert abs(error) < 0.01
    assert statistics.max_penetration_over_h < 1e-5
    assert abs(work) < 1e-2
    assert abs(energy.residual) < 1e-6
