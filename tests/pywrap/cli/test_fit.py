"""`lithofrac fit`: files written, words printed, inputs refused (own_rock.py)."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from lithofrac.cli import main
from lithofrac.config.material import Material

ZIGONG = "data/zigong/triaxial_strength.csv"
BASE = ["--base", "sandstone", "--set", "dilation_angle_deg=10"]
SIDECAR = """young_modulus_GPa: 20
poisson_ratio: 0.2
density_kg_m3: 2500
tensile_strength_MPa: 5
fracture_energy_J_m2: 80
dilation_angle_deg: 5
"""
no_core = pytest.mark.no_core


def made_curves(path: Path, lateral: bool = True) -> Path:
    """Straight to 100 + 4 p MPa at E = 20 GPa, then flat, swelling: one row fits them."""
    frames = []
    for p in (5.0, 20.0):
        strain = np.linspace(0.0, 0.02, 41)
        stress = np.minimum(p + 20e3 * strain, 100.0 + 4.0 * p)
        plastic = strain - (stress - p) / 20e3
        frame = {"confinement_MPa": p, "axial_strain": strain, "axial_stress_MPa": stress}
        if lateral:
            frame["lateral_strain"] = 0.2 * (strain - plastic) + 0.7 * plastic
        frames.append(pd.DataFrame(frame))
    pd.concat(frames).to_csv(path, index=False)
    return path


@no_core
def test_strengths_give_a_material_of_one_row_and_say_so(tmp_path, capsys):
    out = tmp_path / "new" / "rock.yaml"
    assert main(["fit", ZIGONG, *BASE, "--fit-on", "10", "30", "50", "70", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert said.startswith("a table of one row: strengths alone say nothing of hardening")
    assert "strengths predicted: rms 3.49 %, largest 5.34 % at 80 MPa" in said
    assert "\nnot given by the tests, from configs/materials/sandstone.yaml and --set: " in said
    rock = Material.load(out)
    assert rock.plastic_strain == (0.0,)
    assert rock.dilation_angle_deg == (10.0,)
    assert rock.cohesion_MPa[0] == pytest.approx(39.22, abs=0.01)
    assert "Not given by the tests, from configs/materials/sandstone.yaml and --set" in (
        out.read_text()
    )
    files = ["rock.svg", "rock.yaml", "rock_parameters.csv", "rock_residuals.csv"]
    assert sorted(path.name for path in out.parent.iterdir()) == files
    residuals = pd.read_csv(out.with_name("rock_residuals.csv"))
    assert list(residuals["role"]).count("predicted") == 4
    parameters = pd.read_csv(out.with_name("rock_parameters.csv"))
    assert (parameters["plus_minus"] > 0.0).all()


@no_core
def test_what_the_tests_do_not_give_may_stand_beside_them(tmp_path):
    tests = tmp_path / "mine.csv"
    tests.write_text("confinement_MPa,strength_MPa\n0,50\n10,90\n20,130\n")
    tests.with_suffix(".yaml").write_text(SIDECAR)
    out = tmp_path / "rock.yaml"
    assert main(["fit", str(tests), "--set", "density_kg_m3=2600.0", "--out", str(out)]) == 0
    rock = Material.load(out)
    assert (rock.young_modulus_GPa, rock.density_kg_m3) == (20.0, 2600.0)
    assert rock.friction_angle_deg[0] == pytest.approx(np.degrees(np.arcsin(0.6)), abs=1e-4)


@pytest.mark.parametrize("lateral", [True, False])
def test_curves_give_elastic_constants_and_rows(tmp_path, capsys, lateral):
    tests = made_curves(tmp_path / "tests.csv", lateral)
    out = tmp_path / "rock.yaml"
    words = [*BASE, "--knots", "0", "0.008", "--out", str(out)]
    assert main(["fit", str(tests), *words]) == 0
    assert "a table of 2 rows from curves" in capsys.readouterr().out
    rock = Material.load(out)
    assert rock.young_modulus_GPa == pytest.approx(20.0, rel=0.01)
    assert rock.friction_angle_deg == pytest.approx([np.degrees(np.arcsin(0.6))] * 2, abs=0.2)
    assert rock.cohesion_MPa == pytest.approx([25.0] * 2, abs=0.3)
    if lateral:
        assert rock.poisson_ratio == pytest.approx(0.2, abs=0.01)
        # Axial 1, lateral 0.7 each: 2 sin psi / (1 - sin psi) = 0.4.
        assert rock.dilation_angle_deg[1] == pytest.approx(np.degrees(np.arcsin(1 / 6)), abs=0.5)
    else:
        assert rock.dilation_angle_deg == (10.0, 10.0)


@no_core
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            [ZIGONG],
            "the tests do not give young_modulus_GPa, poisson_ratio, density_kg_m3, "
            "tensile_strength_MPa, fracture_energy_J_m2, dilation_angle_deg and no base was named, "
            "expected them in --base, in a .yaml beside the CSV, or by --set KEY=VALUE",
        ),
        (
            [ZIGONG, "--base", "steel"],
            "configs/materials/steel.yaml: elastic: not a key of a rock that is fitted, expected ",
        ),
        (
            [ZIGONG, "--base", "sandstone"],
            "configs/materials/sandstone.yaml: dilation_angle_deg has 8 values, but strengths alone"
            " give a table of one row, expected one, as by --set dilation_angle_deg=10",
        ),
        (
            [ZIGONG, *BASE, "--set", "density=3"],
            "configs/materials/sandstone.yaml and --set: density: not a key of a rock that is "
            "fitted, did you mean 'density_kg_m3'?",
        ),
        (
            [ZIGONG, *BASE, "--set", "dilation_angle_deg=much"],
            "configs/materials/sandstone.yaml and --set: dilation_angle_deg = much: expected a "
            "number or a list of numbers",
        ),
        (
            [ZIGONG, *BASE, "--set", "poisson_ratio=0.6"],
            "configs/materials/sandstone.yaml and --set: poisson_ratio = 0.6: expected a number "
            "not below 0 and below 0.5",
        ),
        (
            [ZIGONG, *BASE, "--fit-on", "10", "15"],
            "--fit-on 15: no test at that confinement, expected some of 10, 20, 30, 40, 50, 60, ",
        ),
        (
            [ZIGONG, *BASE, "--fit-on", "10"],
            "the tests to fit stand at one confinement (10 MPa), expected two or more to tell ",
        ),
        (
            [ZIGONG, *BASE, "--knots", "0", "0.01"],
            "--knots: strengths alone give one row, expected curves for more",
        ),
        (["lost.csv", *BASE], "lost.csv: no such file, expected triaxial tests as CSV"),
        ([ZIGONG, "--base", "granit"], "material 'granit': no such material, expected one of: "),
    ],
)
def test_bad_input_gets_one_sentence_and_writes_nothing(tmp_path, capsys, words, message):
    out = tmp_path / "rock.yaml"
    assert main(["fit", *words, "--out", str(out)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith(f"lithofrac: {message}")
    assert said.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@no_core
def test_curves_ask_for_rising_rows_and_a_file_that_ends_in_yaml(tmp_path, capsys):
    tests = made_curves(tmp_path / "tests.csv")
    words = ["fit", str(tests), *BASE]
    assert main([*words, "--knots", "0.01", "0", "--out", str(tmp_path / "rock.yaml")]) == 2
    assert capsys.readouterr().err == (
        "lithofrac: --knots 0.01 0: expected numbers not below 0, each above the one before\n"
    )
    assert main([*words, "--out", str(tmp_path / "rock.csv")]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --out {tmp_path / 'rock.csv'}: expected a file that ends in .yaml\n"
    )
    assert list(tmp_path.iterdir()) == [tests]
