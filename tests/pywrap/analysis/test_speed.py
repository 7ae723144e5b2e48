"""Targets of speed with their verdicts (analysis/speed.py): from the measured files alone."""

import json
from pathlib import Path

import pandas as pd
import pytest

from lithofrac.analysis import speed
from lithofrac.analysis.verdict import FAILS, HOLDS, OPEN
from lithofrac.data import DataError

pytestmark = pytest.mark.no_core
DATA = Path(__file__).parents[3] / "data"
RATE = "million_element_steps_per_core_second"


def row(name, elements, threads=1, **more):
    return {"name": name, "elements": elements, "threads": threads, RATE: 100.0} | more


@pytest.fixture
def files(tmp_path):
    def write(rows, leave_out=None, growth=None, runs=()):
        paths = [tmp_path / "benchmark.json"]
        peaks = {"continuum": 999.0, "discrete_0.1": 1001.0, "discrete_0.5": 1e4}
        memory = {block: {"peak_bytes_per_element": peak} for block, peak in peaks.items()}
        paths[0].write_text(json.dumps({"memory": memory, "rows": rows}))
        for name, table in (("leave_out", leave_out), ("growth", growth)):
            if table is not None:
                paths.append(tmp_path / f"{name}.csv")
                pd.DataFrame(table).to_csv(paths[-1], index=False)
        for name, seconds in runs:
            (tmp_path / name).mkdir()
            paths.append(tmp_path / name / "summary.json")
            paths[-1].write_text(json.dumps({"case": name, "core_seconds": seconds}))
        return paths

    return write


def verdicts(paths, tmp_path):
    table = speed.speed_targets(paths, DATA)
    return {row.target: (row.measured, row.verdict) for row in table.itertuples()}


def test_what_was_not_measured_cannot_be_checked(files, tmp_path):
    found = verdicts(files([]), tmp_path)
    for block in ("continuum", "discrete_0.1", "discrete_0.5"):
        del found[f"memory at the peak, {block}"]
    assert {verdict for _, verdict in found.values()} == {OPEN}


@pytest.mark.parametrize(("ratio", "said"), [(0.6, HOLDS), (0.599, FAILS)])
def test_a_row_is_found_by_its_elements_to_two_percent(files, tmp_path, ratio, said):
    found = verdicts(files([row("full_step", 49928, of_bare_kernel=ratio)]), tmp_path)
    assert found["full_step over the bare kernel, 50,000 elements"] == (ratio, said)
    assert found["full_step over the bare kernel, 5,000 elements"][1] == OPEN


def test_memory_is_judged_by_block_and_has_no_target_where_all_is_cut(files, tmp_path):
    found = verdicts(files([]), tmp_path)
    assert found["memory at the peak, continuum"] == (999.0, HOLDS)
    assert found["memory at the peak, discrete_0.1"] == (1001.0, FAILS)
    assert found["memory at the peak, discrete_0.5"] == (1e4, speed.NONE)


@pytest.mark.parametrize("name", speed.THREADED)
@pytest.mark.parametrize(("gain", "said"), [(0.96, HOLDS), (0.94, FAILS)])
def test_two_threads_may_take_little_longer_on_few_elements(files, tmp_path, name, gain, said):
    rows = [row(name, 5000, 2, speed_up=gain), row(name, 5000, speed_up=9.0)]
    found = verdicts(files(rows), tmp_path)
    assert found[f"{name}: time of two threads over one, 5,000 elements"][1] == said


@pytest.mark.parametrize("name", speed.THREADED)
def test_each_kind_of_step_is_judged_for_its_own_gain_of_two_threads(files, tmp_path, name):
    rows = [row(other, 49928, 2, speed_up=1.7) for other in speed.THREADED if other != name]
    found = verdicts(files([*rows, row(name, 49928, 2, speed_up=1.5)]), tmp_path)
    gains = {what: said for what, (_, said) in found.items() if "over one, 50,000" in what}
    assert gains.pop(f"{name}: two threads over one, 50,000 elements") == FAILS
    assert set(gains.values()) == {HOLDS}


def test_the_full_discrete_step_has_a_target_of_its_own(files, tmp_path):
    rows = [
        row("discrete_step_pairs_0.1", 5000, of_bare_kernel=0.3),
        row("discrete_step_full_0.1", 5000, of_bare_kernel=0.2),
    ]
    found = verdicts(files(rows), tmp_path)
    assert found["discrete_step_pairs_0.1 over the bare kernel, 5,000 elements"] == (0.3, HOLDS)
    assert found["discrete_step_full_0.1 over the bare kernel, 5,000 elements"] == (0.2, FAILS)


def test_what_damping_adds_is_told_without_a_verdict(files, tmp_path):
    rows = [
        row("full_step", 5000, of_bare_kernel=0.75),
        row("full_step_damped", 5000, of_bare_kernel=0.5),
    ]
    found = verdicts(files(rows), tmp_path)
    assert found["time of full_step_damped over full_step, 5,000 elements"] == (1.5, speed.NONE)
    assert found["full_step over the bare kernel, 5,000 elements"] == (0.75, HOLDS)


def test_one_scene_with_other_bits_is_a_failure(files, tmp_path):
    table = {
        "same_bits": [True, False],
        "continuum": [True, False],
        "check_over_measured": [0.4, 9.0],
    }
    found = verdicts(files([], leave_out=table), tmp_path)
    assert found["scenes whose bits hang on what is left out"] == (1, FAILS)
    # only continuum runs count, and too fast is as wrong as too slow
    factor, said = found["predicted over measured time of a continuum run, or its inverse"]
    assert factor == pytest.approx(2.5)
    assert said == FAILS


def test_what_is_no_element_is_held_against_an_elastic_step(files, tmp_path):
    growth = {"series": ["small", "steps"], "at_no_element": [5e-7, None]}
    found = verdicts(files([row("elastic_step", 5000)], growth=growth), tmp_path)
    percent, said = found["of an elastic step, all that is not for elements"]
    assert percent == pytest.approx(1.0)  # 0.5 of 50 microseconds
    assert said == HOLDS


def test_the_punch_is_timed_by_its_summary(files, tmp_path):
    runs = [("punch_discrete", 61.0), ("punch_gf60", 29.0)]
    found = verdicts(files([], runs=runs), tmp_path)
    assert found["punch_discrete"] == (61.0, FAILS)
    of_paper = 8.5 * 3600.0 / 61.0  # Klerck 2004, section 3.1
    what = "punch_discrete: time that the paper states over ours"
    assert found[what] == (pytest.approx(of_paper), speed.NONE)
    assert found["punch_gf60"] == (29.0, HOLDS)


def test_rows_keep_their_order_and_leave_out_unknown_columns(files, tmp_path):
    table = speed.speed_rows(files([row("b", 1, odd=1), row("a", 2)]), DATA)
    assert list(table["name"]) == ["b", "a"]
    assert "odd" not in table


def test_the_benchmark_is_needed(tmp_path):
    with pytest.raises(DataError, match=r"expected benchmark\.json"):
        speed.speed_targets([], tmp_path)
