"""Coordinates far from the origin: 1e6 lengths away a model does as it does at home."""

from dataclasses import replace

import numpy as np
import pytest
from contact_models import contact_problem, join, moved
from fracture_models import brittle
from models import Elastic, hold, problem, rectangle

from lithofrac.core import CoreError, Run
from lithofrac.problem import Contact, Damping, Fracture, Ramp

pytestmark = pytest.mark.verification

FAR = np.array([8e3, -8e3])  # 1e6 lengths; positions there are exact to 1e-9 of an element


def pushed(mesh, **changes):
    """A damped block pushed from above in a time of many transits."""
    bottom, top = mesh.nodes_of("bottom"), mesh.nodes_of("top")
    loads = (hold("low", bottom, 1), hold("push", top, 1, -0.5, ramp=Ramp(0.0, 1e-5)))
    return problem(mesh, Elastic(), velocity_loads=loads, damping=Damping(0.3), **changes)


def test_damping_far_away_is_damping_at_home():
    """The fit of the damping sums squares of positions: in plain coordinates 1e-5 was lost."""
    here = rectangle(6, 8, 6e-3, 8e-3, jitter=0.2)
    there = replace(here, nodes=here.nodes + FAR)
    runs = [Run(pushed(mesh)) for mesh in (here, there)]
    for run in runs:
        run.advance(500)
    own, other = (run.nodes()[0] for run in runs)
    assert abs(other - own).max() < 1e-8 * abs(own).max()
    assert runs[0].energy().damping < 0.0


def test_positions_are_told_where_they_are():
    """The mesh, the cracks and a refusal name the positions that were given."""
    here = rectangle(6, 9, 6e-3, 9e-3)
    loads = (hold("low", here.nodes_of("bottom"), 1), hold("pull", here.nodes_of("top"), 1, 0.5))
    cracks = []
    for offset in (0.0 * FAR, FAR):
        mesh = replace(here, nodes=here.nodes + offset)
        run = Run(
            problem(
                mesh, brittle(), velocity_loads=loads, damping=Damping(0.3), contact=Contact(),
                fracture=Fracture(),
            )
        )  # fmt: skip
        np.testing.assert_array_equal(run.mesh()[0], mesh.nodes)
        while not len(run.cracks()):
            run.advance(20)
        ends = run.cracks()[:, 2:6].reshape(-1, 2) - offset
        cracks.append(ends)
        assert (ends > -1e-9).all() and (ends < 9e-3 + 1e-9).all()
    low, high = rectangle(4, 4), moved(rectangle(3, 3), (0.2, 0.99))
    mesh = join(low=low, high=high)
    mesh = replace(mesh, nodes=mesh.nodes + 1e3)
    with pytest.raises(CoreError, match=r"node \d+ at +1\.00\dE\+03 +1\.00\dE\+03 m stands"):
        Run(contact_problem(mesh))
