"""Load curve with the moments of cracking (plots/events.py)."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from lithofrac.analysis.runs import Run
from lithofrac.plots import events
from lithofrac.plots.fractures import MODES

pytestmark = pytest.mark.no_core


@pytest.fixture
def folder(make_cracked_run):
    """Cracks of 1 mm at 0.8, 1.0 and 1.2 % axial strain, the last in compressive dilation."""
    return make_cracked_run("sandstone_soft_p00", cracks=3)


def test_a_tick_a_crack_stands_at_the_strain_of_its_insertion(folder, data_folder):
    panel = events.figure([folder], data_folder).axes[1]
    rows = [np.array(drawn.get_segments()) for drawn in panel.findobj(LineCollection)]
    np.testing.assert_allclose(rows[0][:, 0, 0], [0.8, 1.0])
    np.testing.assert_allclose(rows[1][:, 0, 0], [1.2])
    labels = [label.get_text() for label in panel.get_yticklabels()]
    assert labels == ["tensile: 2", "compressive dilation: 1"]
    assert panel.get_ylabel() == "crack\nedges"


def test_length_adds_up_to_the_sum_of_all_cracks(folder, data_folder):
    panel = events.figure([folder], data_folder).axes[2]
    curves = {line.get_label(): line.get_xydata() for line in panel.lines}
    assert set(curves) == {"all", *(words for words, _ in MODES.values())}
    np.testing.assert_allclose(curves["all"][:, 1], [0, 1, 2, 3, 3])
    np.testing.assert_allclose(curves["all"][1:4, 0], [0.8, 1.0, 1.2])
    assert sum(curve[-1, 1] for name, curve in curves.items() if name != "all") == 3.0


def test_panels_share_the_strain_and_name_their_units(folder, data_folder):
    figure = events.figure([folder], data_folder)
    assert figure.axes[2].get_xlabel() == "axial strain [%]"
    assert figure.axes[0].get_ylabel() == "axial stress [MPa]"
    assert figure.axes[2].get_ylabel() == "crack length\n[mm]"
    assert len({panel.get_xlim() for panel in figure.axes}) == 1


def test_stress_under_a_punch_is_called_so(make_cracked_run):
    assert events.stress_label(Run(make_cracked_run("p", test="punch"))) == "punch stress [MPa]"


def test_run_without_cracks_has_its_curve_alone_and_says_so(folder, data_folder):
    cracks = Run(folder).cracks
    cracks.iloc[:0].to_parquet(folder / "cracks.parquet")
    (panel,) = events.figure([folder], data_folder).axes
    assert len(panel.lines[0].get_xdata()) > 100
    assert "no cracks" in [text.get_text() for text in panel.texts]
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("axial strain [%]", "axial stress [MPa]")
