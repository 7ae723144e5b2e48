"""Thresholds of the runtime guards (pywrap/lithofrac/config/guards.py)."""

from dataclasses import asdict
from pathlib import Path

import pytest

from lithofrac.config import ConfigError, load_case
from lithofrac.config.guards import FALLING, RISING, GuardsSection
from lithofrac.problem import Guards

pytestmark = pytest.mark.no_core

PUNCH = Path("configs/cases/punch.yaml")


def refusal(overrides: dict) -> str:
    with pytest.raises(ConfigError) as caught:
        load_case(PUNCH, overrides)
    return str(caught.value)


def test_a_case_that_says_nothing_has_the_limits_of_a_problem():
    assert load_case(PUNCH).guards.model_dump() == asdict(Guards())


def test_every_guard_has_a_warning_and_a_stop():
    names = {f"{name}_{kind}" for name in (*RISING, *FALLING) for kind in ("warning", "stop")}
    assert set(GuardsSection.model_fields) == names


def test_one_limit_leaves_the_others_alone():
    guards = load_case(PUNCH, {"guards.speed_stop": 0.5}).guards
    assert (guards.speed_warning, guards.speed_stop) == (0.1, 0.5)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("speed_stop", 0.05, "guards.speed_warning = 0.1: expected a number not above "
         "guards.speed_stop, 0.05"),
        ("element_area_stop", 0.5, "guards.element_area_warning = 0.1: expected a number not below "
         "guards.element_area_stop, 0.5"),
        ("unconverged_stop", 2.0, "guards.unconverged_stop = 2.0: expected a number from 0 to 1"),
        ("overlap_stop", -1, "guards.overlap_stop = -1: expected a number from 0 to 1e+09"),
        ("sped_stop", 0.5, "guards.sped_stop: unknown key, did you mean 'speed_stop'?"),
    ],
)  # fmt: skip
def test_limits_that_make_no_sense_are_refused(key, value, message):
    assert refusal({f"guards.{key}": value}) == f"command line: {message}"
