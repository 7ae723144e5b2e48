"""Bad input: exit code 2, one sentence a mistake, nothing written (pywrap/lithofrac/cli.py)."""

from pathlib import Path

import pytest

from lithofrac.cli import main

TRIAXIAL = Path("configs/cases/sandstone_triaxial.yaml").read_text()
ROCK = Path("configs/materials/sandstone.yaml").read_text()


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("height_mm", "hight_mm", "scene.hight_mm: unknown key, did you mean 'height_mm'?"),
        ("title: Sandstone, triaxial compression\n", "", "title: missing key, expected a text"),
        ("speed_m_s: 0.1", "speed_m_s: fast", "loading.speed_m_s = fast: expected a number"),
        ("speed_m_s: 0.1", "speed_m_s: .nan", "loading.speed_m_s = nan: expected a finite number"),
        (
            "material: sandstone",
            "material: {extends: sandstone, young_modulus_GPa: -28}",
            "material.young_modulus_GPa = -28: expected a number from 1e-06 to 1e+07",
        ),
        (
            "element_size_mm: 0.5",
            "element_size_mm: 400",
            "scene.element_size_mm = 400: crack band width 400 mm of the largest element is not "
            "below the limit of 280 mm, 2 Gf E / ((1 + nu) ft^2), above which softening has no "
            "unique answer",
        ),
        (
            "material: sandstone",
            "material: sandston",
            "material 'sandston': no such material, did you mean 'sandstone'?",
        ),
        (
            "title: ",
            "title: a\ntitle: ",
            "line 4, column 1: key 'title' stands twice in one mapping",
        ),
    ],
    ids=["unknown", "missing", "type", "nan", "negative", "size", "material", "twice"],
)
def test_a_wrong_case_file(refused, tmp_path, old, new, message):
    path = tmp_path / "case.yaml"
    path.write_text(changed(TRIAXIAL, old, new))
    said = refused(path)
    if "height" in old:  # the right key is missing too
        missing = f"lithofrac: {path}: scene.height_mm: missing key, expected a number\n"
        said = changed(said, missing, "")
    assert said == f"lithofrac: {path}: {message}\n"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "poisson_ratio: 0.25",
            "poisson_ratio: 0.5",
            "material.poisson_ratio = 0.5: expected a number not below 0 and below 0.5",
        ),
        (
            "friction_angle_deg: [17.0",
            "friction_angle_deg: [90.0",
            "material.friction_angle_deg.0 = 90.0: expected a number below 90",
        ),
        (
            "plastic_strain: [0.0, 0.0005",
            "plastic_strain: [0.0, 0.0",
            "material.plastic_strain: expected values that increase strictly, got "
            "0, 0, 0.001, 0.0015, 0.002, 0.008, 0.01, 0.03",
        ),
        (
            "cohesion_MPa: [20.0, ",
            "cohesion_MPa: [",
            "material.cohesion_MPa: has 7 values, expected 8, as many as in plastic_strain",
        ),
    ],
    ids=["poisson", "friction", "order", "lengths"],
)
def test_a_wrong_material_file(refused, tmp_path, old, new, message):
    rock = tmp_path / "rock.yaml"
    rock.write_text(changed(ROCK, old, new))
    path = tmp_path / "case.yaml"
    path.write_text(changed(TRIAXIAL, "material: sandstone", "material: ./rock.yaml"))
    assert refused(path) == f"lithofrac: {rock}: {message}\n"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "file is empty, expected a YAML mapping"),
        (b"title: Kr\xfcger\n", "byte 9 is not UTF-8, expected a YAML file in UTF-8"),
        (b"title: [\n", "line 2, column 1: expected the node content, but found '<stream end>'"),
    ],
    ids=["empty", "encoding", "yaml"],
)
def test_a_file_that_is_no_case(refused, tmp_path, content, message):
    path = tmp_path / "case.yaml"
    path.write_bytes(content)
    assert refused(path) == f"lithofrac: {path}: {message}\n"


def test_a_missing_file_or_a_folder(refused, tmp_path):
    path = tmp_path / "case.yaml"
    assert refused(path) == f"lithofrac: {path}: no such file\n"
    path.mkdir()
    assert refused(path) == f"lithofrac: {path}: is a directory, expected a YAML file\n"


def test_a_name_that_the_suite_does_not_have(refused):
    assert refused("sandstone_triaxial_p1O") == (
        "lithofrac: configs/suite.yaml: cases.sandstone_triaxial_p1O: no such case, "
        "did you mean 'sandstone_triaxial_p10'?\n"
    )


def test_all_mistakes_of_a_file_come_one_a_line(refused, tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(TRIAXIAL.replace("speed_m_s: 0.1", "speed_m_s: -1").replace("30.0", "tall"))
    assert refused(path) == (
        f"lithofrac: {path}: scene.height_mm = tall: expected a number\n"
        f"lithofrac: {path}: loading.speed_m_s = -1: expected a number from 1e-09 to 10000\n"
    )


def test_a_wrong_override_is_named_as_such(refused, tmp_path):
    assert refused("kirsch", "--set", "scene.hole_radius_mm=0") == (
        "lithofrac: command line: scene.hole_radius_mm = 0: expected a number from 0.001 to 1e+07\n"
    )
    assert refused("kirsch", "--set", "radius") == "lithofrac: --set radius: expected KEY=VALUE\n"


@pytest.mark.parametrize(
    ("case", "key", "value", "expected"),
    [
        ("bar_wave", "material.density_kg_m3", "1e-300", "a number from 0.001 to 1e+06"),
        ("bar_wave", "material.young_modulus_GPa", "1e305", "a number from 1e-06 to 1e+07"),
        ("kirsch", "material.tensile_strength_MPa", "1e-300", "a number from 1e-06 to 1e+06"),
        ("bar_wave", "scene.height_mm", "1e-300", "a number from 0.001 to 1e+07"),
        ("bar_wave", "scene.height_mm", "1e300", "a number from 0.001 to 1e+07"),
        ("bar_wave", "scene.width_mm", "1e9", "a number from 0.001 to 1e+07"),
        ("bar_wave", "scene.element_size_mm", "1e-9", "a number from 0.001 to 1e+07"),
        ("sandstone_triaxial_p10", "loading.speed_m_s", "1e300", "a number from 1e-09 to 10000"),
        ("sandstone_triaxial_p10", "loading.end_strain", "1e300", "a number not below 1e-09 and"),
        ("sandstone_triaxial_p10", "loading.end_strain", "5.0", "a number not below 1e-09 and"),
        ("bar_wave", "mesh.seed", "99999999999999999999", "a whole number from 1 to 2147483647"),
    ],
)
def test_numbers_that_no_specimen_has(refused, case, key, value, expected):
    said = refused(case, "--set", f"{key}={value}")
    assert said.startswith(f"lithofrac: command line: {key} = ")
    assert f": expected {expected}" in said
    assert said.count("\n") == 1


@pytest.mark.parametrize(
    ("case", "key", "value"),
    [
        ("bar_wave", "scene.element_size_mm", "0.001"),
        ("sandstone_triaxial_p10", "scene.element_size_mm", "0.005"),
        ("kirsch", "scene.wall_elements_per_radius", "10000"),
    ],
)
def test_meshes_that_no_machine_holds(refused, case, key, value):
    far = ["--set", "scene.far_elements_per_radius=10000"] if case == "kirsch" else []
    said = refused(case, "--set", f"{key}={value}", *far)
    assert said.startswith(f"lithofrac: command line: {key} = {value}: about ")
    assert said.endswith(" elements, expected at most 2000000\n")


@pytest.mark.parametrize("hold", ["0", "5e-324"])
def test_run_that_takes_no_time(refused, hold):
    settings = ["--set", "loading.ramp_transits=0", "--set", f"loading.hold_transits={hold}"]
    assert refused("bar_wave", *settings) == (
        "lithofrac: bar_wave: loading: the run takes no time, expected at least one step\n"
    )


def test_platens_that_no_machine_holds(refused):
    assert refused("punch_gf60", "--set", "platens.thickness_mm=1e7") == (
        "lithofrac: configs/cases/punch.yaml: platens.element_size_over_rock = 2: about 1.9e+08 "
        "elements of platens, expected at most 2000000\n"
    )


@pytest.mark.parametrize(
    ("case", "key", "value"),
    [
        ("single_element_sandstone", "loading.speed_m_s", "1e-09"),
        ("bar_wave", "loading.hold_transits", "1e+06"),
    ],
)
def test_runs_that_never_end(refused, monkeypatch, case, key, value):
    monkeypatch.setattr("lithofrac.intake.MOST_STEPS", 1_000_000)
    said = refused(case, "--set", f"{key}={value}")
    assert said.startswith(f"lithofrac: {case}: {key} = {value}: the run takes ")
    assert said.endswith(" steps, expected at most 1000000\n")


def test_a_mesh_file_that_is_none(refused, tmp_path):
    path = tmp_path / "mesh.npz"
    path.write_text("no mesh")
    assert refused("kirsch", "--mesh", str(path)).startswith(
        f"lithofrac: {path}: expected a mesh of `lithofrac mesh` ("
    )


def test_nothing_to_resume(refused, tmp_path):
    out = tmp_path / "results"
    assert refused("kirsch", "--resume") == (
        f"lithofrac: {out / 'mesh.npz'}: no such file, there is no run to resume in {out}\n"
    )


def test_a_results_folder_that_cannot_be_written(tmp_path, capsys):
    file = tmp_path / "file"
    file.write_text("here")
    assert main(["run", "kirsch", "--out", str(file / "results")]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --out {file / 'results'}: cannot be written (Not a directory)\n"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_mesher_that_is_missing_is_no_bad_input(tmp_path, monkeypatch, capsys):
    from lithofrac.scenes import _gmsh

    monkeypatch.setattr(_gmsh.sys, "executable", str(tmp_path / "python"))
    monkeypatch.setenv("PATH", str(tmp_path))
    assert main(["mesh", "kirsch", "--out", str(tmp_path / "mesh.npz")]) == 3
    assert capsys.readouterr().err == (
        "lithofrac: gmsh is not installed: no program `gmsh` beside Python or on the path\n"
    )
