"""Fitted exponents and their series (benchmark/growth.py)."""

import numpy as np
import pytest

from lithofrac.benchmark import growth, race


@pytest.fixture(autouse=True)
def short(monkeypatch):
    monkeypatch.setattr(race, "ELEMENT_STEPS", 1e4)
    monkeypatch.setattr(growth, "CONTACT_STEPS", 20)


def test_a_power_law_has_its_exponent_and_a_narrow_interval():
    x = np.array([1.0, 2.0, 5.0, 20.0])
    slope, low, high = growth.exponent(x, 3.0 * x**1.5)
    assert slope == pytest.approx(1.5)
    assert low <= slope <= high
    assert high - low < 1e-6


def test_the_interval_holds_the_exponent_of_noisy_times():
    """At 95 %, of 400 fits at least 360 and not all hold it."""
    random = np.random.default_rng(1)
    x = np.array([1.0, 2.0, 4.0, 8.0, 16.0])
    held = 0
    for _ in range(400):
        _, low, high = growth.exponent(x, x * np.exp(0.1 * random.standard_normal(5)))
        held += low <= 1.0 <= high
    assert 360 <= held < 400


def test_two_points_have_an_exponent_without_interval():
    slope, low, high = growth.exponent(np.array([1.0, 2.0]), np.array([1.0, 0.5]))
    assert slope == pytest.approx(-1.0)
    assert np.isnan([low, high]).all()


def test_points_below_zero_are_left_out():
    x = np.array([1.0, 2.0, 4.0, 8.0, 16.0])
    slope, *_ = growth.exponent(x, np.array([-1.0, 2.0, 4.0, 8.0, 16.0]))
    assert slope == pytest.approx(1.0)
    assert np.isnan(growth.exponent(x, -x)).all()


def test_a_test_of_fixed_duration_takes_more_steps_of_smaller_elements():
    rows = growth.with_elements((4, 8, 12, 16), repeat=1)
    step = {row["x"]: row["seconds"] for row in rows if row["series"] == "elements"}
    test = {row["x"]: row["seconds"] for row in rows if row["series"] == "test"}
    assert list(step) == list(test) == [32, 128, 288, 512]
    steps = [test[x] / step[x] for x in step]
    assert steps == sorted(steps)
    assert steps[-1] / steps[0] == pytest.approx(4.0, rel=0.3)  # 1/h


def test_series_have_the_points_that_were_asked_for():
    rows = growth.with_steps(4, (10, 20, 40, 80), repeat=1)
    assert [row["x"] for row in rows] == [10, 20, 40, 80]
    rows = growth.with_threads(4, [1, 2], repeat=1)
    assert [row["x"] for row in rows] == [1, 2]
    rows = growth.with_cracks(8, (4, 2), repeat=1)
    assert [row["x"] for row in rows] == [16, 48]  # one and three cuts a way of 8 edges
    rows = growth.of_few((4, 8, 16), repeat=1)
    assert len({row["at_no_element"] for row in rows}) == 1


def test_what_is_left_at_no_element_is_the_start_of_the_line(monkeypatch):
    """Times of 0.5 us and 1 us for each of 1, 2 and 4 chunks."""

    def race_of(subjects, elements, repeat):
        chunks = dict(zip(subjects, (1, 2, 4), strict=True))
        speeds = {name: [elements / (0.5 + 1.0 * n)] for name, n in chunks.items()}
        return {name: race.Speeds(own, own) for name, own in speeds.items()}

    monkeypatch.setattr(growth, "race", race_of)
    rows = growth.of_few((8, 11, 16), repeat=1)
    assert rows[0]["seconds"] == pytest.approx(1.5e-6)
    assert [row["at_no_element"] for row in rows] == pytest.approx([0.5e-6] * 3)
