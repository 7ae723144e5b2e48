"""Friction by pairs of surfaces (pywrap/lithofrac/config/contact.py)."""

from pathlib import Path

import pytest

from lithofrac.config import ConfigError, load_case

pytestmark = pytest.mark.no_core

PUNCH = Path("configs/cases/punch.yaml")
TRIAXIAL = Path("configs/cases/sandstone_triaxial.yaml")


def refusal(path: Path, overrides: dict) -> str:
    with pytest.raises(ConfigError) as caught:
        load_case(path, overrides)
    return str(caught.value)


def test_the_punch_has_the_friction_of_the_paper():
    pairs = load_case(PUNCH).contact.pairs
    assert pairs == {("rock", "platen"): 0.005, ("rock", "rock"): 1.2}


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("rock-steel", 0.1, "unknown surface 'steel', expected one of: platen, rock"),
        ("rock-platn", 0.1, "unknown surface 'platn', did you mean 'platen'?"),
        ("rock", 0.1, "expected two surfaces, as in rock-rock"),
        ("platen-rock", 0.1, "the pair is given twice, expected one order of the two"),
        ("rock-rock", -1, "expected a number not below 0"),
    ],
)
def test_a_wrong_pair_is_refused_in_one_sentence(key, value, message):
    said = refusal(PUNCH, {f"contact.friction.{key}": value})
    assert said == f"command line: contact.friction.{key} = {value:g}: {message}"


def test_a_scene_without_platens_has_one_surface():
    assert load_case(TRIAXIAL, {"contact.friction.rock-rock": 0.5}).contact.pairs
    said = refusal(TRIAXIAL, {"contact.friction.rock-platen": 0.5})
    assert said.endswith("unknown surface 'platen', expected one of: rock")
