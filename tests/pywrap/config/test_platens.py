"""Platens as bodies (pywrap/lithofrac/config/platens.py and fit.py)."""

from pathlib import Path

import pytest

from lithofrac.config import ConfigError, load_case

pytestmark = pytest.mark.no_core

PUNCH = Path("configs/cases/punch.yaml")
TRIAXIAL = Path("configs/cases/sandstone_triaxial.yaml")
PLANE_STRAIN = Path("configs/cases/sandstone_plane_strain.yaml")
STEEL = {"platens": {"material": "steel", "thickness_mm": 10}}


def refusal(path: Path, overrides: dict) -> str:
    with pytest.raises(ConfigError) as caught:
        load_case(path, overrides)
    return str(caught.value)


def test_platens_are_of_a_named_material_of_which_keys_may_differ():
    case = load_case(PUNCH, {"platens.material.young_modulus_GPa": 200})
    steel = case.platens.material
    assert (steel.young, steel.poisson, steel.elastic) == (200e9, 0.3, True)
    assert case.material.young == 68e9
    assert refusal(PUNCH, {"platens.material": "steal"}) == (
        "command line: material 'steal': no such material, did you mean 'steel'?"
    )


def test_a_material_file_is_looked_for_beside_the_file_that_names_it(tmp_path):
    soft = tmp_path / "below" / "soft.yaml"
    soft.parent.mkdir()
    steel = Path("configs/materials/steel.yaml").read_text()
    soft.write_text(steel.replace("210.0", "7.0"))
    text = PUNCH.read_text().replace("material: steel", "material: ./below/soft.yaml")
    (tmp_path / "a.yaml").write_text(text)
    (tmp_path / "below" / "b.yaml").write_text("extends: ../a.yaml\nmaterial: sandstone\n")
    case = load_case(tmp_path / "below" / "b.yaml")
    assert (case.platens.material.young, case.material.young) == (7e9, 28e9)


def test_a_plate_between_free_sides_shortens_as_in_plane_strain():
    platens = load_case(PUNCH).platens
    assert platens.shortening(210e6) == pytest.approx(1e-3 * 10e-3 * (1 - 0.3**2))


@pytest.mark.parametrize(
    ("path", "overrides", "message"),
    [
        (
            PUNCH,
            {"contact": None},
            "platens: they touch the rock by contact, expected a section contact:",
        ),
        (
            PUNCH,
            {"platens": None},
            "platens: missing key, the scene punch is loaded by platens\n"
            "command line: contact.friction.rock-platen = 0.005: unknown surface 'platen', "
            "expected one of: rock",
        ),
        (
            TRIAXIAL,
            {**STEEL, "contact": {}},
            "platens: the scene triaxial has no platens, expected one of: plane_strain, punch, "
            "brazilian, hole",
        ),
        (
            PUNCH,
            {"platens.overhang_mm": -5},
            "platens.overhang_mm = -5: leaves nothing of a loaded face of 10 mm, expected above -5",
        ),
        (
            PLANE_STRAIN,
            {"scene.lateral_platens": True},
            "scene.lateral_platens = True: expected a section platens: that describes them",
        ),
        (
            PLANE_STRAIN,
            {**STEEL, "contact": {}, "scene.lateral_platens": True},
            "platens.overhang_mm = 0: the loading platens would run into the lateral ones, "
            "expected below 0",
        ),
        (
            PUNCH,
            {"loading.sense": "stretch"},
            "loading.sense = stretch: platens only push, expected shorten",
        ),
        (
            PUNCH,
            {"loading.lateral_stiffness_over_young": 0.02},
            "loading.lateral_stiffness_over_young = 0.02: the scene punch has no springs on its "
            "lateral platens, expected 0",
        ),
        (
            PUNCH,
            {"scene.strip_width_mm": 80},
            "scene: strip_width_mm = 80: expected below width_mm, 80",
        ),
    ],
)
def test_platens_that_do_not_fit_are_refused_in_one_sentence(path, overrides, message):
    said = refusal(path, overrides)
    said = said.replace(f"{path}: ", "command line: ")  # a key that is gone has no better file
    assert said == f"command line: {message}"
