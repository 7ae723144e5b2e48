"""Tables of the sweep (accuracy/sweep.py, summary.py) from made-up outcomes."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from lithofrac.accuracy import sweep
from lithofrac.accuracy.subject import Outcome, Subject
from lithofrac.accuracy.summary import FAR, UNEXPLAINED, summarised, unexplained
from lithofrac.accuracy.sweep import COLUMNS, make_sweep, table_of
from lithofrac.config.errors import ConfigError
from lithofrac.errors import CoreError


def subject(**changes):
    given = {
        "name": "made_up",
        "title": "",
        "run": None,
        "default": {"element_size_mm": 1.0, "speed_m_s": 0.1},
        "sweep": {"element_size_mm": (2.0, 0.5), "speed_m_s": (0.2, 0.4)},
        "quantities": ("peak",),
    }
    return Subject(**(given | changes))


def outcomes(*errors_and_costs):
    return [
        Outcome({"peak": error}, cost, elements=100, steps=round(1000 * cost))
        for error, cost in errors_and_costs
    ]


# default, 2 mm, 0.5 mm, 0.2 m/s, 0.4 m/s
KNOWN = outcomes((0.008, 8.0), (0.032, 1.0), (-0.002, 64.0), (0.009, 4.0), (0.001, 2.0))


def test_errors_of_a_known_answer_are_those_of_the_run():
    table = table_of(subject(), KNOWN)
    assert tuple(table) == COLUMNS
    assert list(table["error_percent"]) == pytest.approx([0.8, 3.2, 0.2, 0.9, 0.1])
    assert list(table["knob"]) == ["default", *["element_size_mm"] * 2, *["speed_m_s"] * 2]
    assert list(table["value"]) == ["", "2", "0.5", "0.2", "0.4"]
    assert list(table["default"]) == ["", "1", "1", "0.1", "0.1"]


def test_summary_gives_order_cheapest_setting_and_distance():
    row = summarised(table_of(subject(), KNOWN), {"made_up": subject()}).iloc[0]
    assert row["order_in_size"] == pytest.approx(2.0)
    assert row["default_error_percent"] == pytest.approx(0.8)
    # 0.1 % at 0.4 m/s is below the 0.9 % at 0.2 m/s by chance, but within 1 % both
    assert row["for_1_percent_take"] == "speed_m_s = 0.4"
    assert row["its_core_seconds"] == 2.0
    assert row["distance"] == 4.0


def test_an_error_that_is_small_by_chance_is_not_taken():
    runs = outcomes((0.008, 8.0), (0.032, 1.0), (0.002, 64.0), (0.03, 4.0), (0.001, 2.0))
    row = summarised(table_of(subject(), runs), {"made_up": subject()}).iloc[0]
    assert row["for_1_percent_take"] == "the default"
    assert row["distance"] == 1.0


def test_a_reason_is_given_where_the_default_is_far_from_the_front_and_only_there():
    said = subject(reasons={"peak": "it is slow"})
    assert summarised(table_of(said, KNOWN), {"made_up": said})["reason"][0] == "it is slow"
    near = outcomes((0.008, 2.0), (0.032, 1.0), (0.002, 64.0), (0.02, 1.5), (0.03, 1.2))
    assert summarised(table_of(said, near), {"made_up": said})["reason"][0] == ""


def test_a_default_that_is_far_without_a_reason_is_told():
    summary = summarised(table_of(subject(), KNOWN), {"made_up": subject()})
    assert summary["reason"][0] == UNEXPLAINED
    assert unexplained(summary) == [
        "made_up, peak: the default lies 4 from the front and has no reason, expected at most 1.5"
    ]
    said = subject(reasons={"peak": "it is slow"})
    assert not unexplained(summarised(table_of(said, KNOWN), {"made_up": said}))


@pytest.mark.parametrize(("cost", "words"), [(3.0, ""), (3.1, UNEXPLAINED)])
def test_a_reason_is_due_above_one_and_a_half(cost, words):
    runs = outcomes((0.008, cost), (0.032, 1.0), (0.002, 64.0), (0.02, 1.5), (0.009, 2.0))
    assert summarised(table_of(subject(), runs), {"made_up": subject()})["reason"][0] == words


def test_a_sweep_with_a_default_that_lacks_a_reason_says_so(tmp_path, monkeypatch):
    made_up = subject(name="bar_wave", sweep={"element_size_mm": (2.0,)}, run=None)
    monkeypatch.setattr(sweep, "SUBJECTS", {"bar_wave": made_up})
    monkeypatch.setattr(sweep, "ProcessPoolExecutor", lambda *_, **__: ThreadPoolExecutor(1))
    runs = dict(enumerate(outcomes((0.008, 8.0), (0.009, 2.0))))
    monkeypatch.setattr(sweep, "run_one", lambda name, number: runs[number])
    (told,) = make_sweep(tmp_path, [], 1, say=lambda _: None)
    assert told.startswith("bar_wave, peak: the default lies 4 from the front and has no reason")


def test_every_default_on_the_sheet_that_is_far_has_a_reason():
    """The table as it is published; `lithofrac accuracy` marks what has none."""
    page = (Path(__file__).parents[3] / "reports/sheets/11_accuracy.md").read_text("utf-8")
    table = page.split("<!-- table: accuracy_summary")[1].split("<!-- end -->")[0]
    head, _, *rows = [line.strip("| ").split(" | ") for line in table.splitlines()[1:]]
    assert len(rows) > 9
    for row in (dict(zip(head, cells, strict=True)) for cells in rows):
        where = f"{row['problem']}, {row['quantity']}"
        assert row["reason"] != UNEXPLAINED, where
        assert float(row["distance"]) <= FAR or len(row["reason"]) > len(UNEXPLAINED), where


def test_own_finest_solution_is_what_the_others_are_held_against():
    own = subject(finest={"element_size_mm": 0.25})
    runs = outcomes((99.2, 8.0), (90.0, 1.0), (100.5, 64.0), (98.0, 4.0), (97.0, 2.0), (100, 99))
    table = table_of(own, runs)
    assert list(table["error_percent"])[:-1] == pytest.approx([0.8, 10.0, 0.5, 2.0, 3.0])
    assert np.isnan(table["error_percent"].iloc[-1])
    assert summarised(table, {"made_up": own})["for_1_percent_take"][0] == "the default"


def test_a_run_that_failed_has_no_numbers_but_the_finest_must_not_fail():
    table = table_of(subject(), [KNOWN[0], "step 3: it broke", *KNOWN[2:]])
    assert np.isnan(table["error_percent"][1])
    own = subject(finest={"element_size_mm": 0.25})
    with pytest.raises(CoreError, match="made_up, finest: step 3: it broke"):
        table_of(own, [*KNOWN, "step 3: it broke"])


def test_an_unknown_problem_lists_all(tmp_path):
    with pytest.raises(ConfigError, match="--only kirch: no such problem, expected one of"):
        make_sweep(tmp_path / "new", ["kirch"], 1)
    assert not (tmp_path / "new").exists()
