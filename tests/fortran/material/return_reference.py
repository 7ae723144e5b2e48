"""An independent, slow account of the return problem, in numpy, and states to try it on.

Nothing here calls the core. Conditions are those of Klerck, Sellers & Owen 2004: yield functions
(eqs 6, 17), Koiter's rule (eq. 9), complementarity (eq. 10), softening (eqs 16-18). Stresses are
principal, (n, 3), any order, tension positive.
"""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np

from lithofrac import kernels
from lithofrac.config.material import Material

ROCKS = ("quartzite", "sandstone", "tyndall_limestone")
MATERIALS = Path(__file__).parents[3] / "configs" / "materials"
PAIRS = [(i, j) for i in range(3) for j in range(3) if i != j]
COMPRESSIVE, TOTAL = 0, 1
IMPLICIT, EXPLICIT = 0, 1


def material(name: str) -> Material:
    """One of the paper's rocks."""
    return Material.load(MATERIALS / f"{name}.yaml")


def packed(name: str, hardening=COMPRESSIVE, coupling=IMPLICIT, compression=1, **columns):
    """Numbers of a rock; `cohesion`, `friction`, `dilation` put one value in a whole column."""
    rock = kernels.pack(material(name))
    table = rock.table.copy(order="F")
    for row, key in enumerate(("cohesion", "friction", "dilation"), start=1):
        if key in columns:
            table[row] = columns[key]
    options = np.array([hardening, coupling, compression, 1], dtype=np.int32)
    return replace(rock, table=table, options=options)


class Law:
    """Elasticity and strength of a rock in numpy."""

    def __init__(self, rock: kernels.PackedRock):
        young, poisson, _, self.ft, self.gf, _ = rock.constants
        self.g2 = young / (1.0 + poisson)
        self.lame = self.g2 * poisson / (1.0 - 2.0 * poisson)
        self.table = rock.table
        self.total = bool(rock.options[0])
        self.scale = max(self.ft, rock.table[1].max())

    def stress(self, trial, dep):
        """trial - C : dep in principal axes."""
        return trial - self.g2 * dep - self.lame * dep.sum(axis=-1, keepdims=True)

    def strength(self, e):
        """(sin phi, c cos phi, sin psi) at effective plastic strains."""
        cohesion, phi, psi = (np.interp(e, self.table[0], self.table[i]) for i in (1, 2, 3))
        return np.sin(phi), cohesion * np.cos(phi), np.sin(psi)

    def yields(self, stress, e):
        """Six Mohr-Coulomb yield functions (n, 6) [Pa], order of `PAIRS`."""
        sin_phi, k, _ = self.strength(e)
        high, low = (stress[:, [pair[side] for pair in PAIRS]] for side in (0, 1))
        return 0.5 * (high - low) + 0.5 * (high + low) * sin_phi[:, None] - k[:, None]

    def softened(self, ft, softening, dep):
        """Tensile strengths after the step (eq. 18)."""
        return np.maximum(0.0, ft + np.reshape(softening, (-1, 1)) * np.maximum(0.0, dep))


def violations(law, softening, trial, ft, e_old, e, dep, compressive, checked_strength=None):
    """How badly returns break the conditions, each (n,), relative to the strength scale.

    `yield`: largest yield function; `multiplier`: most negative multiplier times 2 G;
    `complementarity`: flow of planes that are not met, times 2 G; `hardening`: mismatch of
    eq. 7, a strain times 2 G. `checked_strength` (n, 3) replaces the softened strength in the
    check of tension planes without flow.
    """
    stress = law.stress(trial, dep)
    rounding = 1e-12 * np.abs(dep).max(axis=1)
    near = 1e-9 * law.scale
    softened = law.softened(ft, softening, dep)
    opening = dep - compressive
    flows = opening > rounding[:, None]
    limit = softened if checked_strength is None else np.where(flows, softened, checked_strength)
    planes = law.yields(stress, e)
    worst = np.maximum((stress - limit).max(axis=1), planes.max(axis=1))
    strain_scale = law.g2 / law.scale
    off_plane = np.where(flows & (np.abs(stress - softened) > near), opening, 0.0).max(axis=1)
    negative, outside = _cone(law, stress, planes, e, compressive, near)
    norm = np.linalg.norm(dep if law.total else compressive, axis=1) * np.sqrt(2.0 / 3.0)
    return {
        "yield": worst / law.scale,
        "multiplier": (np.maximum(-opening.min(axis=1), negative) - rounding) * strain_scale,
        "complementarity": (np.maximum(off_plane, outside) - rounding) * strain_scale,
        "hardening": (np.abs(e - e_old - norm) - rounding - 1e-15) * strain_scale,
    }


def _cone(law, stress, planes, e, flow, near):
    """(most negative multiplier, distance) of `flow` from the cone of the planes that are met."""
    n = len(stress)
    rows = np.arange(n)[:, None]
    order = np.argsort(-stress, axis=1, kind="stable")
    x = flow[rows, order]
    sin_psi = law.strength(e)[2]
    a, b = 0.5 * (1.0 + sin_psi), 0.5 * (1.0 - sin_psi)
    met = np.zeros((n, 3, 3), dtype=bool)
    for column, (i, j) in enumerate(PAIRS):
        met[:, i, j] = planes[:, column] >= -near
    sorted_met = met[rows[:, :, None], order[:, :, None], order[:, None, :]]
    main, second, third = sorted_met[:, 0, 2], sorted_met[:, 1, 2], sorted_met[:, 0, 1]
    # One plane (1, 3), an edge with (2, 3) or with (1, 2), or all of them.
    first = x[:, 0] / a
    single = (-first, np.maximum(np.abs(x[:, 1]), np.abs(x[:, 2] + b * first)))
    upper = (-np.minimum(first, x[:, 1] / a), np.abs(x[:, 2] + b * (x[:, 0] + x[:, 1]) / a))
    lower = (
        np.maximum(x[:, 1], x[:, 2]) / b,
        np.abs(x[:, 0] + a * (x[:, 1] + x[:, 2]) / b),
    )
    volume = x.sum(axis=1)
    apex = np.maximum(sin_psi * x.max(axis=1) - a * volume, -sin_psi * x.min(axis=1) - b * volume)
    none = (np.zeros(n), np.abs(x).max(axis=1))
    cases = [~main, second & third, second, third]
    negative = np.select(cases, [none[0], np.zeros(n), upper[0], lower[0]], single[0])
    outside = np.select(cases, [none[1], apex, upper[1], lower[1]], single[1])
    return negative, np.maximum(outside, 0.0)


def least_increment(law, softening, trial, ft, e):
    """Smallest effective plastic strain increment (n,) that is admissible at fixed strength.

    Brute force over every group of up to three of the nine planes and every stage of its
    tension planes (intact, softening, exhausted); infinite where nothing is admissible.
    """
    n = len(trial)
    sin_phi, k, sin_psi = law.strength(e)
    unit = np.eye(3)
    normal, flow = np.zeros((9, n, 3)), np.zeros((9, n, 3))
    for i in range(3):
        normal[i] = flow[i] = unit[i]
    for plane, (i, j) in enumerate(PAIRS, start=3):
        for vectors, sine in ((normal, sin_phi), (flow, sin_psi)):
            vectors[plane] = 0.5 * np.outer(1.0 + sine, unit[i]) - 0.5 * np.outer(
                1.0 - sine, unit[j]
            )
    stiff = law.g2 * unit + law.lame
    best = np.full(n, np.inf)
    for size in range(4):
        for group in itertools.combinations(range(9), size):
            tension = [plane for plane in group if plane < 3]
            for stages in itertools.product((0, 1, 2), repeat=len(tension)):
                increment = _try_group(
                    law, softening, trial, ft, e, k, normal, flow, stiff, group, tension, stages
                )
                best = np.minimum(best, increment)
    return best


def _try_group(law, softening, trial, ft, e, k, normal, flow, stiff, group, tension, stages):
    n, size = len(trial), len(group)
    matrix, right = np.zeros((n, size, size)), np.zeros((n, size))
    for row, plane in enumerate(group):
        loaded = normal[plane] @ stiff
        right[:, row] = (normal[plane] * trial).sum(axis=1)
        if plane < 3:
            stage = stages[tension.index(plane)]
            if stage == 1:
                loaded = loaded + softening[:, None] * normal[plane]
            right[:, row] -= ft[:, plane] if stage < 2 else 0.0
        else:
            right[:, row] -= k
        for column, other in enumerate(group):
            matrix[:, row, column] = (loaded * flow[other]).sum(axis=1)
    dep, compressive = np.zeros((n, 3)), np.zeros((n, 3))
    good = np.ones(n, dtype=bool)
    if size:
        size_of = np.prod(np.linalg.norm(matrix, axis=2), axis=1)
        good &= np.abs(np.linalg.det(matrix)) > 1e-9 * size_of
        matrix[~good] = np.eye(size)
        lam = np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
        good &= lam.min(axis=1) >= -1e-12
        for column, plane in enumerate(group):
            part = lam[:, column, None] * flow[plane]
            dep += part
            if plane >= 3:
                compressive += part
    left = ft + softening[:, None] * dep
    near = 1e-8 * law.scale
    for plane, stage in zip(tension, stages, strict=True):
        if stage == 0:
            good &= dep[:, plane] <= 1e-13
        elif stage == 1:
            good &= (dep[:, plane] >= -1e-13) & (left[:, plane] >= -near)
        else:
            good &= left[:, plane] <= near
    stress = law.stress(trial, dep)
    good &= (stress - law.softened(ft, softening, dep)).max(axis=1) <= near
    good &= law.yields(stress, e).max(axis=1) <= near
    norm = np.linalg.norm(dep if law.total else compressive, axis=1) * np.sqrt(2.0 / 3.0)
    return np.where(good, norm, np.inf)


def random_returns(law, rng, n, limit=0.9):
    """Random principal returns: softening (n,), trials (n, 3), strengths (n, 3), strain (n,).

    Strengths are softened and anisotropic, stresses from a tenth to a thousand strengths, a
    share of them with equal values, with one large pressure, or close to the yield surface.
    """
    softening = -law.g2 * limit * rng.choice([0.0, 1e-4, 0.01, 0.3, 1.0], n)
    ft = law.ft * np.clip(rng.uniform(-0.5, 1.5, (n, 3)), 0.0, 1.0)
    knots = law.table[0]
    e = np.where(rng.random(n) < 0.5, rng.choice(knots, n), rng.uniform(0.0, 1.2 * knots[-1], n))
    size = law.scale * 10.0 ** rng.uniform(-1.0, 3.0, (n, 1))
    trial = size * rng.normal(size=(n, 3)) - size * rng.choice([0.0, 0.0, 1.0, 3.0], (n, 1))
    pair = rng.integers(0, 3, n)
    equal = rng.random(n) < 0.1
    rows = np.arange(n)
    trial[rows[equal], pair[equal]] = trial[rows[equal], (pair[equal] + 1) % 3]
    ft[rows[equal], pair[equal]] = ft[rows[equal], (pair[equal] + 1) % 3]
    return softening, trial, ft, e
