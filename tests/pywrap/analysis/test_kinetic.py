"""Kinetic over internal energy before failure (analysis/kinetic.py)."""

import numpy as np
import pandas as pd
import pytest
from curves import give_curve

from lithofrac.analysis import tables
from lithofrac.analysis.kinetic import ratio_before_peak
from lithofrac.analysis.runs import Run
from lithofrac.analysis.verdict import FAILS, HOLDS

pytestmark = pytest.mark.no_core


@pytest.fixture
def with_ratio(make_run):
    """with_ratio(name, ratio_at) -> run that rises to 100 MPa at 0.01 and falls after it.

    `ratio_at(load)` is its kinetic over internal energy by the load over the peak; after the peak
    the load counts on, beyond 1.
    """

    def made(name, ratio_at):
        folder = give_curve(make_run(name), (0.0, 0.0), (0.01, 100.0), (0.02, 40.0), (0.03, 40.0))
        strain = pd.read_parquet(folder / "history.parquet")["axial_strain"].to_numpy()
        load = strain / 0.01
        give_energy(folder, 0.1 * strain, load**2, [ratio_at(one) for one in load])
        return Run(folder)

    return made


def give_energy(folder, time_s, internal, ratio):
    """Half of the internal energy elastic, the rest in both dissipations."""
    pd.DataFrame(
        {
            "time_s": time_s, "kinetic_J": internal * np.array(ratio),
            "elastic_J": 0.5 * internal, "compressive_dissipation_J": 0.3 * internal,
            "fracture_dissipation_J": 0.2 * internal,
            "external_J": internal, "damping_J": 0.0, "residual_J": 0.0,
        }
    ).to_parquet(folder / "energy.parquet")  # fmt: skip


def test_ratio_is_the_largest_from_a_tenth_of_the_peak_to_the_peak(with_ratio):
    """9 below the tenth and 7 behind the peak do not count."""

    def ratio_at(load):
        return (
            9.0 if load < 0.0999 else 7.0 if load > 1.0001 else 0.03 if 0.4 < load < 0.5 else 0.01
        )

    assert ratio_before_peak(with_ratio("a", ratio_at)) == pytest.approx(0.03)


@pytest.mark.parametrize("load", [0.11, 0.99])
def test_both_ends_of_the_window_are_in_it(with_ratio, load):
    run = with_ratio("a", lambda one: 0.2 if abs(one - load) < 0.011 else 0.01)
    assert ratio_before_peak(run) == pytest.approx(0.2)


def test_window_ends_at_the_first_peak_though_the_stress_rises_above_it_later(make_run):
    folder = give_curve(make_run("a"), (0.0, 0.0), (0.01, 100.0), (0.02, 50.0), (0.03, 200.0))
    strain = pd.read_parquet(folder / "history.parquet")["axial_strain"].to_numpy()
    ratio = np.where(strain > 0.0101, 0.5, 0.01)
    give_energy(folder, 0.1 * strain, 1.0 + strain, ratio)
    assert ratio_before_peak(Run(folder)) == pytest.approx(0.01)


def test_run_without_an_axial_stress_is_looked_at_from_a_hundredth_of_its_energy(make_run):
    folder = make_run("bar_wave")
    time_s = np.linspace(0.0, 1.0, 101)
    pd.DataFrame({"time_s": time_s, "top_force_N": 0.0}).to_parquet(folder / "history.parquet")
    ratio = np.where(time_s < 0.0999, 9.0, 0.02)
    give_energy(folder, time_s, time_s**2, ratio)
    assert ratio_before_peak(Run(folder)) == pytest.approx(0.02)


@pytest.mark.parametrize(("ratio", "word"), [(0.049, HOLDS), (0.051, FAILS)])
def test_every_run_of_the_table_is_judged_by_the_band_of_the_file(
    with_ratio, data_folder, ratio, word
):
    run = with_ratio("a", lambda load: ratio)
    table = tables.run_time([data_folder.parent / "reports" / "bands.csv", run.folder], data_folder)
    assert list(table["kinetic_verdict"]) == [word]
    assert table["kinetic_ratio_before_peak"].iloc[0] == pytest.approx(ratio)
