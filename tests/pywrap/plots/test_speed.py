"""Figure of speed, leaving out, growth and prediction (plots/speed.py)."""

import json

import pandas as pd
import pytest

from lithofrac.data import DataError
from lithofrac.plots import speed

pytestmark = pytest.mark.no_core
RATE = "million_element_steps_per_core_second"


@pytest.fixture
def measured(tmp_path):
    rows = [
        {"name": name, "elements": n, "threads": 1, RATE: 50.0, "lowest": 40.0, "highest": 55.0}
        for name in ("bare_elastic_kernel", "full_step")
        for n in (5000, 49928)
    ]
    rows.append(rows[-1] | {"threads": 2})
    (tmp_path / "benchmark.json").write_text(json.dumps({"rows": rows}))
    leave_out = {
        "case": ["kirsch", "punch_discrete"],
        "continuum": [True, False],
        "forced_over_needed": [2.1, 1.2],
        "run_seconds": [0.1, 2.0],
        "check_seconds": [0.15, 3.0],
    }
    growth = [
        {"series": name, "x": x, "seconds": x**1.5, "exponent": 1.5} | interval
        for name, interval in (
            ("elements", {"exponent_low": 1.4, "exponent_high": 1.6}),
            ("threads", {"exponent_low": None, "exponent_high": None}),
        )
        for x in (1.0, 2.0)
    ]
    paths = [tmp_path / name for name in speed.INPUTS]
    pd.DataFrame(leave_out).to_csv(paths[1], index=False)
    pd.DataFrame(growth).to_csv(paths[2], index=False)
    return paths


def test_each_kind_of_step_has_its_row_and_two_threads_none(measured, data_folder):
    panel = speed.figure(measured, data_folder).axes[0]
    names = [label.get_text() for label in panel.get_yticklabels()]
    assert names == ["bare elastic kernel", "full step"]
    points = [len(group[0].get_xdata()) for group in panel.containers]
    assert points == [2, 2, 0]  # 5,000, 50,000 and no 200,000 elements


def test_exponents_stand_in_the_legend_with_their_interval(measured, data_folder):
    panel = speed.figure(measured[::-1], data_folder).axes[2]
    words = [text.get_text() for text in panel.get_legend().get_texts()]
    assert words == [
        "a step, over elements: 1.50 ± 0.10",
        "a step on the wall, over threads: 1.50",
    ]


def test_predictions_stand_by_kind_within_their_factor(measured, data_folder):
    panel = speed.figure(measured, data_folder).axes[3]
    assert list(panel.lines[0].get_ydata()) == [0.15]
    assert list(panel.lines[1].get_ydata()) == [3.0]
    assert list(panel.lines[3].get_ydata()) == [0.05, 1.0]


def test_other_inputs_are_refused(measured, data_folder):
    with pytest.raises(DataError, match=r"expected benchmark\.json, leave_out\.csv, growth\.csv"):
        speed.figure(measured[:2], data_folder)
