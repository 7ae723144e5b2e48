"""Thick-walled cylinder of a perfectly plastic Mohr-Coulomb rock, in plane strain.

The cylinder a < r < b is under the pressure p0 within and without; then the inner one falls to
p_i. Compression positive here, N = (1 + sin phi)/(1 - sin phi), Y = 2 c cos phi/(1 - sin phi),
K = (1 + sin psi)/(1 - sin psi), w the way inward since p0.

Plastic ring, a < r < rp: the yield condition s_t = N s_r + Y in d s_r/dr = (s_t - s_r)/r gives

    s_r = (p_i + Y/(N - 1)) (r/a)^(N-1) - Y/(N - 1).

Elastic ring (Lame): s_r = A - B/r^2, s_t = A + B/r^2; A = p0 + B/b^2 from s_r(b) = p0, and yield
at rp gives B = (Y + (N - 1) p0) / ((N + 1)/rp^2 - (N - 1)/b^2). The radial stress is continuous at
rp, which is the equation for rp.

Displacement: elastic strains of the change D of stress since p0 are
e_t = ((1 + nu)/E) ((1 - nu) D s_t - nu D s_r), e_r alike, and w(rp) = rp e_t(rp). In the plastic
ring the flow e_r^p = -K e_t^p, without a part along the axis, leaves dw/dr + K w/r = e_r + K e_t of
the elastic strains, g = G0 + G1 (r/a)^(N-1), hence

    w(a) a^K = w(rp) rp^K - integral from a to rp of g r^K dr.

Small strains; the axial stress nu (s_r + s_t) stays between the other two wherever rock yields
(checked in the tests). Source: Salencon 1969, Annales des Ponts et Chaussees, "Contraction
quasi-statique d'une cavite a symetrie spherique ou cylindrique dans un milieu elastoplastique",
here for a finite b; the unbounded one in Yu 2000, Cavity Expansion Methods in Geomechanics, 3.3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from lithofrac.accuracy.subject import Outcome, Subject, outcome, timed_run
from lithofrac.config.material import Material
from lithofrac.problem import Damping, Mesh, PressureLoad, Problem, Ramp, VelocityLoad
from lithofrac.scenes._rectangle import rectangle

INNER, OUTER = 25e-3, 125e-3  # radii [m]
FAR, INSIDE = 20e6, 2e6  # p0 and p_i [Pa]
HOLD = 5.0  # transits after the ramp


def rock() -> Material:
    """Perfectly plastic, dilation below friction; stiff, so that strains stay small."""
    return Material(
        young_modulus_GPa=70.0,
        poisson_ratio=0.3,
        density_kg_m3=2700.0,
        tensile_strength_MPa=4.0,  # nothing is in tension
        fracture_energy_J_m2=1000.0,
        plastic_strain=(0.0,),
        cohesion_MPa=(3.0,),
        friction_angle_deg=(30.0,),
        dilation_angle_deg=(10.0,),
    )


@dataclass(frozen=True)
class Cylinder:
    """The closed form; lengths [m], stresses [Pa], compression positive."""

    inner: float
    outer: float
    far: float
    inside: float
    young: float
    poisson: float
    cohesion: float
    friction: float  # [rad]
    dilation: float  # [rad]

    @property
    def slope(self) -> float:
        """N."""
        return (1 + np.sin(self.friction)) / (1 - np.sin(self.friction))

    @property
    def strength(self) -> float:
        """Y, uniaxial strength [Pa]."""
        return 2 * self.cohesion * np.cos(self.friction) / (1 - np.sin(self.friction))

    @property
    def flow(self) -> float:
        """K."""
        return (1 + np.sin(self.dilation)) / (1 - np.sin(self.dilation))

    def plastic_stress(self, r):
        """Radial stress in the plastic ring."""
        shift = self.strength / (self.slope - 1)
        return (self.inside + shift) * (r / self.inner) ** (self.slope - 1) - shift

    def lame(self, rp: float) -> tuple[float, float]:
        """A and B of an elastic ring that just yields at rp."""
        n = self.slope
        b = (self.strength + (n - 1) * self.far) / ((n + 1) / rp**2 - (n - 1) / self.outer**2)
        return self.far + b / self.outer**2, b

    def plastic_radius(self) -> float:
        """rp [m]; the inner radius where nothing yields."""

        def jump(rp: float) -> float:
            a, b = self.lame(rp)
            return a - b / rp**2 - self.plastic_stress(rp)

        if jump(self.inner) <= 0.0:
            return self.inner
        return brentq(jump, self.inner, self.outer, xtol=1e-15, rtol=1e-14)

    def hoop_strain(self, radial: float, hoop: float) -> float:
        """Elastic hoop strain of stresses since p0."""
        nu = self.poisson
        change = (1 - nu) * (hoop - self.far) - nu * (radial - self.far)
        return (1 + nu) / self.young * change

    def wall_displacement(self) -> float:
        """w(a) [m]."""
        rp, n, k = self.plastic_radius(), self.slope, self.flow
        if rp == self.inner:  # Lame alone
            b = (self.far - self.inside) / (1 / self.inner**2 - 1 / self.outer**2)
            a = self.far + b / self.outer**2
        else:
            a, b = self.lame(rp)
        at_rp = rp * self.hoop_strain(a - b / rp**2, a + b / rp**2)
        shift = self.strength / (n - 1)
        # g = s_r times `per_radial` + constant, from D s_r = s_r - p0 and D s_t = N s_r + Y - p0
        nu, modulus = self.poisson, self.young / (1 + self.poisson)
        of_radial, of_hoop = (1 - nu - k * nu) / modulus, (k * (1 - nu) - nu) / modulus
        per_radial = of_radial + n * of_hoop
        constant = of_hoop * self.strength - (of_radial + of_hoop) * self.far
        g0, g1 = constant - per_radial * shift, per_radial * (self.inside + shift)
        inner = self.inner
        integral = g0 * (rp ** (k + 1) - inner ** (k + 1)) / (k + 1)
        integral += g1 * inner ** (1 - n) * (rp ** (k + n) - inner ** (k + n)) / (k + n)
        return float((at_rp * rp**k - integral) / inner**k)


def closed_form(material: Material) -> Cylinder:
    """The answer for the cylinder that is run."""
    _, cohesion, friction, dilation = material.table[:, 0]
    return Cylinder(
        INNER, OUTER, FAR, INSIDE, material.young, material.poisson, cohesion, friction, dilation
    )


def ring(size: float) -> Mesh:
    """Quarter of the cylinder with the edge sets inner, outer, x and y (the axes it ends on).

    Elements grow with the radius; `size` is theirs at the wall [m].
    """
    flat = rectangle(np.log(OUTER / INNER), np.pi / 2, size / INNER, structured=True, seed=1)
    s, angle = flat.nodes.T
    radius = INNER * np.exp(s)
    nodes = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    nodes[abs(nodes) < 1e-12] = 0.0
    names = {"left": "inner", "right": "outer", "bottom": "x", "top": "y"}
    return replace(
        flat, nodes=nodes, edge_sets={names[name]: edges for name, edges in flat.edge_sets.items()}
    )


def cylinder(
    element_size_mm: float, ramp_transits: float, time_step_factor: float, damping_fraction: float
) -> Outcome:
    """Convergence of the wall as the inner pressure falls, against the closed form."""
    mesh, material = ring(1e-3 * element_size_mm), rock()
    transit = OUTER / material.wave_speed
    inner, fall = mesh.edge_sets["inner"], Ramp(0.0, ramp_transits * transit)
    problem = Problem(
        mesh,
        axisymmetric=False,
        materials=(material,),
        velocity_loads=(
            VelocityLoad("x", mesh.nodes_of("x"), 1),
            VelocityLoad("y", mesh.nodes_of("y"), 0),
        ),
        pressure_loads=(
            PressureLoad("outer", mesh.edge_sets["outer"], FAR),
            PressureLoad("inner", inner, FAR),
            PressureLoad("fall", inner, INSIDE - FAR, ramp=fall),
        ),
        end_time=(ramp_transits + HOLD) * transit,
        damping=Damping(damping_fraction),
        time_step_factor=time_step_factor,
    )
    nu = material.poisson
    strain = -FAR * (1 + nu) * (1 - 2 * nu) / material.young  # the state under p0
    start = strain * mesh.nodes
    run, seconds = timed_run(problem, start, 0.0 * start)
    wall = mesh.nodes_of("inner")
    outward = mesh.nodes[wall] / np.linalg.norm(mesh.nodes[wall], axis=1)[:, None]
    moved = ((run.nodes()[0] - start)[wall] * outward).sum(axis=1)
    exact = closed_form(material).wall_displacement()
    return outcome({"wall displacement": float(-moved.mean() / exact - 1.0)}, run, seconds)


CYLINDER = Subject(
    "mohr_coulomb_cylinder",
    "thick-walled cylinder that yields as its inner pressure falls, quarter model",
    cylinder,
    {
        "element_size_mm": 25.0 / 12.0,
        "ramp_transits": 20.0,
        "time_step_factor": 0.9,
        "damping_fraction": 0.3,
    },
    {
        "element_size_mm": (25.0 / 3.0, 25.0 / 6.0, 25.0 / 24.0),
        "ramp_transits": (2.5, 5.0, 10.0, 40.0),
        "time_step_factor": (0.3, 0.6),
        "damping_fraction": (0.0, 0.1, 0.9),
    },
    ("wall displacement",),
    reasons={
        "wall displacement": "The mesh sets the error, -1.5 % in the limit of slow ramps. A short "
        "ramp lets the wall swing beyond the answer and yield too far: +35 % at 2.5 transits, "
        "+1.2 % at 5, -0.9 % at 10, of which the last two are near on the way past the answer."
    },
)
