"""Materials (pywrap/lithofrac/config/material.py)."""

import numpy as np
import pytest

from lithofrac.config import ConfigError, Material

pytestmark = pytest.mark.no_core

ROCKS = ("quartzite", "sandstone", "tyndall_limestone")
ELASTIC = {
    "elastic": True,
    "young_modulus_GPa": 1.0,
    "poisson_ratio": 0.25,
    "density_kg_m3": 1000.0,
}


def sandstone(**changes) -> dict:
    """Keys of the sandstone, some of them changed."""
    keys = Material.load("sandstone").model_dump(mode="json", exclude_none=True) | changes
    return {key: value for key, value in keys.items() if value is not None}


def refusal(keys: dict) -> str:
    with pytest.raises(ConfigError) as caught:
        Material.from_values(keys, "rock.yaml")
    return str(caught.value)


def test_numbers_become_si():
    rock = Material.load("sandstone")
    assert (rock.young, rock.poisson, rock.density) == (28e9, 0.25, 2800.0)
    assert (rock.tensile_strength, rock.fracture_energy) == (4e6, 100.0)
    np.testing.assert_allclose(rock.table[:, 2], [1e-3, 18e6, np.radians(40.5), np.radians(11.5)])


@pytest.mark.parametrize(
    ("name", "peak_MPa", "at"),
    [
        ("quartzite", 175.3, 0.0015),
        ("sandstone", 100.2, 0.0015),
        ("tyndall_limestone", 42.6, 0.002),
    ],
)
def test_table_1_gives_the_known_uniaxial_peak(name, peak_MPa, at):
    strain, cohesion, friction, _ = Material.load(name).table
    strength = 2e-6 * cohesion * np.cos(friction) / (1 - np.sin(friction))
    assert strength.max() == pytest.approx(peak_MPa, abs=0.05)
    assert strain[strength.argmax()] == at


def test_options_are_in_the_order_of_the_core():
    assert Material.load("sandstone").options.tolist() == [0, 0, 1, 1]
    changed = Material(**sandstone(hardening="total", coupling="explicit", compression=False))
    assert changed.options.tolist() == [1, 1, 0, 1]
    assert Material(**ELASTIC).options.tolist() == [0, 0, 1, 0]


def test_materials_without_a_table_hand_over_zeros():
    assert Material(**ELASTIC).table.tolist() == [[0.0]] * 4
    columns = ("plastic_strain", "cohesion_MPa", "friction_angle_deg", "dilation_angle_deg")
    tension_only = sandstone(compression=False)
    for name in columns:
        del tension_only[name]
    assert Material(**tension_only).table.shape == (4, 1)


def test_quartzite_of_1_mm_needs_6_3_joule():
    just, short = sandstone(), sandstone()
    quartzite = Material.load("quartzite").model_dump(exclude_none=True)
    just, short = (Material(**quartzite | {"fracture_energy_J_m2": g}) for g in (6.3, 6.2))
    assert short.band_width_limit < 1e-3 < just.band_width_limit


def test_crack_band_is_the_leg_of_a_right_isosceles_triangle():
    assert Material(**sandstone()).band_width_of(0.5 * 3.0**2) == pytest.approx(3.0, rel=1e-15)
    assert Material(**sandstone(band_width="sqrt_A")).band_width_of(9.0) == 3.0


def test_a_material_is_found_by_name_and_by_path(tmp_path):
    text = "elastic: true\nyoung_modulus_GPa: 7\npoisson_ratio: 0.1\ndensity_kg_m3: 1000\n"
    (tmp_path / "materials").mkdir()
    (tmp_path / "materials" / "mine.yaml").write_text(text)
    assert Material.load("mine", beside=tmp_path).young == 7e9
    assert Material.load(tmp_path / "materials" / "mine.yaml").young == 7e9


def test_packaged_materials_are_found_from_any_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in (*ROCKS, "steel"):
        assert Material.load(name).young > 0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"young_modulus_GPa": -28.0}, "young_modulus_GPa = -28.0: expected a number above 0"),
        ({"poisson_ratio": 0.5}, "poisson_ratio = 0.5: expected a number below 0.5"),
        ({"density_kg_m3": float("nan")}, "density_kg_m3 = nan: expected a finite number"),
        ({"density_kg_m3": float("inf")}, "density_kg_m3 = inf: expected a finite number"),
        ({"density_kg_m3": "heavy"}, "density_kg_m3 = heavy: expected a number"),
        ({"density_kg_m3": True}, "density_kg_m3 = True: expected a number"),
        ({"densty": 1.0}, "densty: unknown key, did you mean 'density_kg_m3'?"),
        (
            {"friction_angle_deg": [17.0] * 7 + [90.0]},
            "friction_angle_deg.7 = 90.0: expected a number below 90",
        ),
        (
            {"plastic_strain": [0.0, 0.1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]},
            "plastic_strain: expected values that increase strictly, got "
            "0, 0.1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6",
        ),
        (
            {"cohesion_MPa": [20.0, 19.0]},
            "cohesion_MPa: has 2 values, expected 8, as many as in plastic_strain",
        ),
        ({"coupling": "implict"}, "coupling = implict: unknown word, did you mean 'implicit'?"),
        (
            {"tensile_strength_MPa": None},
            "tensile_strength_MPa: missing key, only a material with `elastic: true` may leave it "
            "out",
        ),
    ],
)
def test_a_wrong_key_is_refused_in_one_sentence(changes, message):
    assert refusal(sandstone(**changes)) == f"rock.yaml: {message}"


def test_all_mistakes_are_named_at_once():
    said = refusal(sandstone(young_modulus_GPa=0, poisson_ratio=1, cohesion_MPa=[-1.0]))
    assert [line.split()[1].rstrip(":") for line in said.splitlines()] == [
        "young_modulus_GPa",
        "poisson_ratio",
        "cohesion_MPa.0",
    ]


def test_half_a_table_is_refused():
    keys = ELASTIC | {"plastic_strain": [0.0]}
    assert refusal(keys) == (
        "rock.yaml: expected all of plastic_strain, cohesion_MPa, friction_angle_deg, "
        "dilation_angle_deg, or none"
    )


def test_an_unknown_name_gets_a_suggestion():
    with pytest.raises(ConfigError, match=r"^material 'sandston': no such material, did you mean"):
        Material.load("sandston")
