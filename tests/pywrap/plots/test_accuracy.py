"""Figure of error against run time (plots/accuracy.py)."""

import pandas as pd
import pytest

from lithofrac.data import DataError
from lithofrac.plots import accuracy

pytestmark = pytest.mark.no_core


@pytest.fixture
def table(tmp_path):
    rows = [
        {"problem": problem, "quantity": "peak", "knob": knob, "value": "", "default": "",
         "error_percent": error, "core_seconds": cost, "elements": 10, "steps": round(10 * cost)}
        for problem in ("a_bar", "b", "c", "d")
        for knob, error, cost in (
            ("default", 0.5, 2.0),
            ("element_size_mm", 3.0, 1.0),
            ("speed_m_s", 0.01, 0.5),  # by chance: dearer ones along this knob have more
            ("speed_m_s", 0.8, 1.5),
            ("speed_m_s", 0.0, 4.0),
            ("time_step_factor", 0.6, 4.0),
            ("finest", None, 9.0),
        )
    ]  # fmt: skip
    path = tmp_path / "accuracy.csv"
    pd.DataFrame(rows).to_csv(path, index=False)
    return path


def lines_of(panel):
    return {line.get_label(): line for line in panel.lines}


def test_each_problem_has_a_panel_with_its_front_and_its_default(table, data_folder):
    panels = accuracy.figure([table], data_folder).axes
    assert [panel.get_title(loc="left") for panel in panels[:2]] == ["a bar\npeak", "b\npeak"]
    lines = lines_of(panels[0])
    assert list(lines["default"].get_xdata()) == [2.0]
    assert list(lines["Pareto front"].get_xdata()) == [0.5, 2.0, 4.0]
    assert list(lines["Pareto front"].get_ydata()) == [0.8, 0.5, accuracy.FLOOR]


def test_the_front_is_that_of_errors_that_are_not_small_by_chance(table, data_folder):
    """The run at 0.5 s has 0.01 %, and the dearer one at 1.5 s along the same knob 0.8 %."""
    lines = lines_of(accuracy.figure([table], data_folder).axes[0])
    assert 0.01 in lines["loading rate"].get_ydata()  # its mark stands where it is
    assert 0.01 not in lines["Pareto front"].get_ydata()


def test_each_panel_says_how_far_the_default_is_from_the_front(table, data_folder):
    """2 s, where 0.5 s have at most 1 %; none cheaper once the 1.5 s along that knob have more."""
    said = [text.get_text() for text in accuracy.figure([table], data_folder).axes[0].texts]
    assert said == ["distance 4.0"]
    rows = pd.read_csv(table)
    rows.loc[rows["core_seconds"] == 1.5, "error_percent"] = 1.2
    rows.to_csv(table, index=False)
    said = [text.get_text() for text in accuracy.figure([table], data_folder).axes[0].texts]
    assert said == ["distance 1.0"]


def test_marks_tell_the_knobs_and_none_is_the_finest_solution(table, data_folder):
    lines = lines_of(accuracy.figure([table], data_folder).axes[0])
    assert list(lines["element size, strain step"].get_xdata()) == [1.0]
    assert list(lines["loading rate"].get_ydata()) == [0.01, 0.8, accuracy.FLOOR]
    assert not any(9.0 in line.get_xdata() for line in lines.values())


def test_axes_hold_whole_decades_with_some_room():
    assert accuracy.limits([0.02, 0.5]) == pytest.approx((0.01, 1.0))
    assert accuracy.limits([0.1, float("nan"), 0.95]) == pytest.approx((0.01, 10.0))


def test_another_table_is_refused(table, data_folder):
    table.write_text("a,b\n1,2\n")
    with pytest.raises(DataError, match="column 'problem' is missing, expected problem"):
        accuracy.figure([table], data_folder)
