"""Specimens of sandstone by finite elements: do they have the strength of their material?

Table 1 of Klerck, Sellers & Owen 2004 gives the strength line in closed form; a specimen with
frictionless ends is homogeneous up to its peak and has to reach it at every confinement.
"""

from pathlib import Path

import pandas as pd
import pytest

from lithofrac import point
from lithofrac.analysis.mohr_coulomb import peak_strength
from lithofrac.analysis.strength import Peak, first_peak
from lithofrac.config import Case, find_case
from lithofrac.run import simulate
from lithofrac.scenes import make_mesh, make_problem

pytestmark = pytest.mark.validation

QUICK = Path(__file__).parents[2] / "configs" / "suite_quick.yaml"
CONFINEMENTS = (0, 5, 10, 20, 30)  # MPa
COARSE, FINE = 2.0, 0.5  # element size [mm]; the fine one is that of the suite
PAST_PEAK = 1.25  # end of a run over the strain at the peak of the material point


def sandstone(name: str, confinement: float, **changes) -> Case:
    """The quick case of this name at another confinement [MPa]."""
    keys = {"loading.confinement_MPa": confinement, "output.fields": 0, **changes}
    return find_case(name, QUICK, keys)


def bench_peak(case: Case, test: str, confinement: float) -> Peak:
    """First peak of one material point in the same test."""
    size = 1e-3 * case.scene.element_size_mm
    curve = point.drive(case.material, test, confinement, length_m=size)
    return first_peak(curve["axial_strain"], curve["axial_stress_MPa"])


def specimen_peak(case: Case, out: Path) -> tuple[Peak, dict]:
    """First peak of the specimen, and the summary of its run."""
    summary = simulate(make_problem(case, make_mesh(case)), out)
    history = pd.read_parquet(out / "history.parquet")
    peak = first_peak(history["axial_strain"], history["axial_stress_MPa"])
    assert peak is not None, "the run ends before the stress has fallen"
    return peak, summary


def check_triaxial(size_mm: float, confinement: float, out: Path) -> None:
    """Run until past the peak; compare with the closed form."""
    size = {"scene.element_size_mm": size_mm}
    case = sandstone("sandstone_triaxial_p00", confinement, **size)
    end = PAST_PEAK * bench_peak(case, "triaxial", confinement).strain
    case = sandstone("sandstone_triaxial_p00", confinement, **size, **{"loading.end_strain": end})
    peak, summary = specimen_peak(case, out)
    exact = peak_strength(case.material.table, 1e6 * confinement)[0] / 1e6
    ratio = summary["kinetic_ratio_at_peak"]
    print(f"\n{confinement} MPa: {peak.stress / exact - 1:+.4f} of the line, KE/IE {ratio:.1e}")
    assert peak.stress == pytest.approx(exact, rel=0.03)
    # the summary speaks of the highest stress: it is the peak that is compared
    assert summary["peak_stress_MPa"] == pytest.approx(peak.stress, rel=1e-12)
    assert ratio < 1e-3


@pytest.mark.parametrize("confinement", CONFINEMENTS)
def test_triaxial_peak_lies_on_the_line_of_the_table(confinement, tmp_path):
    check_triaxial(COARSE, confinement, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("confinement", CONFINEMENTS)
def test_triaxial_peak_on_the_mesh_of_the_suite(confinement, tmp_path):
    check_triaxial(FINE, confinement, tmp_path)


@pytest.mark.parametrize("confinement", [0, 20])
def test_stiff_plane_strain_peak_is_that_of_the_material_point(confinement, tmp_path):
    name = "sandstone_plane_strain_k02_p00"
    case = sandstone(name, confinement)
    assert case.loading.lateral_stiffness_over_young == 0.02
    bench = bench_peak(case, "stiff_confinement", confinement)
    end = {"loading.end_strain": 1.5 * bench.strain}
    peak, summary = specimen_peak(sandstone(name, confinement, **end), tmp_path)
    print(f"\n{confinement} MPa: {peak.stress / bench.stress - 1:+.4f} of the point")
    assert peak.stress == pytest.approx(bench.stress, rel=0.05)
    assert peak.strain == pytest.approx(bench.strain, rel=0.05)
    assert summary["kinetic_ratio_at_peak"] < 1e-3
