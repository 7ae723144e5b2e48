"""What the options of the law change (analysis/options.py)."""

import pytest

from lithofrac.analysis.options import END_STRAIN, LEGS_MM, options

ENERGIES = [f"crack_energy_at_{leg:g}_mm_J_m2" for leg in LEGS_MM]


@pytest.fixture(scope="module")
def table():
    """Of both rocks, by rock and option."""
    return options([], None).set_index(["rock", "option"])


@pytest.mark.parametrize(("rock", "energy"), [("quartzite", 60.0), ("sandstone", 100.0)])
@pytest.mark.parametrize("option", ["default", "coupling: explicit"])
def test_crack_energy_is_that_of_the_material_on_every_mesh(table, rock, energy, option):
    assert list(table.loc[(rock, option), ENERGIES]) == pytest.approx(4 * [energy], rel=1e-6)


def test_total_hardening_makes_the_crack_energy_of_sandstone_depend_on_the_mesh(table):
    """Amounts of the study that settled the default; its steps were coarser."""
    found = list(table.loc[("sandstone", "hardening: total"), ENERGIES])
    assert found == pytest.approx([9.8, 19.9, 38.0, 69.0], rel=0.04)


@pytest.mark.parametrize("rock", ["quartzite", "sandstone"])
def test_narrower_band_width_overspends_by_the_ratio_of_the_widths(table, rock):
    ratio = (
        table.loc[(rock, "band_width: sqrt_A"), ENERGIES] / table.loc[(rock, "default"), ENERGIES]
    )
    assert list(ratio) == pytest.approx(4 * [2.0**0.5], rel=1e-6)


def test_no_option_moves_the_uniaxial_peak(table):
    peaks = table["uniaxial_peak_MPa"]
    assert list(peaks["quartzite"]) == pytest.approx(4 * [175.3], abs=0.05)
    assert list(peaks["sandstone"]) == pytest.approx(4 * [100.2], abs=0.05)


def test_default_differs_from_itself_by_nothing_and_total_hardening_from_it(table):
    change = table["largest_change_of_stress_MPa"]
    assert change[("quartzite", "default")] == 0.0
    assert change[("quartzite", "hardening: total")] > 1.0


def test_lateral_strength_lasts_longer_in_a_narrower_band(table):
    strain = table["strain_of_lateral_exhaustion_percent"]["quartzite"]
    assert strain["default"] < strain["band_width: sqrt_A"] < 100.0 * END_STRAIN
