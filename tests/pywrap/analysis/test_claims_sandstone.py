"""Claims on sandstone, each measure worked out by hand (analysis/claims_sandstone.py)."""

import numpy as np
import pandas as pd
import pytest
import yaml
from curves import give_curve
from punch_runs import block, write_field

from lithofrac.analysis.claim_parts import CannotCheckError, Source
from lithofrac.analysis.claims_sandstone import SANDSTONE
from lithofrac.analysis.runs import Run
from lithofrac.results.fields import write_series

pytestmark = pytest.mark.no_core
TRIAXIAL, SOFT, STIFF = "sandstone_triaxial", "sandstone_soft", "sandstone_plane_strain"
ELEMENT = 0.5  # mm: size in the case; the mesh of the fields has squares of 1 mm


def values(claim, *runs, data=None):
    return SANDSTONE[claim].measures(Source({run.name: run for run in runs}, {}, data))


def measured(claim, *runs, data=None):
    """Measures of a claim as numbers."""
    return {name: value.value for name, value in values(claim, *runs, data=data).items()}


@pytest.fixture
def bent(make_run):
    """bent(name, confinement, rise=100, second=10, at_peak=1, low=50, end=50) -> run.

    From the confinement on, slopes of 10 GPa over the first tenth of the rise and of `second` GPa
    over the next; then straight to the peak at a strain of `at_peak` %, by 0.5 % of strain to
    `low` MPa and at 4 % to `end` MPa.
    """

    def made(name, confinement=0.0, rise=100.0, second=10.0, at_peak=1.0, low=50.0, end=50.0):
        test = "triaxial" if name.startswith(TRIAXIAL) else "plane_strain"
        tenth, last = 0.1 * rise, 0.01 * at_peak
        one = 1e-4 * tenth
        two = one + 1e-3 * tenth / second
        top = confinement + rise
        return Run(
            give_curve(
                make_run(name, test, confinement),
                (0.0, confinement), (one, confinement + tenth), (two, confinement + 2 * tenth),
                (last, top), (last + 0.005, low), (0.04, end),
            )
        )  # fmt: skip

    return made


@pytest.mark.parametrize(("soft", "largest"), [(7.5, 25.0), (9.5, 20.0)])
def test_bend_at_the_start_is_the_largest_change_of_slope_of_all_series(bent, soft, largest):
    """Slopes of 12, `soft` and 11 after 10 GPa; a run without a peak has no share of its rise."""
    runs = [bent(f"{TRIAXIAL}_p10", 10.0, second=12.0), bent(f"{SOFT}_p10", 10.0, second=soft),
            bent(f"{STIFF}_p10", 10.0, second=11.0),
            bent(f"{STIFF}_p20", 20.0, second=20.0, low=120.0, end=120.0)]  # fmt: skip
    assert runs[-1].peak is None
    assert measured("initial_linear", *runs) == {"bend": pytest.approx(largest)}


def test_triaxial_curve_has_its_least_bend_and_its_largest_residual(bent):
    """100 MPa at 10 GPa are 1 %, of peaks at 2 and at 1.25 %; 25 of 100 and 66 of 110 MPa stay."""
    runs = [bent(f"{TRIAXIAL}_p00", 0.0, at_peak=2.0, low=25.0, end=25.0),
            bent(f"{TRIAXIAL}_p10", 10.0, at_peak=1.25, low=60.0, end=66.0)]  # fmt: skip
    assert measured("triaxial_curve", *runs) == {
        "bend": pytest.approx(20.0), "residual": pytest.approx(60.0)
    }  # fmt: skip
    assert values("triaxial_curve", *runs)["residual"].note == f"{TRIAXIAL}_p10; 25 % at 0 MPa"


def test_bend_is_judged_by_the_slope_of_the_second_tenth(bent):
    """100 MPa at 12.5 GPa are 0.8 % of a peak at 1.6 %."""
    run = bent(f"{TRIAXIAL}_p00", second=12.5, at_peak=1.6)
    assert measured("triaxial_curve", run)["bend"] == pytest.approx(50.0)


def test_plane_strain_curve_has_its_largest_bend_and_its_least_hardening(bent):
    """Rises of 20 over 100 MPa, and of 11 over 110 MPa."""
    runs = [bent(f"{STIFF}_p00", 0.0, at_peak=1.25, low=50.0, end=70.0),
            bent(f"{STIFF}_p10", 10.0, at_peak=1.0, low=55.0, end=66.0)]  # fmt: skip
    assert measured("plane_strain_curve", *runs) == {
        "bend": pytest.approx(20.0), "hardening": pytest.approx(10.0)
    }  # fmt: skip


def test_curve_that_falls_to_its_end_does_not_harden(bent):
    run = bent(f"{STIFF}_p00", low=50.0, end=40.0)
    assert measured("plane_strain_curve", run)["hardening"] == 0.0


def test_bends_are_compared_at_one_confinement_and_the_largest_difference_counts(bent):
    """20 less 50 % at 0 MPa, 37.5 less 60 % at 10 MPa; 20 MPa has no triaxial run."""
    runs = [bent(f"{TRIAXIAL}_p00", 0.0, at_peak=2.0), bent(f"{STIFF}_p00", 0.0, at_peak=1.25),
            bent(f"{TRIAXIAL}_p10", 10.0, at_peak=2.5), bent(f"{STIFF}_p10", 10.0, at_peak=1.6),
            bent(f"{STIFF}_p20", 20.0, at_peak=3.0)]  # fmt: skip
    assert measured("plane_strain_bend", *runs) == {"difference": pytest.approx(-22.5)}


def test_strength_rises_by_the_least_step_of_all_series(bent):
    """Peaks 100, 140, 200 over 10 MPa each; 100, 150 over 10 MPa; 100, 190 over 30 MPa."""
    runs = [bent(f"{TRIAXIAL}_p{p:02d}", p, rise) for p, rise in ((0, 100), (10, 130), (20, 180))]
    runs += [bent(f"{SOFT}_p{p:02d}", p, rise) for p, rise in ((0, 100), (10, 140))]
    runs += [bent(f"{STIFF}_p{p:02d}", p, rise) for p, rise in ((0, 100), (30, 160))]
    assert measured("strength_rises", *runs) == {"rise": pytest.approx(3.0)}
    assert values("strength_rises", *runs)["rise"].note == f"{STIFF}_p00 to {STIFF}_p30"
    with pytest.raises(CannotCheckError, match=f"1 of 2 runs {STIFF}_p"):
        values("strength_rises", *runs[:-1])


def test_excess_of_plane_strain_is_over_the_triaxial_strength(bent):
    """125 over 100 and 144 over 120 MPa."""
    runs = [bent(f"{TRIAXIAL}_p00", 0.0, 100.0), bent(f"{STIFF}_p00", 0.0, 125.0),
            bent(f"{TRIAXIAL}_p20", 20.0, 100.0), bent(f"{STIFF}_p20", 20.0, 124.0)]  # fmt: skip
    assert measured("plane_strain_above", *runs) == {"excess": pytest.approx(20.0)}


def test_stiffness_is_judged_by_its_least_step_in_strength_and_at_the_end(bent):
    """Peaks 100, 110, 132, 198; ends 50, 60, 90, 99: least steps of 10 % each, not the same."""
    names = [f"{name}_p00" for name in (SOFT, *(f"{STIFF}_k{k}" for k in ("01", "02", "05")))]
    peaks, ends = (100.0, 110.0, 132.0, 198.0), (50.0, 60.0, 90.0, 99.0)
    runs = [
        bent(name, rise=peak, low=end, end=end)
        for name, peak, end in zip(names, peaks, ends, strict=True)
    ]
    assert measured("stiffness_raises", *runs) == {
        "strength": pytest.approx(10.0), "end": pytest.approx(10.0)
    }  # fmt: skip
    found = values("stiffness_raises", *runs)
    assert (found["strength"].note, found["end"].note) == (names[1], names[3])


def test_series_without_a_confinement_in_common_are_not_compared(bent):
    runs = [bent(f"{TRIAXIAL}_p00", 0.0), bent(f"{STIFF}_p10", 10.0)]
    with pytest.raises(CannotCheckError, match="no confinement at which both"):
        values("plane_strain_above", *runs)


def test_run_without_a_peak_is_named(bent):
    run = bent(f"{TRIAXIAL}_p00", low=100.0, end=100.0)
    with pytest.raises(CannotCheckError, match=f"{TRIAXIAL}_p00 has no peak"):
        values("triaxial_curve", run)


def test_strengths_are_held_against_the_digitised_ones_of_their_series(bent, digitise):
    """100 at 0 and 140 at 10 MPa; read 110 at 5 MPa and 160 at 10 MPa: 10 and 20 off."""
    runs = [bent(f"{TRIAXIAL}_p00", 0.0, 100.0), bent(f"{TRIAXIAL}_p10", 10.0, 130.0),
            bent(f"{TRIAXIAL}_p10_fine", 10.0, 300.0)]  # fmt: skip
    data = digitise(
        [(5.0, 110.0), (10.0, 160.0)], figure="10", compare_with=TRIAXIAL,
        x={"unit": "MPa", "printed_min": 0, "printed_max": 40},
        y={"unit": "MPa", "printed_min": 0, "printed_max": 300},
    )  # fmt: skip
    far = 100.0 * np.sqrt(0.5 * (10.0**2 + 20.0**2)) / 160.0
    assert measured("sandstone_agreement", *runs, data=data) == {"rms": pytest.approx(far)}


@pytest.fixture
def with_fields(make_run):
    """with_fields(name, strained, cracks=None) -> run whose last frame and cracks are these.

    strained : centroids x, y [mm] in the block of 8 x 8 mm -> elements with a plastic strain of 0.1
    cracks : rows (angle to the load axis [degrees], length [mm])
    """

    def made(name, strained, cracks=None):
        folder = make_run(name, "plane_strain")
        mesh = block()
        (folder / "fields").mkdir()
        plastic = 0.1 * strained(*(1e3 * mesh.centroids().T))
        write_field(folder / "fields" / "frame_0000.vtu", mesh, plastic)
        write_series(folder / "fields.pvd", [(0.002, "fields/frame_0000.vtu")])
        case = yaml.safe_load((folder / "case.yaml").read_text())
        case["scene"]["element_size_mm"] = ELEMENT
        (folder / "case.yaml").write_text(yaml.safe_dump(case))
        if cracks is not None:
            angle, length = np.array(cracks, dtype=float).reshape(-1, 2).T
            pd.DataFrame(
                {
                    "time_s": 0.001, "x1_mm": 4.0, "y1_mm": 4.0,
                    "x2_mm": 4.0 + length * np.sin(np.radians(angle)),
                    "y2_mm": 4.0 + length * np.cos(np.radians(angle)), "length_mm": length,
                }
            ).to_parquet(folder / "cracks.parquet")  # fmt: skip
        return Run(folder)

    return made


def columns(n):
    """So many columns of squares, 8 mm high: 16 n / (2 n + 16) mm wide (`band_width`)."""
    return lambda x, y: (x > 2.0) & (x < 2.0 + n)


def diagonal(x, y):
    """Squares on the diagonal: a band at 45 degrees."""
    return np.floor(x) == np.floor(y)


def crossed(x, y):
    """Both diagonals: two bands, no single axis."""
    return diagonal(x, y) | diagonal(8.0 - x, y)


def nowhere(x, y):
    return np.zeros(len(x))


def test_width_is_that_of_the_widest_band_over_the_size_of_an_element(with_fields):
    """One column and two: 16 / 18 and 32 / 20 mm."""
    runs = [with_fields(f"{STIFF}_p00", columns(1)), with_fields(f"{STIFF}_p10", columns(2)),
            with_fields(f"{STIFF}_p20", nowhere),
            with_fields(f"{SOFT}_p00", columns(4))]  # fmt: skip
    assert measured("localisation_width", *runs[:1])["width"] == pytest.approx(16 / 18 / ELEMENT)
    assert measured("localisation_width", *runs) == {"width": pytest.approx(1.6 / ELEMENT)}
    with pytest.raises(CannotCheckError, match=f"no plastic strain in {STIFF}_p"):
        values("localisation_width", runs[2])


@pytest.mark.parametrize(("soft", "stiff"), [(2, 1), (1, 2)])
def test_widths_are_alike_by_the_factor_between_them_whichever_is_larger(with_fields, soft, stiff):
    """1.6 mm over 16 / 18 mm."""
    runs = [with_fields(f"{SOFT}_p00", columns(soft)), with_fields(f"{STIFF}_p00", columns(stiff))]
    assert measured("localisation_alike", *runs) == {"ratio": pytest.approx(1.8)}


def test_widths_of_a_series_are_averaged_before_they_are_compared(with_fields):
    """1.6 mm over the mean of 1.6 and 16 / 18 mm."""
    runs = [with_fields(f"{SOFT}_p00", columns(2)), with_fields(f"{STIFF}_p00", columns(2)),
            with_fields(f"{STIFF}_p10", columns(1))]  # fmt: skip
    assert measured("localisation_alike", *runs)["ratio"] == pytest.approx(1.6 / (0.8 + 8 / 18))
    note = values("localisation_alike", *runs)["ratio"].note
    assert note == (
        "3.2 elements under soft pressure, 2.5 between platens, furthest apart at 0 MPa:"
        " 3.2 against 3.2"
    )


def test_segments_are_oblique_by_their_median_in_the_runs_with_one_band(with_fields):
    """Medians of 10 and 15 degrees in bands at 45; 3 of 4, 2 of 4 and 1 of 4 mm near the axis."""
    runs = [with_fields(f"{STIFF}_p00", diagonal, [(0, 1), (10, 2), (40, 1)]),
            with_fields(f"{STIFF}_p10", diagonal, [(5, 1), (15, 1), (60, 2)]),
            with_fields(f"{STIFF}_p20", crossed, [(19, 1), (70, 1), (75, 2)])]  # fmt: skip
    assert measured("sandstone_echelon", *runs[:1]) == {
        "near_axis": pytest.approx(75.0), "oblique": pytest.approx(35.0)
    }  # fmt: skip
    assert measured("sandstone_echelon", *runs) == {
        "near_axis": pytest.approx(25.0), "oblique": pytest.approx(30.0)
    }  # fmt: skip
    alone = values("sandstone_echelon", runs[2])["oblique"]
    assert np.isnan(alone.value) and alone.note == "no run has a single band"


def test_segment_within_a_degree_of_the_load_axis_counts_as_vertical(with_fields):
    """1 of 5 mm, and 3 of 5 mm at 0.9 degrees; the rest at 1.1 and 30."""
    runs = [with_fields(f"{STIFF}_p00", diagonal, [(0.9, 1), (1.1, 2), (30, 2)]),
            with_fields(f"{STIFF}_p10", diagonal, [(-0.9, 3), (-1.1, 1), (30, 1)])]  # fmt: skip
    assert measured("echelon_vertical", *runs[:1]) == {"vertical": pytest.approx(20.0)}
    assert measured("echelon_vertical", *runs) == {"vertical": pytest.approx(60.0)}


@pytest.mark.parametrize("claim", ["sandstone_echelon", "echelon_vertical"])
def test_runs_without_cracks_have_no_segments(with_fields, claim):
    runs = [with_fields(f"{STIFF}_p00", diagonal), with_fields(f"{STIFF}_p10", diagonal, [])]
    with pytest.raises(CannotCheckError, match=f"no cracks in {STIFF}_p"):
        values(claim, *runs)


def test_pattern_is_not_judged_without_the_photograph():
    with pytest.raises(CannotCheckError, match="not at hand"):
        values("sandstone_pattern")
