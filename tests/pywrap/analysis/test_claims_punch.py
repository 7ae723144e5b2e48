"""Claims on the strip punch, each measure worked out by hand (analysis/claims_punch.py)."""

import pytest
from curves import give_curve

from lithofrac.analysis.claim_parts import CannotCheckError, Source
from lithofrac.analysis.claims_punch import PUNCH
from lithofrac.analysis.runs import Run

pytestmark = pytest.mark.no_core
END = (0.06, 0.0)  # last knot of a curve: strain, stress [MPa]


@pytest.fixture
def with_curve(make_punch_run):
    """with_curve(name, *knots) -> run of the punch with that curve (`give_curve`)."""
    return lambda name, *knots: Run(give_curve(make_punch_run(name), *knots))


def values(claim, *runs):
    return PUNCH[claim].measures(Source({run.name: run for run in runs}, {}, None))


def measured(claim, *runs):
    """Measures of a claim as numbers."""
    return {name: value.value for name, value in values(claim, *runs).items()}


def falling(to_half, peak=100.0):
    """Rise to a peak at a strain of 0.01, fall to just below half of it over `to_half`, then on."""
    half = 0.01 + to_half
    return (0.0, 0.0), (0.01, peak), (half - 1e-9, 0.6 * peak), (half, 0.49 * peak), END


def test_excess_is_the_stress_without_compressive_failure_over_that_with_it(with_curve):
    runs = [with_curve("punch_tension_only", *falling(0.01, 180.0)),
            with_curve("punch_discrete", *falling(0.01, 120.0))]  # fmt: skip
    assert measured("punch_tension_excess", *runs) == {"ratio": pytest.approx(1.5)}


def test_spread_is_the_largest_change_of_the_peak_up_or_down(with_curve):
    """From 100 MPa by +10 %, -20 % and +5 %."""
    peaks = {"": 100.0, "_coarse": 110.0, "_gf300": 80.0, "_intra": 105.0}
    runs = [with_curve(f"punch_tension_only{end}", *falling(0.01, p)) for end, p in peaks.items()]
    assert measured("punch_tension_only", *runs) == {
        "peak": pytest.approx(100.0), "spread": pytest.approx(20.0)
    }  # fmt: skip
    words = values("punch_tension_only", *runs)["spread"].note
    assert words == "coarse 110 MPa, gf300 80 MPa, intra 105 MPa"


def energies(with_curve, low, middle, high):
    """Runs of the three fracture energies by their strain from peak to half of it."""
    falls = {"punch_gf60": low, "punch_gf300": middle, "punch_gf1200": high}
    return [with_curve(name, *falling(fall)) for name, fall in falls.items()]


def test_brittleness_of_the_lowest_energy_is_over_the_least_of_the_higher(with_curve):
    """Strains of 0.002 over the lesser of 0.008 and 0.005."""
    runs = energies(with_curve, 0.002, 0.008, 0.005)
    assert measured("punch_low_gf", *runs)["brittleness"] == pytest.approx(0.4)
    assert measured("punch_high_gf", *runs)["gradual"] == pytest.approx(2.5)


def test_lowest_energy_that_falls_the_slowest_is_not_the_most_brittle(with_curve):
    runs = energies(with_curve, 0.016, 0.008, 0.005)
    assert measured("punch_low_gf", *runs)["brittleness"] == pytest.approx(3.2)
    assert measured("punch_high_gf", *runs)["gradual"] == pytest.approx(0.3125)


def test_regain_of_the_lowest_energy_is_over_its_peak(with_curve):
    runs = energies(with_curve, 0.002, 0.008, 0.005)
    assert measured("punch_low_gf", *runs)["regain"] == 0.0
    assert values("punch_low_gf", *runs)["regain"].note == "no regain"
    give_curve(runs[0].folder, (0, 0), (0.01, 100), (0.02, 60), (0.03, 72), (0.04, 20), (0.06, 20))
    again = [Run(run.folder) for run in runs]
    assert measured("punch_low_gf", *again)["regain"] == pytest.approx(12.0)
    assert values("punch_low_gf", *again)["regain"].note == ""


def upright(aside, depth, long):
    """Crack along the load; its middle lies `aside` strip widths off the axis, `depth` mm down."""
    x, y = 4.0 + 2.0 * aside, 8.0 - depth
    return x, y - 0.5 * long, x, y + 0.5 * long


def level(aside, depth, long):
    """The same across the load."""
    x, y = 4.0 + 2.0 * aside, 8.0 - depth
    return x - 0.5 * long, y, x + 0.5 * long, y


def test_cracks_of_the_cone_stand_beside_the_axis_no_further_than_the_strip_is_wide(
    make_punch_run,
):
    """Upright 0.6 and 0.3 mm of 1.2 mm; what is upright on the axis, far out or deep is no part."""
    inside = [upright(0.3, 1.0, 0.6), upright(-0.95, 2.0, 0.3), level(0.6, 1.0, 0.3)]
    outside = [upright(0.2, 1.0, 2.0), upright(-1.1, 1.0, 2.0), upright(0.6, 6.0, 2.0)]
    run = Run(make_punch_run("punch_discrete", cracks=[*inside, *outside]))
    (value,) = values("punch_echelon", run).values()
    assert value.value == pytest.approx(75.0)
    assert value.note.startswith("3 crack edges")


def test_crack_near_the_edge_counts_as_its_own_only_off_the_axis(make_punch_run):
    """Strip of 2 mm: 0.4 mm off the axis is 0.6 mm from an edge, but part of the axial crack."""
    cracks = [upright(0.2, 0.1, 0.1), upright(0.3, 0.1, 0.1), upright(0.0, 4.0, 0.2)]
    run = Run(make_punch_run("punch_tension_only", cracks=cracks))
    assert measured("punch_tension_pattern", run) == {"edge_share": pytest.approx(25.0)}


def test_cone_without_cracks_is_not_judged(make_punch_run):
    run = Run(make_punch_run("punch_discrete", cracks=[upright(0.0, 1.0, 1.0)]))
    with pytest.raises(CannotCheckError, match="punch_discrete has no cracks in the cone"):
        values("punch_echelon", run)


def test_run_without_a_peak_is_not_judged(with_curve):
    run = with_curve("punch_discrete", (0.0, 0.0), (0.01, 100.0))
    with pytest.raises(CannotCheckError, match="punch_discrete has no peak"):
        values("punch_drop", run)


def test_fall_and_regain_are_over_the_first_peak(with_curve):
    """A 100, B 60, C 90, then below half."""
    knots = (0.0, 0.0), (0.01, 100.0), (0.02, 60.0), (0.03, 90.0), (0.04, 20.0), (0.05, 20.0)
    run = with_curve("punch_discrete", *knots)
    assert measured("punch_drop", run) == {"fall": pytest.approx(40.0)}
    assert measured("punch_hardening", run) == {"regain": pytest.approx(30.0)}


def test_plateau_and_sudden_fall_are_those_of_the_largest_stress(with_curve):
    """Rows every 0.0002, so above 95 MPa from 0.0096 to 0.02; half after 0.002 and after 0.008."""

    def flat(fall):
        half = 0.02 + fall
        return (0, 0), (0.01, 100), (0.02, 100), (0.0202, 94), (half - 2e-4, 51), (half, 49), END

    runs = [with_curve("punch_discrete", *flat(0.002)), with_curve("punch_gf60", *flat(0.008))]
    assert measured("punch_discrete", *runs) == {
        "plateau": pytest.approx(104.0), "sudden": pytest.approx(0.25)
    }  # fmt: skip
