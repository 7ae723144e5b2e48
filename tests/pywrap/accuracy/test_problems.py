"""Problems of the sweep (pywrap/lithofrac/accuracy/problems): answers by another way, settings."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import quad, solve_ivp

from lithofrac.accuracy.problems import SUBJECTS, cases, contacts, cylinder, elastic, fracture
from lithofrac.accuracy.problems.material_point import END_STRAIN, material_point
from lithofrac.analysis.kirsch_series import plate
from lithofrac.config.suite import find_case
from lithofrac.plots.accuracy import KNOBS
from lithofrac.scenes.make import make_mesh

SOLVED = cylinder.closed_form(cylinder.rock())


# Settings


@pytest.mark.parametrize("name", SUBJECTS)
def test_every_knob_is_turned_from_a_default_that_it_has(name):
    subject = SUBJECTS[name]
    assert subject.name == name
    assert set(subject.sweep) <= set(subject.default)
    assert subject.size in subject.sweep
    for knob, values in subject.sweep.items():
        assert subject.default[knob] not in values, knob
    assert set(subject.reasons) <= set(subject.quantities)
    settings = subject.settings()
    assert settings[0] == ("default", subject.default)
    assert len(settings) == 1 + sum(map(len, subject.sweep.values())) + (subject.finest is not None)
    for knob, knobs in settings[1:]:
        turned = {key for key in knobs if knobs[key] != subject.default[key]}
        assert turned == ({knob} if knob != "finest" else set(subject.finest))


@pytest.mark.parametrize(
    ("name", "case"),
    [
        ("bar_wave", "bar_wave"),
        ("kirsch", "kirsch"),
        ("sandstone_triaxial", "sandstone_triaxial_p10"),
        ("hole_r25", "hole_r25.0"),
        ("punch", "punch_discrete"),
    ],
)
def test_default_is_that_of_the_case(name, case):
    found, default = find_case(case).resolved(), SUBJECTS[name].default
    assert default["time_step_factor"] == found["time_step_factor"]
    assert default["damping_fraction"] == found["damping"]["fraction"]
    for knob in ("speed_m_s", "ramp_transits", "hold_transits"):
        if knob in default:
            assert default[knob] == found["loading"][knob]
    scene = found["scene"]
    if "hole_radius_mm" in scene:
        size = scene["hole_radius_mm"] / scene["wall_elements_per_radius"]
    else:
        size = scene.get("strip_element_size_mm", scene["element_size_mm"])
    assert default["element_size_mm"] == pytest.approx(size, rel=1e-12)
    if "contact_tolerance" in default:
        assert default["contact_tolerance"] == found["contact"]["tolerance"]
    if "insertion" in default:
        assert default["insertion"] == found["fracture"]["mode"]
    if "release_steps" in default:
        assert default["release_steps"] == found["fracture"].get("release_steps", "auto")


@pytest.mark.parametrize("name", [name for name, s in SUBJECTS.items() if s.finest is not None])
def test_something_finer_and_something_slower_than_the_default_is_swept(name):
    """Else `for 1 % take` has no answer where the default misses 1 %; no run is the finest."""
    subject = SUBJECTS[name]
    for knob, finest in subject.finest.items():
        assert finest <= min(subject.sweep.get(knob, (finest,))), knob
        if name != "material_point":
            assert min(subject.sweep[knob]) < subject.default[knob], knob
    assert all(
        any(knobs[knob] > value for knob, value in subject.finest.items())
        for turned, knobs in subject.settings()
        if turned != "finest"
    )


class Stopped(Exception):
    """In place of a run."""


@pytest.fixture
def problem_of(monkeypatch):
    """Problem that a subject would run with these knobs; a mesh is made once."""
    meshes = {}

    def kept(case):
        scene = str(case.scene)
        if scene not in meshes:
            meshes[scene] = make_mesh(case)
        return meshes[scene]

    def stopped(problem, out):
        raise Stopped(problem)

    def made(name, **knobs):
        subject = SUBJECTS[name]
        with pytest.raises(Stopped) as raised:
            subject.run(**(subject.default | COARSE[name] | knobs))
        return raised.value.args[0]

    monkeypatch.setattr(cases, "simulate", stopped)
    monkeypatch.setattr(cases, "make_mesh", kept)
    return made


# element sizes [mm] of a quick mesh
COARSE = {
    "sandstone_triaxial": {"element_size_mm": 2.5},
    "hole_r25": {"element_size_mm": 25.0 / 4.0},
    "punch": {"element_size_mm": 2.0},
}
# knob -> what of the problem it is to change
TURNED = {
    "speed_m_s": lambda problem: max(abs(load.speed) for load in problem.velocity_loads),
    "time_step_factor": lambda problem: problem.time_step_factor,
    "damping_fraction": lambda problem: problem.damping.fraction,
    "contact_tolerance": lambda problem: problem.contact.tolerance,
    "insertion": lambda problem: problem.fracture.mode if problem.fracture else "off",
    "release_steps": lambda problem: problem.fracture.release_steps,
}


@pytest.mark.parametrize("name", COARSE)
def test_every_knob_of_a_case_turns_what_it_is_named_after(problem_of, name):
    """And nothing else, but for the end of a run of another speed."""
    subject = SUBJECTS[name]
    default = problem_of(name)
    for knob in set(subject.sweep) - {"element_size_mm"}:
        assert TURNED[knob](default) == (
            None if subject.default[knob] == "auto" else subject.default[knob]
        )
        for value in subject.sweep[knob]:
            turned = problem_of(name, **{knob: value})
            assert TURNED[knob](turned) == value
            for other in set(TURNED) & set(subject.sweep) - {knob}:
                if (knob, value) != ("insertion", "off") or other != "release_steps":
                    assert TURNED[other](turned) == TURNED[other](default), (knob, other)
    fine = problem_of(name, element_size_mm=0.7 * COARSE[name]["element_size_mm"])
    assert len(fine.mesh.triangles) > 1.5 * len(default.mesh.triangles)


def test_punch_cracks_before_its_peak_which_lies_within_the_run(monkeypatch):
    """On elements twice as large as the default, where 5 of its 25 cracks are left."""
    histories = []
    peak = cases._peak
    monkeypatch.setattr(cases, "_peak", lambda run: histories.append(run.history) or peak(run))
    found = cases.punch(**(cases.PUNCH.default | COARSE["punch"]))
    (history,) = histories
    at = int(history["axial_stress_MPa"].to_numpy().argmax())
    assert history["cracks"][at] > 0
    assert at < 0.95 * len(history)
    assert found.values["peak stress"] == history["axial_stress_MPa"][at]


def test_sandstone_reaches_its_peak_within_the_run():
    found = cases.sandstone(**(cases.SANDSTONE.default | COARSE["sandstone_triaxial"]))
    assert found.values["peak stress"] > 0.0


def test_a_stress_that_still_rises_at_the_end_is_no_peak():
    def peak_of(stress):
        run = SimpleNamespace(history=pd.DataFrame({"axial_stress_MPa": stress}))
        return cases._peak(run)["peak stress"]

    assert peak_of([0.0, 2.0, 1.0]) == 2.0
    assert np.isnan(peak_of([0.0, 1.0, 2.0]))


def test_every_knob_of_the_sweep_has_a_mark_in_the_figure():
    assert {knob for subject in SUBJECTS.values() for knob in subject.sweep} == set(KNOBS)


# Cylinder


def test_plastic_ring_is_in_equilibrium_at_yield_and_meets_the_elastic_one():
    """Stress integrated outward from the wall, without the closed form."""
    rp = SOLVED.plastic_radius()
    assert 1.2 * SOLVED.inner < rp < 0.5 * SOLVED.outer

    def rate(r, radial):
        return (SOLVED.slope * radial + SOLVED.strength - radial) / r

    radial = solve_ivp(rate, (SOLVED.inner, rp), [SOLVED.inside], rtol=1e-12, atol=1e-6).y[0, -1]
    a, b = SOLVED.lame(rp)
    assert a - b / rp**2 == pytest.approx(radial, rel=1e-8)
    assert a + b / rp**2 == pytest.approx(SOLVED.slope * radial + SOLVED.strength, rel=1e-8)
    assert a - b / SOLVED.outer**2 == pytest.approx(SOLVED.far, rel=1e-12)


def test_wall_displacement_is_that_of_the_flow_rule_integrated_inward():
    rp, k = SOLVED.plastic_radius(), SOLVED.flow
    a, b = SOLVED.lame(rp)

    def rate(r, w):
        radial = SOLVED.plastic_stress(r)
        hoop = SOLVED.slope * radial + SOLVED.strength
        elastic_sum = SOLVED.hoop_strain(hoop, radial) + k * SOLVED.hoop_strain(radial, hoop)
        return elastic_sum - k * w / r

    start = rp * SOLVED.hoop_strain(a - b / rp**2, a + b / rp**2)
    wall = solve_ivp(rate, (rp, SOLVED.inner), [start], rtol=1e-12, atol=1e-16).y[0, -1]
    assert SOLVED.wall_displacement() == pytest.approx(wall, rel=1e-8)


def test_a_strong_cylinder_moves_as_lame_says():
    strong = replace(SOLVED, cohesion=1e9)
    fall = strong.far - strong.inside
    wide = strong.outer**2 / (strong.outer**2 - strong.inner**2)
    narrow = strong.inner**2 / (strong.outer**2 - strong.inner**2)
    # u(a) of a pressure on the wall alone, plane strain (Timoshenko & Goodier, art. 28)
    lame = (1 + strong.poisson) / strong.young * fall * strong.inner
    lame *= wide + (1 - 2 * strong.poisson) * narrow
    assert strong.plastic_radius() == strong.inner
    assert strong.wall_displacement() == pytest.approx(lame, rel=1e-12)


def test_axial_stress_stays_between_the_other_two_where_rock_yields():
    r = np.linspace(SOLVED.inner, SOLVED.plastic_radius(), 50)
    radial = SOLVED.plastic_stress(r)
    hoop = SOLVED.slope * radial + SOLVED.strength
    axial = SOLVED.poisson * (radial + hoop)
    assert (radial < axial).all()
    assert (axial < hoop).all()


def test_cylinder_converges_to_the_closed_form():
    errors = [
        abs(
            cylinder.cylinder(**(cylinder.CYLINDER.default | {"element_size_mm": 25.0 / n})).values[
                "wall displacement"
            ]
        )
        for n in (6, 12)
    ]
    assert errors[1] < 0.02
    assert errors[0] > 3.0 * errors[1]


# The others


def test_wall_stress_is_read_from_exact_element_stresses():
    case = find_case("kirsch")
    mesh = make_mesh(case)
    exact = plate(4.0, 4.0)
    xx, yy, xy = exact.stress(*mesh.centroids().T / case.scene.radius)
    stress = np.stack([xx, yy, 0 * xx, xy], axis=1)
    for crown, value in ((True, exact.crown), (False, exact.sidewall)):
        found = elastic.wall_stress(case, mesh, stress, crown)
        assert found == pytest.approx(value, rel=2.5e-3)


def test_wave_carries_the_impulse_of_its_pressure():
    """Momentum of the bar at the end of its ramp, against force times time."""
    case = find_case("bar_wave")
    transit = case.scene.height / case.material.wave_speed
    time = case.loading.ramp_transits * transit
    depth = np.linspace(0.0, case.scene.height, 20_001)
    momentum = case.material.density * np.trapezoid(elastic.wave_velocity(case, depth, time), depth)
    assert momentum == pytest.approx(-0.5 * case.loading.stress * time, rel=1e-6)
    assert elastic.wave_velocity(case, np.array([1.01 * time * 1e4]), time)[0] == 0.0


def test_hertz_is_read_from_his_own_ellipse():
    modulus, half = 37e9, contacts.HALF_WIDTH
    edges = np.linspace(-1.2 * half, 1.2 * half, 402)
    peak = half * modulus / (2 * contacts.RADIUS)

    def pressure(x):
        return peak * np.sqrt(max(0.0, 1.0 - (x / half) ** 2))

    forces = [quad(pressure, *ends)[0] for ends in pairwise(edges)]
    found = contacts.ratios(0.5 * (edges[1:] + edges[:-1]), np.array(forces), modulus)
    assert found == pytest.approx((1.0, 1.0), rel=1e-4)


def test_bars_rebound_with_less_error_on_a_finer_mesh():
    errors = [
        contacts.bar_impact(**(contacts.BAR_IMPACT.default | {"element_size_mm": size})).values[
            "restitution"
        ]
        for size in (5.0, 2.5)
    ]
    assert -0.05 < errors[0] < errors[1] < 0.0


def test_hertz_on_a_coarse_mesh_is_near():
    found = contacts.hertz(**(contacts.HERTZ.default | {"element_size_mm": 1.25}))
    assert abs(found.values["peak pressure"]) < 0.05
    assert abs(found.values["half-width"]) < 0.02


def test_crack_across_the_bar_takes_its_fracture_energy_and_its_strength():
    found = fracture.crack_band(**fracture.CRACK_BAND.default)
    assert abs(found.values["fracture energy"]) < 1e-4
    assert abs(found.values["peak force"]) < 0.03  # at 0.02 m/s
    fast = fracture.crack_band(**(fracture.CRACK_BAND.default | {"speed_m_s": 1.0}))
    assert abs(fast.values["peak force"]) > 0.05


def test_smaller_strain_steps_have_smaller_errors():
    coarse, fine = (material_point(END_STRAIN / n) for n in (25, 400))
    assert fine.values["axial stress"] < 0.3 * coarse.values["axial stress"]
    assert fine.steps > coarse.steps >= 25
