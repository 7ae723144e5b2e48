"""Rocks fitted to tests whose rock is known, and to a measured one (analysis/rock_fit.py)."""

import numpy as np
import pytest

from lithofrac import point
from lithofrac.analysis.mohr_coulomb import peak_strength
from lithofrac.analysis.rock_fit import POINTS, fit_rock, sampled, unknowns
from lithofrac.analysis.rock_start import (
    elastic_constants,
    elastic_errors,
    first_table,
    one_row,
    table_at,
)
from lithofrac.analysis.zigong_prediction import zigong_prediction, zigong_prediction_error
from lithofrac.config import Material
from lithofrac.config.material import COLUMNS
from lithofrac.data.triaxial import Triaxial, load_triaxial

NO_DILATION = np.zeros((2, 1))  # of no use where lateral strains were measured
ROCKS = ("sandstone", "quartzite", "tyndall_limestone")
STEPS = 1500  # of a generated curve: an error of the bench well below that of the fit
no_core = pytest.mark.no_core


def strengths(rock, confinements, noise=0.0, random=None):
    """Strengths in closed form as tests, with noise [MPa]."""
    nothing = np.zeros(0)
    found = []
    for p in confinements:
        value = peak_strength(rock.table, 1e6 * p)[0] / 1e6
        value += random.normal(0.0, noise) if noise else 0.0
        found.append(Triaxial(f"{p:g} MPa", p, value, nothing, nothing))
    return found


def one_row_of(rock, cohesion=10.0, friction=30.0):
    """The rock with a table of one row."""
    values = (0.0, cohesion, friction, 10.0)
    one = {key: (value,) for key, value in zip(COLUMNS, values, strict=True)}
    return rock.model_copy(update=one)


def last_row(rock):
    """Plastic strain at which the generated curves end: a row of the table, behind the peak."""
    return max(strain for strain in rock.plastic_strain if strain <= 0.011)


def curves_of(rock, confinements=(0.0, 20.0)):
    """Triaxial curves of a rock, up to its `last_row`."""
    found = []
    for p in confinements:
        curve = point.drive(rock, confinement_MPa=p, end_strain=0.025, steps=STEPS)
        reached = curve["plastic_strain"] <= last_row(rock) + 1e-9
        curve = curve[reached].drop_duplicates("axial_strain")
        columns = (curve[key].to_numpy() for key in ("axial_strain", "axial_stress_MPa"))
        top, lateral = curve["axial_stress_MPa"].max(), curve["lateral_strain"].to_numpy()
        found.append(Triaxial(f"{p:g} MPa", p, top, *columns, lateral))
    return found


@pytest.fixture(scope="module")
def curves():
    return curves_of(Material.load("sandstone"))


def fitted_to(curves, base, start):
    table = dict(zip(COLUMNS, (tuple(column) for column in vars(start).values()), strict=True))
    young, poisson = elastic_constants(curves)
    guess = {"young_modulus_GPa": 1e-3 * young, "poisson_ratio": poisson}
    rock = base.model_copy(update={**table, **guess})
    strongest = max(test.strength_MPa for test in curves)
    return fit_rock(unknowns(rock, start, strongest, True), curves, [])


@no_core
def test_strengths_of_a_straight_line_give_its_cohesion_and_friction(sandstone):
    rock = one_row_of(sandstone)
    tests = strengths(rock, (0.0, 5.0, 20.0, 40.0))
    fit = fit_rock(unknowns(rock, one_row(tests), 200.0), tests, [])
    np.testing.assert_allclose(fit.parameters["value"], [10.0, 30.0], rtol=1e-5)
    assert fit.error_percent("fitted")[1] < 1e-4


@no_core
def test_intervals_hold_the_truth_as_often_as_they_say(sandstone):
    """300 noisy sets; 95 % is met within three standard errors of a count."""
    rock, random = one_row_of(sandstone), np.random.default_rng(1)
    hits = np.zeros(2)
    for _ in range(300):
        tests = strengths(rock, (2.0, 10.0, 20.0, 40.0, 60.0), 2.0, random)
        found = fit_rock(unknowns(rock, one_row(tests), 400.0), tests, []).parameters
        hits += np.abs(found["value"] - [10.0, 30.0]) <= found["plus_minus"]
    np.testing.assert_allclose(hits / 300, 0.95, atol=3 * np.sqrt(0.95 * 0.05 / 300))


@no_core
def test_two_strengths_have_no_interval_and_a_value_on_its_bound_says_so(sandstone):
    rock = one_row_of(sandstone, cohesion=0.0)
    tests = strengths(rock, (5.0, 20.0))
    fit = fit_rock(unknowns(rock, one_row(tests), 60.0), tests, [])
    assert fit.parameters["value"].iloc[0] == pytest.approx(0.0, abs=1e-3)
    below = [test for test in strengths(rock, (5.0, 20.0, 30.0))]
    below[0] = Triaxial("low", 5.0, 12.0, np.zeros(0), np.zeros(0))
    held = fit_rock(unknowns(rock, one_row(below), 90.0), below, []).parameters
    assert held["note"].iloc[0] == "at its lower bound"
    assert np.isnan(held["plus_minus"].iloc[0])
    exact = strengths(one_row_of(sandstone), (5.0, 20.0))
    two = fit_rock(unknowns(one_row_of(sandstone), one_row(exact), 90.0), exact, [])
    assert two.parameters["plus_minus"].isna().all()


@no_core
@pytest.mark.validation
def test_zigong_predicts_every_other_strength_within_five_percent(data_folder):
    """Issue: fitted on 10, 30, 50, 70 MPa; rms error at 20, 40, 60, 80 MPa below 5 %."""
    rock = data_folder.parent / "configs" / "materials" / "sandstone.yaml"
    table = zigong_prediction([rock], data_folder)
    assert list(table.loc[table["role"] == "predicted", "confinement_MPa"]) == [20, 40, 60, 80]
    errors = zigong_prediction_error([rock], data_folder).set_index("role")
    assert errors.loc["predicted", "rms_percent"] < 5.0
    assert errors.loc["predicted", "rms_percent"] == pytest.approx(3.49, abs=0.01)
    assert errors.loc["predicted", "largest_percent"] == pytest.approx(5.34, abs=0.01)
    assert errors.loc["predicted", "largest_at_confinement_MPa"] == 80.0


def test_the_bench_has_the_strengths_that_the_fit_says(sandstone, data_folder):
    """One row has no hardening: the bench yields at the fitted line, not near it."""
    tests = load_triaxial([data_folder / "zigong" / "triaxial_strength.csv"])
    rock = one_row_of(sandstone)
    fit = fit_rock(unknowns(rock, one_row(tests), 443.5), tests, [])
    for row in fit.strengths.itertuples():
        curve = point.drive(fit.rock, "triaxial", row.confinement_MPa, 0.03, 60)
        assert curve["axial_stress_MPa"].max() == pytest.approx(row.computed_MPa, rel=1e-6)


@pytest.mark.parametrize("rock", ROCKS)
@pytest.mark.parametrize("confinement", [0.0, 40.0, 200.0])
def test_elastic_constants_leave_out_what_has_yielded(rock, confinement):
    """At 200 MPa the quartzite yields at 0.15 of its strength, below `ELASTIC_PART`."""
    rock = Material.load(rock)
    young, poisson = elastic_constants(curves_of(rock, [confinement]))
    assert 1e-3 * young == pytest.approx(rock.young_modulus_GPa, rel=1e-3)
    assert poisson == pytest.approx(rock.poisson_ratio, abs=1e-3)


@no_core
def test_compared_points_follow_the_curve_and_not_its_strain():
    """Steep on a tenth of the strain: about half of the points stand there."""
    strain = np.linspace(0.0, 0.02, 2001)
    stress = np.minimum(strain / 0.002, 1.0) * 100.0
    rows = sampled(Triaxial("", 0.0, 100.0, strain, stress))
    assert len(rows) == POINTS
    assert rows[0] == 1 and rows[-1] == 2000
    assert np.count_nonzero(strain[rows] < 0.002) == pytest.approx(0.53 * POINTS, abs=1)


@pytest.mark.one_build  # a while on the bench, which its own tests drive on every build
@pytest.mark.parametrize(
    "name",
    [pytest.param(rock, marks=pytest.mark.slow) for rock in ROCKS[:2]] + [ROCKS[2]],
)
def test_table_1_comes_back_at_its_own_rows(name):
    rock = Material.load(name)
    curves = curves_of(rock)
    rows = np.array([strain for strain in rock.plastic_strain if strain <= last_row(rock)])
    start = table_at(rows, curves, *elastic_constants(curves), NO_DILATION)
    fit = fitted_to(curves, rock, start)
    assert fit.converged
    assert fit.rock.young_modulus_GPa == pytest.approx(rock.young_modulus_GPa, rel=1e-3)
    assert fit.rock.poisson_ratio == pytest.approx(rock.poisson_ratio, abs=1e-3)
    within = {"cohesion_MPa": 0.1, "friction_angle_deg": 0.1, "dilation_angle_deg": 1.0}
    for key, close in within.items():
        known = getattr(rock, key)[: len(rows)]
        np.testing.assert_allclose(getattr(fit.rock, key), known, atol=close, err_msg=key)
    assert fit.error_percent("fitted")[1] < 0.1


@pytest.mark.slow
@pytest.mark.parametrize(("name", "rows"), [(ROCKS[0], 6), (ROCKS[1], 6), (ROCKS[2], 5)])
def test_rows_that_the_fit_chooses_follow_table_1_between_them(name, rows):
    """Within the sampling: at most six rows for the eight of the table."""
    rock = Material.load(name)
    curves = curves_of(rock)
    start = first_table(curves, *elastic_constants(curves), NO_DILATION, 6)
    assert len(start.plastic_strain) == rows
    fit = fitted_to(curves, rock, start)
    strain = np.linspace(0.0, last_row(rock), 101)
    found, known = fit.rock.table, rock.table
    cohesion = np.interp(strain, found[0], found[1]) - np.interp(strain, known[0], known[1])
    friction = np.interp(strain, found[0], found[2]) - np.interp(strain, known[0], known[2])
    assert np.sqrt(np.mean(cohesion**2)) < 0.5e6
    assert np.degrees(np.sqrt(np.mean(friction**2))) < 1.5
    assert fit.error_percent("fitted")[1] < 1.0
    stress = fit.points[fit.points["quantity"] == "axial_stress_MPa"]
    assert np.sqrt(np.mean((stress["computed"] - stress["measured"]) ** 2)) < 2.0  # MPa


def test_a_row_beyond_the_curves_is_refused(curves):
    with pytest.raises(ValueError, match=r"0\.03 lies beyond the plastic strain"):
        table_at(np.array([0.0, 0.03]), curves, *elastic_constants(curves), NO_DILATION)


TWO_ROWS = {
    "plastic_strain": (0.0, 0.004),
    "cohesion_MPa": (15.0, 25.0),
    "friction_angle_deg": (25.0, 35.0),
    "dilation_angle_deg": (5.0, 10.0),
}
NOISE = 0.005  # of the largest value of a curve


def noisy(curves, random):
    """The curves with noise; strengths are the known ones."""
    found = []
    for test in curves:
        stress, lateral = test.axial_stress_MPa, test.lateral_strain
        stress = stress + random.normal(0.0, NOISE * stress.max(), stress.size)
        lateral = lateral + random.normal(0.0, NOISE * lateral.max(), lateral.size)
        known = (test.name, test.confinement_MPa, test.strength_MPa, test.axial_strain)
        found.append(Triaxial(*known, stress, lateral))
    return found


def fitted_two_rows(tests, rock, young, poisson, errors):
    """Parameters of a table of two rows with these elastic constants [MPa], [-]."""
    base = rock.model_copy(update={"young_modulus_GPa": 1e-3 * young, "poisson_ratio": poisson})
    rows = np.array(TWO_ROWS["plastic_strain"])
    start = table_at(rows, tests, young, poisson, NO_DILATION)
    return fit_rock(unknowns(base, start, 200.0, True), tests, [], errors).parameters


@pytest.fixture(scope="module")
def two_rows():
    """Rock of two rows, and its curves in 400 steps."""
    rock = Material.load("sandstone").model_copy(update=TWO_ROWS)
    found = []
    for p in (0.0, 20.0):
        curve = point.drive(rock, confinement_MPa=p, end_strain=0.012, steps=400)
        curve = curve[curve["plastic_strain"] <= 0.004 + 1e-9].drop_duplicates("axial_strain")
        columns = (curve[key].to_numpy() for key in ("axial_strain", "axial_stress_MPa"))
        top, lateral = peak_strength(rock.table, 1e6 * p)[0] / 1e6, curve["lateral_strain"]
        found.append(Triaxial(f"{p:g} MPa", p, top, *columns, lateral.to_numpy()))
    return rock, found


@pytest.mark.one_build
def test_intervals_hold_what_an_error_of_the_elastic_constants_does(two_rows):
    """Refitted with a modulus that is one standard error off: that far the rows move."""
    rock, curves = two_rows
    tests = noisy(curves, np.random.default_rng(3))
    young, poisson = elastic_constants(tests)
    error = elastic_errors(tests)[0]
    assert 0.003 < error / young < 0.03
    about = (tests, rock)
    alone = fitted_two_rows(*about, young, poisson, None)
    held = fitted_two_rows(*about, young, poisson, {"young_modulus_GPa": 1e-3 * error})
    ends = [fitted_two_rows(*about, young + sign * error, poisson, None) for sign in (1, -1)]
    moved = 0.5 * np.abs(ends[0]["value"] - ends[1]["value"])
    added = np.sqrt(held["plus_minus"] ** 2 - alone["plus_minus"] ** 2) / 1.97  # Student's t
    np.testing.assert_allclose(added, moved, rtol=0.3, atol=0.03)
    np.testing.assert_array_equal(held["value"], alone["value"])


@pytest.mark.slow
@pytest.mark.one_build
def test_intervals_of_first_rows_hold_the_truth_of_noisy_curves(two_rows):
    """In 7 of 8 sets at least; without the error of the elastic constants not in half of them."""
    rock, curves = two_rows
    truth = np.concatenate([TWO_ROWS[key] for key in COLUMNS[1:]])
    hits = {"alone": np.zeros(6), "held": np.zeros(6)}
    for seed in range(8):
        tests = noisy(curves, np.random.default_rng(seed))
        young, poisson = elastic_constants(tests)
        errors = dict(
            zip(("young_modulus_GPa", "poisson_ratio"), elastic_errors(tests), strict=True)
        )
        errors["young_modulus_GPa"] *= 1e-3
        for name, known in (("alone", None), ("held", errors)):
            found = fitted_two_rows(tests, rock, young, poisson, known)
            hits[name] += np.abs(found["value"] - truth) <= found["plus_minus"]
    assert hits["held"][::2].min() >= 7  # first row of each column
    assert hits["alone"][::2].min() < 4
