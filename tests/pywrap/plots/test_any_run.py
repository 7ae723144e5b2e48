"""Plots of any one run: curves, pattern, gauges (plots/curves.py, pattern.py, gauges.py)."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgba

from lithofrac.analysis.runs import Run
from lithofrac.data import DataError
from lithofrac.plots import curves, gauges, pattern, style
from lithofrac.plots.fractures import MODES

pytestmark = pytest.mark.no_core


def names(axes):
    """Names in the legend of a panel."""
    return [text.get_text().replace("\n", " ") for text in axes.get_legend().get_texts()]


def line_of(axes, colour):
    """The line drawn in a colour, (n, 2)."""
    return next(line for line in axes.lines if line.get_color() == colour).get_xydata()


def unmeasured(folder):
    """Make a run of it that has loads alone, as a bar has."""
    path = folder / "history.parquet"
    time_s = pd.read_parquet(path)["time_s"]
    loads = {"top_force_N": 2e3 * time_s / time_s.max(), "top_displacement_mm": 0.0}
    loads |= {"side_force_N": 1e-12, "side_displacement_mm": 0.0}
    pd.DataFrame({"time_s": time_s}).assign(**loads).to_parquet(path)
    return folder


@pytest.mark.parametrize("kind", [curves.figure, gauges.figure, pattern.figure])
def test_several_runs_are_refused(make_run, data_folder, kind):
    with pytest.raises(DataError, match=r"plot \w+: 2 runs, expected one"):
        kind([make_run("a"), make_run("b")], data_folder)


def test_curves_are_those_of_the_tables(make_run, data_folder):
    run = Run(make_run("sandstone_triaxial_p10", confinement=10.0))
    stress, sideways, energy = curves.figure([run.folder], data_folder).axes
    strain = 100.0 * run.history["axial_strain"]
    expected = np.column_stack([strain, run.history["axial_stress_MPa"]])
    np.testing.assert_allclose(line_of(stress, style.BLACK), expected)
    assert names(stress) == [f"first peak: {run.peak.stress:.4g} MPa"]
    expected = np.column_stack([strain, 100.0 * run.history["lateral_strain"]])
    np.testing.assert_allclose(line_of(sideways, style.BLUE), expected)
    assert names(energy) == [
        "external work", "elastic", "compressive dissipation", "fracture", "damping", "kinetic",
    ]  # fmt: skip
    assert energy.get_ylabel() == "energy\n[J per radian]"
    assert energy.get_xlabel() == "axial strain [%]"
    lost = line_of(energy, style.GREY)
    assert np.nanmax(lost[:, 1]) == pytest.approx(-run.energy["damping_J"].min())


def test_run_without_a_measure_shows_the_forces_of_its_loads(make_run, data_folder):
    folder = unmeasured(make_run("bar_wave", test="plane_strain"))
    forces, energy = curves.figure([folder], data_folder).axes
    assert names(forces) == ["top"]  # the other load is rounding
    assert line_of(forces, style.BLACK)[-1, 1] == pytest.approx(2.0)
    assert forces.get_ylabel() == "force\n[kN per metre of depth]"
    assert energy.get_xlabel() == "time [ms]"


def test_gauges_show_principal_values_of_every_probe(make_hole, data_folder):
    """The fixture turns opposite principal strains by 30 degrees and shears by engineering."""
    folder = make_hole("hole_r25.0")
    drawn = gauges.figure([folder], data_folder)
    stress, strain, plastic, strength = drawn.axes
    table = pd.read_parquet(folder / "probes.parquet")
    crown = table[table["probe"] == "crown"]
    larger = line_of(strain, style.BLACK)[:, 1]
    assert larger.max() == pytest.approx(100.0 * 2.0 * crown["strain_xx"].abs().max())
    assert line_of(strength, style.BLACK)[-1, 1] == crown["tensile_strength_1_MPa"].iloc[-1]
    assert len(stress.lines) > 2 * table["probe"].nunique()  # two a gauge, one for the legend
    shown = [text.get_text() for text in drawn.legends[0].get_texts()]
    assert shown == list(table["probe"].unique())
    assert plastic.get_xlabel() == strength.get_xlabel() == "axial strain [%]"


def test_gauges_beyond_the_colours_are_counted(make_hole, data_folder):
    folder = make_hole("hole_r25.0")
    table = pd.read_parquet(folder / "probes.parquet")
    more = [table.assign(probe=table["probe"] + end) for end in ("", "_b")]
    pd.concat(more).to_parquet(folder / "probes.parquet")
    drawn = gauges.figure([folder], data_folder)
    assert "7 of 10 gauges" in drawn.legends[0].get_title().get_text()


def test_elastic_run_has_no_damage_to_show(make_hole, data_folder):
    assert len(gauges.figure([make_hole("hole_elastic", whole=True)], data_folder).axes) == 2


def test_run_without_probes_says_so(make_run, data_folder):
    with pytest.raises(DataError, match=r"holds no probes\.parquet, expected a run with probes"):
        gauges.figure([make_run("a")], data_folder)


def test_pattern_has_shade_outline_and_cracks(make_cracked_run, data_folder):
    folder = make_cracked_run("sandstone_soft_p00", cracks=3)
    axes, bar = pattern.figure([folder], data_folder).axes
    shade = next(c for c in axes.findobj(PolyCollection) if c.get_array() is not None)
    assert np.max(shade.get_array()) == 0.01
    assert bar.get_ylabel() == "effective plastic strain [-]"
    found = {
        colour: sum(
            len(c.get_segments())
            for c in axes.findobj(LineCollection)
            if np.array_equal(c.get_colors()[0], to_rgba(colour))
        )
        for colour in (*(colour for _, colour in MODES.values()), style.GREY)
    }
    assert list(found.values())[:2] == [4, 2]  # both faces of two cracks and of one
    # around the rock (4 x 6 mm) and its platen (4 x 1 mm)
    assert found[style.GREY] == 20 + 10


def test_pattern_of_a_run_that_cannot_crack_is_its_plastic_strain(make_cracked_run, data_folder):
    folder = make_cracked_run("sandstone_soft_p00")
    (folder / "cracks.parquet").unlink()
    drawn = pattern.figure([folder], data_folder)
    assert not drawn.legends
    assert drawn.axes[0].findobj(PolyCollection)


def test_pattern_of_a_run_without_fields_says_so(make_run, data_folder):
    with pytest.raises(DataError, match=r"expected a run with output\.fields above 0"):
        pattern.figure([make_run("a")], data_folder)
