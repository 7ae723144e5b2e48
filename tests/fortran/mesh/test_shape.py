"""Shape of triangles (fortran/mesh/shape.f90)."""

import numpy as np
import pytest
from models import Elastic, problem, rectangle

from lithofrac.core import Run
from lithofrac.topology import triangle_shapes


def random_triangles(n, aspect, rng):
    """Counter-clockwise triangles in a square that is stretched up to `aspect` times."""
    corners = rng.uniform(size=(n, 3, 2))
    corners[..., 0] *= aspect ** rng.uniform(size=(n, 1))
    ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    corners[area < 0] = corners[area < 0][:, ::-1]
    return corners[abs(area) > 1e-3]


def exact_length(corners, poisson):
    """2 c_p / omega from the eigenvalues of the free element with lumped mass (unit density)."""
    inverse = np.linalg.inv(np.concatenate([np.ones((len(corners), 3, 1)), corners], axis=2))
    b = np.zeros((len(corners), 3, 6))
    b[:, 0, 0::2] = b[:, 2, 1::2] = inverse[:, 1]
    b[:, 1, 1::2] = b[:, 2, 0::2] = inverse[:, 2]
    k = poisson / (1 - poisson)  # moduli over that of the P wave
    d = np.zeros((len(corners), 3, 3))
    d[:, 0, 0] = d[:, 1, 1] = 1.0
    d[:, 0, 1] = d[:, 1, 0] = k
    d[:, 2, 2] = 0.5 * (1 - k)
    omega2 = 3 * np.linalg.eigvalsh(b.transpose(0, 2, 1) @ d @ b)[:, -1]
    return 2 / np.sqrt(omega2)


def test_critical_length_is_that_of_the_highest_frequency(n_random):
    rng = np.random.default_rng(1)
    corners = random_triangles(n_random(20_000), 100.0, rng)
    poisson = rng.uniform(-0.9, 0.4999, len(corners))
    length, _, _ = triangle_shapes(corners, poisson)
    np.testing.assert_allclose(length, exact_length(corners, poisson), rtol=1e-9)


def test_critical_length_is_what_a_run_takes_for_its_step():
    rock = Elastic(poisson=0.25)
    mesh = rectangle(5, 4, jitter=0.3)
    limit, element = Run(problem(mesh, rock)).critical_step
    length, _, _ = triangle_shapes(mesh.nodes[mesh.triangles], rock.poisson)
    speed = np.sqrt(rock.modulus / rock.density)
    assert length.argmin() == element
    assert length.min() / speed == pytest.approx(limit, rel=1e-12)


def test_critical_length_grows_with_the_triangle_and_does_not_turn_with_it():
    rng = np.random.default_rng(2)
    corners = random_triangles(1000, 10.0, rng)
    angle = 0.7
    turned = 3 * corners @ [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    before, after = (triangle_shapes(c, 0.3)[0] for c in (corners, turned))
    np.testing.assert_allclose(after, 3 * before, rtol=1e-12)


def test_angle_and_edges_of_a_right_triangle():
    _, angle, square = triangle_shapes([[[0, 0], [2, 0], [0, 1]]], 0.2)
    assert angle[0] == pytest.approx(np.arctan(0.5), rel=1e-15)
    assert square[0] == pytest.approx((4 + 1 + 5) / 3, rel=1e-15)
