"""Lumped mass, eq. 2 (fortran/mechanics/lumped_mass.f90)."""

import numpy as np
import pytest
from models import Elastic, problem, rectangle

from lithofrac.core import Run


def masses(axisymmetric):
    mesh = rectangle(7, 5, 2.0, 3.0, jitter=0.3)
    return mesh, Run(problem(mesh, axisymmetric=axisymmetric)).nodes()[2]


def test_sum_is_the_mass_of_the_body():
    assert masses(False)[1].sum() == pytest.approx(Elastic().density * 2.0 * 3.0, rel=1e-13)


def test_sum_in_axisymmetry_is_the_mass_of_the_cylinder_per_radian():
    assert masses(True)[1].sum() == pytest.approx(Elastic().density * 0.5 * 2.0**2 * 3.0, rel=1e-13)


def test_each_corner_has_the_integral_of_its_shape_function_times_the_radius():
    """Three-point Gauss quadrature, exact for the quadratic N_a r."""
    mesh, found = masses(True)
    points = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6
    corners = mesh.nodes[mesh.triangles, 0]
    radius = corners @ points.T
    share = (radius[:, :, None] * points[None]).sum(axis=1) / 3 * mesh.areas()[:, None]
    expected = np.zeros(len(mesh.nodes))
    np.add.at(expected, mesh.triangles, share * Elastic().density)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
