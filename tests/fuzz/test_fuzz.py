"""No input makes a traceback, a hang, a crash or a NaN: a result, or a clear sentence.

A failure names its seed; `python tests/fuzz/fuzz_campaign.py --first SEED` repeats it alone.
"""

import os
from collections import Counter

import pytest
from fuzz_campaign import GOOD, campaign, failures
from fuzz_mutants import MORE


def assert_all_well(verdicts: list[dict], count: int) -> None:
    counts = Counter(found["kind"] for found in verdicts)
    print(dict(counts))
    assert not failures(verdicts), failures(verdicts)
    assert sum(counts[kind] for kind in GOOD) == count
    assert counts["refused"] > count / 10
    assert counts["result"] > count / 10


def test_some_mutants_end_in_a_result_or_a_sentence(n_random):
    count = n_random(300, least=40)
    assert_all_well(campaign(0, count), count)


def test_checkpoints_and_scripts_end_in_a_result_or_a_sentence(n_random):
    count = n_random(24, least=6)
    found = campaign(MORE, count)
    print(dict(Counter(verdict["kind"] for verdict in found)))
    assert not failures(found), failures(found)
    assert {verdict["kind"] for verdict in found} >= {"refused"}


@pytest.mark.slow
def test_ten_thousand_mutants_end_in_a_result_or_a_sentence():
    processes = min(8, os.cpu_count() or 1)
    assert_all_well(campaign(0, 10_000, processes), 10_000)
