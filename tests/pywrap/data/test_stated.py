"""Values that are stated or measured elsewhere: whole, sourced, and the same as the configs."""

import numpy as np
import pandas as pd
import pytest

from lithofrac.config.material import Material
from lithofrac.data import DataError, measured_strength

pytestmark = pytest.mark.no_core
TABLE = ["plastic_strain", "cohesion_MPa", "friction_angle_deg", "dilation_angle_deg"]
SCENE = {"quartzite": "punch", "sandstone": "sandstone", "tyndall_limestone": "hole"}
STATED = {
    "young_modulus": "young_modulus_GPa",
    "poisson_ratio": "poisson_ratio",
    "density": "density_kg_m3",
    "tensile_strength": "tensile_strength_MPa",
    "gf": "fracture_energy_J_m2",
}


@pytest.mark.parametrize("rock", SCENE)
def test_material_of_a_config_is_the_rock_of_the_paper(data_folder, rock):
    material = Material.load(data_folder.parent / "configs" / "materials" / f"{rock}.yaml")
    table = pd.read_csv(data_folder / "klerck2004" / "table1.csv")
    table = table[table["rock"] == rock]
    for column in TABLE:
        np.testing.assert_array_equal(getattr(material, column), table[column])
    stated = pd.read_csv(data_folder / "klerck2004" / "parameters.csv")
    stated = stated[stated["scene"] == SCENE[rock]].set_index("quantity")["value"].dropna()
    for quantity, key in STATED.items():
        if quantity in stated:
            assert getattr(material, key) == float(stated[quantity]), quantity


def test_every_stated_value_names_its_place_in_the_paper(data_folder):
    for name in ("table1", "parameters", "claims", "figure_axes"):
        table = pd.read_csv(data_folder / "klerck2004" / f"{name}.csv")
        assert table["source"].str.contains(r"Table|section|Fig\.").all(), name


def test_every_source_has_a_page_that_cites_it(data_folder):
    folders = [path for path in data_folder.iterdir() if path.is_dir()]
    assert len(folders) == 3
    for folder in folders:
        text = (folder / "README.md").read_text()
        assert "Source:" in text
        assert "Licence:" in text


def test_measured_means_lie_within_their_range(data_folder):
    table = measured_strength(data_folder, "tautona")
    assert (table["strength_min_MPa"] < table["strength_MPa"]).all()
    assert (table["strength_MPa"] < table["strength_max_MPa"]).all()
    assert list(table["tests"]) == [4, 2, 4, 3, 4]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("confinement_MPa\n1\n", "column 'strength_MPa' is missing, expected confinement_MPa,"
         " strength_MPa at least"),
        ("confinement_MPa,strength_MPa\n1,2\n3,many\n", "line 3, column 'strength_MPa': 'many',"
         " expected a finite number"),
        ("confinement_MPa,strength_MPa\n1,\n", "line 2, column 'strength_MPa': 'nan', expected a"
         " finite number"),
    ],
)  # fmt: skip
def test_bad_table_is_refused_by_line_and_column(tmp_path, text, words):
    (tmp_path / "rock").mkdir()
    (tmp_path / "rock" / "triaxial_strength.csv").write_text(text)
    with pytest.raises(DataError) as caught:
        measured_strength(tmp_path, "rock")
    assert str(caught.value).endswith(words)


def test_missing_table_is_refused(tmp_path):
    with pytest.raises(DataError, match="no such file, expected measured strengths"):
        measured_strength(tmp_path, "rock")
