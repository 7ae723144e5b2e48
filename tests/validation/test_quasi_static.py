"""Is a specimen loaded slowly enough? Half the speed, and the forces on both of its ends."""

from pathlib import Path

import pandas as pd
import pytest

from lithofrac.analysis.strength import first_peak
from lithofrac.config import find_case
from lithofrac.run import simulate
from lithofrac.scenes import make_mesh, make_problem

pytestmark = pytest.mark.validation
QUICK = Path(__file__).parents[2] / "configs" / "suite_quick.yaml"
CASES = ("sandstone_triaxial_p10", "sandstone_plane_strain_k02_p10")


def loaded(name, out, slower=1.0):
    """History of a quick case at its speed over `slower`, and its summary."""
    case = find_case(name, QUICK, {"output.fields": 0})
    keys = {"loading.speed_m_s": case.loading.speed / slower, "output.fields": 0}
    case = find_case(name, QUICK, keys)
    summary = simulate(make_problem(case, make_mesh(case)), out)
    return pd.read_parquet(out / "history.parquet"), summary


@pytest.mark.parametrize("name", CASES)
def test_half_the_speed_changes_the_strength_by_less_than_one_percent(name, tmp_path):
    peaks = []
    for slower in (1.0, 2.0):
        history, summary = loaded(name, tmp_path / str(slower), slower)
        peaks.append(first_peak(history["axial_strain"], history["axial_stress_MPa"]))
        assert summary["kinetic_ratio_at_peak"] < 0.01
    print(f"\n{name}: {peaks[0].stress:.2f} MPa, {peaks[1].stress:.2f} MPa at half the speed")
    assert peaks[1].stress == pytest.approx(peaks[0].stress, rel=0.01)


@pytest.mark.parametrize("name", CASES)
def test_the_forces_on_both_ends_balance_to_one_percent_until_the_peak(name, tmp_path):
    history, _ = loaded(name, tmp_path)
    peak = first_peak(history["axial_strain"], history["axial_stress_MPa"])
    stress = history["axial_stress_MPa"]
    rows = history[(stress > 0.2 * peak.stress) & (history.index <= peak.index)]
    assert len(rows) > 20
    lost = (rows["top_force_N"] + rows["bottom_force_N"]).abs() / rows["top_force_N"].abs()
    print(f"\n{name}: {lost.max():.4f} of the force at most")
    assert lost.max() < 0.01
