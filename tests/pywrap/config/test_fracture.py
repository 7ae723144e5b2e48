"""Discrete cracks on and off (pywrap/lithofrac/config/fracture.py and fit.py)."""

from pathlib import Path

import pytest

from lithofrac.config import ConfigError, load_case
from lithofrac.config.setting import settings, text_of

pytestmark = pytest.mark.no_core

PUNCH = Path("configs/cases/punch.yaml")
TRIAXIAL = Path("configs/cases/sandstone_triaxial.yaml")
PLANE_STRAIN = Path("configs/cases/sandstone_plane_strain.yaml")
ON = {"fracture.mode": "inter_element"}


@pytest.mark.parametrize("word", ["fracture=off", "fracture.mode=off", "fracture='off'"])
def test_off_is_a_word_though_yaml_reads_it_as_false(word, tmp_path):
    case = load_case(PUNCH, settings([word]))
    assert not case.fracture.on
    (tmp_path / "back.yaml").write_text(text_of(case))
    assert load_case(tmp_path / "back.yaml") == case


def test_cracks_are_off_unless_asked_for():
    assert load_case(PLANE_STRAIN).fracture.mode == "off"
    assert load_case(PUNCH, ON).fracture.on


def test_a_mode_goes_over_the_word_off(tmp_path):
    (tmp_path / "a.yaml").write_text(PUNCH.read_text() + "fracture: off\n")
    assert load_case(tmp_path / "a.yaml", ON).fracture.mode == "inter_element"


@pytest.mark.parametrize(
    ("path", "overrides", "message"),
    [
        (
            PLANE_STRAIN,
            ON,
            "fracture.mode = inter_element: faces of cracks need a section contact:, expected it "
            "or off",
        ),
        (
            TRIAXIAL,
            {**ON, "contact": {}},
            "fracture.mode = inter_element: the scene triaxial is axisymmetric, where cracks along "
            "the hoop cannot be inserted, expected off",
        ),
        (
            PUNCH,
            {**ON, "material.elastic": True},
            "fracture.mode = inter_element: the material is elastic, nothing in it can fail, "
            "expected off",
        ),
        (
            PUNCH,
            {"fracture.mode": "inter-element"},
            "fracture.mode = inter-element: unknown word, did you mean 'inter_element'?",
        ),
        (
            PUNCH,
            {"fracture.interval": 3},
            "fracture.interval: unknown key, did you mean 'interval_steps'?",
        ),
        (
            PUNCH,
            {"fracture.release_steps": -1},
            "fracture.release_steps = -1: expected a whole number from 0 to 1000000",
        ),
        (PUNCH, {"fracture": 3}, "fracture = 3: expected a mapping of keys"),
    ],
)
def test_what_cannot_crack_is_refused_in_one_sentence(path, overrides, message):
    with pytest.raises(ConfigError) as caught:
        load_case(path, overrides)
    assert str(caught.value) == f"command line: {message}"
