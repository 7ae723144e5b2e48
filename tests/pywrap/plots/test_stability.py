"""Figure of the stability limit and the margins (plots/stability.py)."""

import pandas as pd
import pytest

from lithofrac.data import DataError
from lithofrac.plots import stability

pytestmark = pytest.mark.no_core


@pytest.fixture
def tables(tmp_path):
    curve = [
        {"mesh": mesh, "time_step_factor": factor, "internal_over_put_in": energy, "broke": broke}
        for mesh in stability.STYLES
        for factor, energy, broke in ((0.5, 1.2, False), (0.9, 4.0, False), (1.2, None, True))
    ]
    cells = [
        {"family": family, "mesh": mesh, "margin": margin}
        for family in ("density", "impact")
        for mesh, margin in (("continuum", 1.2), ("contact", 1.1), ("cracked", None))
    ]
    paths = [tmp_path / "stability_limit.csv", tmp_path / "stability.csv"]
    pd.DataFrame(curve).to_csv(paths[0], index=False)
    pd.DataFrame(cells).to_csv(paths[1], index=False)
    return paths


def test_a_run_that_broke_stands_on_the_upper_edge(tables, data_folder):
    panel = stability.figure(tables, data_folder).axes[0]
    for line in panel.lines[: len(stability.STYLES)]:
        assert list(line.get_ydata()) == [1.2, 4.0, stability.CEILING]


def test_margins_stand_in_the_row_of_their_family(tables, data_folder):
    panel = stability.figure(tables[::-1], data_folder).axes[1]
    assert [label.get_text() for label in panel.get_yticklabels()] == ["density", "impact"]
    continuum, contact, cracked = panel.lines[:3]
    assert list(continuum.get_xdata()) == [1.2, 1.2]
    assert list(contact.get_ydata()) == [0.0, 1.0]
    assert not len(cracked.get_xdata())


def test_other_inputs_are_refused(tables, data_folder):
    with pytest.raises(DataError, match=r"expected stability_limit\.csv and stability\.csv"):
        stability.figure(tables[:1], data_folder)
