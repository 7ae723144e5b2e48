"""The judges of mutants can condemn: each kind of failure is seen where there is one."""

import json
import sys
import time

import fuzz_campaign
import fuzz_worker
import numpy as np
import pandas as pd
import pytest
from fuzz_bases import CASES, MATERIALS, OTHER_MSH
from fuzz_mutants import Mutant, mutant

from lithofrac import cli

RIGHT = Mutant(
    seed=0,
    target="case bar",
    files={
        "case.yaml": CASES["bar"].encode(),
        **{name: text.encode() for name, text in MATERIALS.items()},
    },
    words=("check", "case.yaml"),
)


@pytest.fixture
def verdict(monkeypatch):
    """verdict() on the right case, with few steps; the command line is as before afterwards."""
    for name in ("case_of", "accepted"):
        monkeypatch.setattr(cli, name, getattr(cli, name))
    monkeypatch.setattr(fuzz_worker, "MOST_STEPS", 10)
    fuzz_worker.limit_runs()
    return lambda: fuzz_worker.verdict(RIGHT)


def test_a_right_case_ends_in_a_result_of_few_steps(verdict):
    found = verdict()
    assert found["kind"] == "result"
    assert "step 10 of 10" in found["detail"]


def test_a_case_that_is_too_large_to_run_here_is_refused_above_its_budget(verdict, monkeypatch):
    monkeypatch.setattr(fuzz_worker, "MOST_ELEMENTS", 5)
    found = verdict()
    assert found["kind"] == "large"
    assert found["detail"].endswith(" elements by prediction")
    text = b"budget_element_steps: 10.0\n" + RIGHT.files["case.yaml"]
    monkeypatch.setitem(RIGHT.files, "case.yaml", text)
    found = verdict()
    assert found["kind"] == "refused"
    assert "budget_element_steps = 10" in found["detail"]


def test_a_seed_always_gives_the_same_mutant():
    meshes = {name: bytes(range(200)) for name in (*CASES, "own", "own_22.msh", *OTHER_MSH)}
    texts = [seed for seed in range(60) if not _reads_a_mesh(seed, meshes)]
    assert len(texts) > 30
    assert [mutant(seed, meshes) for seed in texts] == [mutant(seed, meshes) for seed in texts]


def _reads_a_mesh(seed: int, meshes: dict[str, bytes]) -> bool:
    try:
        return mutant(seed, meshes).target.startswith("mesh")
    except ValueError:  # the arrays of what is no mesh here
        return True


def test_a_traceback_is_seen(verdict, monkeypatch):
    monkeypatch.setattr(cli, "_print_plan", lambda *_: 1 / 0)
    found = verdict()
    assert found["kind"] == "traceback"
    assert "ZeroDivisionError" in found["detail"]


@pytest.mark.parametrize("said", ["", "Traceback: oh\n", "lithofrac: \x1b[31m\n", "x" * 2000])
def test_words_that_are_no_clear_sentence_are_seen(verdict, monkeypatch, said):
    def refusing(*_):
        print(said, file=sys.stderr, end="")
        return 2

    monkeypatch.setattr(cli, "main", refusing)
    assert verdict()["kind"] == "words"


def test_files_that_should_not_be_are_seen(verdict, monkeypatch):
    def writing(words):
        open("stray", "w").close()
        return 0

    monkeypatch.setattr(cli, "main", writing)
    assert verdict()["kind"] == "written"


def test_a_number_that_is_none_is_seen(verdict, monkeypatch):
    def wrong(path, table):
        numbers = table.select_dtypes("number").columns[-1]
        table.assign(**{numbers: np.nan}).to_parquet(path)

    monkeypatch.setattr("lithofrac.run.write_table", wrong)
    found = verdict()
    assert found["kind"] == "nan"
    assert ".parquet: " in found["detail"]


def test_a_hang_and_a_crash_are_seen_and_the_others_go_on(tmp_path, monkeypatch):
    worker = tmp_path / "worker.py"
    worker.write_text(
        "import json, os, sys, time\n"
        "for line in sys.stdin:\n"
        "    seed = int(line)\n"
        "    if seed == 1: time.sleep(600)\n"
        "    if seed == 3: os.abort()\n"
        "    print(json.dumps({'seed': seed, 'kind': 'result'}), flush=True)\n"
    )
    monkeypatch.setattr(fuzz_campaign, "WORKER", worker)
    monkeypatch.setattr(fuzz_campaign, "TIME_LIMIT", 5.0)
    monkeypatch.setattr(fuzz_campaign, "MAKE_MESHES", "")
    start = time.monotonic()
    found = fuzz_campaign.campaign(0, 5, processes=1)
    assert time.monotonic() - start < 60.0
    assert [verdict["kind"] for verdict in found] == ["result", "hang", "result", "crash", "result"]
    said = fuzz_campaign.failures(found)
    assert "seed 1: hang" in said
    assert "exit code -6" in said
    assert "--first 3" in said


def test_tables_of_a_run_are_what_is_judged(tmp_path):
    (tmp_path / "summary.json").write_text(
        json.dumps({"status": "completed", "energy_residual": 0.0})
    )
    pd.DataFrame({"name": ["a"], "value": [1.0]}).to_parquet(tmp_path / "history.parquet")
    fuzz_worker._judge_numbers(tmp_path)
    pd.DataFrame({"name": ["a"], "value": [np.inf]}).to_parquet(tmp_path / "history.parquet")
    with pytest.raises(fuzz_worker.Failure, match="value"):
        fuzz_worker._judge_numbers(tmp_path)
