"""Cases: extending, overriding, refusing (pywrap/lithofrac/config/case.py and extend.py)."""

from pathlib import Path

import pytest
import yaml

from lithofrac.config import ConfigError, load_case
from lithofrac.config.setting import settings, text_of

pytestmark = pytest.mark.no_core

TRIAXIAL = Path("configs/cases/sandstone_triaxial.yaml")
CASES = sorted(Path("configs/cases").glob("*.yaml"))


def refusal(path: Path, overrides: dict | None = None) -> str:
    with pytest.raises(ConfigError) as caught:
        load_case(path, overrides)
    return str(caught.value)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_case_written_back_is_the_same_case(path, tmp_path):
    case = load_case(path)
    (tmp_path / "back.yaml").write_text(text_of(case))
    assert load_case(tmp_path / "back.yaml") == case


def test_the_triaxial_case_says_what_the_paper_says():
    case = load_case(TRIAXIAL)
    assert case.scene.element_size == 0.5e-3
    assert (case.scene.height, case.scene.radius) == (30e-3, 5e-3)
    assert case.loading.speed == 0.1
    assert case.damping.fraction == 0.3


def test_overrides_replace_single_keys_dotted_or_nested():
    dotted = load_case(TRIAXIAL, {"loading.confinement_MPa": 10, "mesh.seed": 3})
    nested = load_case(TRIAXIAL, {"loading": {"confinement_MPa": 10}, "mesh": {"seed": 3}})
    assert dotted == nested
    assert dotted.loading.confinement == 10e6
    assert dotted.loading.end_strain == load_case(TRIAXIAL).loading.end_strain


def test_a_case_extends_another_by_name_or_path_over_several_files(tmp_path):
    (tmp_path / "a.yaml").write_text(TRIAXIAL.read_text())
    (tmp_path / "b.yaml").write_text("extends: a\ntitle: B\nloading: {confinement_MPa: 5}\n")
    (tmp_path / "c.yaml").write_text("extends: ./b.yaml\ntitle: C\n")
    case = load_case(tmp_path / "c.yaml")
    assert (case.title, case.loading.confinement_MPa, case.scene.height_mm) == ("C", 5.0, 30.0)


def test_another_kind_replaces_the_whole_section():
    scene = {"kind": "bar", "height_mm": 10.0, "width_mm": 1.0, "element_size_mm": 1.0}
    case = load_case(TRIAXIAL, {"scene": scene})
    assert case.scene.kind == "bar"
    assert not hasattr(case.scene, "diameter_mm")


def test_a_material_may_differ_in_single_keys_from_a_named_one():
    case = load_case(TRIAXIAL, {"material.coupling": "explicit"})
    assert (case.material.coupling, case.material.young) == ("explicit", 28e9)
    other = load_case(TRIAXIAL, {"material.extends": "quartzite"})
    assert other.material.young == 68e9


def test_command_line_words_are_read_as_yaml():
    words = ["a.b=1e-3", "c=[1, 2]", "d=text", "e="]
    assert settings(words) == {"a.b": 1e-3, "c": [1, 2], "d": "text", "e": None}
    with pytest.raises(ConfigError, match=r"^--set a: expected KEY=VALUE$"):
        settings(["a"])


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (
            {"scene.elment_size_mm": 1},
            "scene.elment_size_mm: unknown key, did you mean 'element_size_mm'?",
        ),
        (
            {"velocity": 1},
            "velocity: unknown key, expected one of: budget_element_steps, contact, damping, "
            "fracture, guards, loading, material, mesh, output, platens, probes, scene, "
            "time_step_factor, title",
        ),
        ({"loading.speed_m_s": "fast"}, "loading.speed_m_s = fast: expected a number"),
        (
            {"loading.end_strain": float("nan")},
            "loading.end_strain = nan: expected a finite number",
        ),
        ({"scene.kind": "triaxal"}, "scene.kind = triaxal: unknown kind, did you mean 'triaxial'?"),
        ({"mesh.seed": 1.5}, "mesh.seed = 1.5: expected a whole number"),
        ({"mesh.seed": 0}, "mesh.seed = 0: expected a whole number from 1 to 2147483647"),
        ({"scene": 3}, "scene = 3: expected a mapping of keys"),
        ({"title": None}, "title: expected a text"),
        (
            {"material": "sandstne"},
            "material 'sandstne': no such material, did you mean 'sandstone'?",
        ),
        (
            {"material.young_modulus_GPa": -1},
            "material.young_modulus_GPa = -1: expected a number from 1e-06 to 1e+07",
        ),
        ({"probes.gauge": {"x_mm": 1}}, "probes.gauge.y_mm: missing key, expected a number"),
        (
            {"damping.relative_to": "air"},
            "damping.relative_to = air: unknown word, expected one of: affine, ground",
        ),
    ],
)
def test_a_wrong_key_is_refused_in_one_sentence(overrides, message):
    assert refusal(TRIAXIAL, overrides) == f"command line: {message}"


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (
            {"scene.element_size_mm": 280},
            "scene.element_size_mm = 280: crack band width 280 mm of the largest element is not "
            "below the limit of 280 mm, 2 Gf E / ((1 + nu) ft^2), above which softening has no "
            "unique answer",
        ),
        (
            {"loading.lateral_stiffness_over_young": 0.1},
            "loading.lateral_stiffness_over_young = 0.1: the scene triaxial has no lateral "
            "platens, expected 0",
        ),
        (
            {"loading": {"kind": "traction", "stress_MPa": 1}},
            "loading.kind = traction: the scene triaxial is loaded by velocity only",
        ),
        (
            {"loading.sense": "stretch", "loading.confinement_MPa": 5},
            "loading.sense = stretch: the ends cannot follow a confinement first, expected shorten",
        ),
    ],
)
def test_parts_that_do_not_fit_together_are_refused(overrides, message):
    assert refusal(TRIAXIAL, overrides) == f"command line: {message}"


def test_a_mistake_is_named_with_the_file_it_stands_in(tmp_path):
    (tmp_path / "a.yaml").write_text(
        TRIAXIAL.read_text().replace("height_mm: 30.0", "height_mm: 0")
    )
    (tmp_path / "b.yaml").write_text("extends: a\ntitle: 7\nmesh: {sed: 2}\n")
    assert refusal(tmp_path / "b.yaml").splitlines() == [
        f"{tmp_path / 'b.yaml'}: title = 7: expected a text",
        f"{tmp_path / 'a.yaml'}: scene.height_mm = 0: expected a number from 0.001 to 1e+07",
        f"{tmp_path / 'b.yaml'}: mesh.sed: unknown key, did you mean 'seed'?",
    ]


def test_missing_keys_are_named_with_what_belongs_there(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text("scene: {}\n")
    assert refusal(path).splitlines() == [
        f"{path}: title: missing key, expected a text",
        f"{path}: material: missing key, expected the name of a material, or its keys",
        f"{path}: scene.kind: missing key, expected a text",
        f"{path}: loading: missing key, expected a mapping of keys",
    ]


def test_files_that_extend_themselves_or_nothing_are_refused(tmp_path):
    a, b = tmp_path / "a.yaml", tmp_path / "b.yaml"
    a.write_text("extends: b\n")
    b.write_text("extends: a\n")
    assert refusal(a) == f"{b}: extends = a: the file extends itself"
    a.write_text("extends: c\n")
    assert refusal(a) == f"{a}: extends = c: no such file, looked for {tmp_path / 'c.yaml'}"
    a.write_text("extends: /\n")
    assert refusal(a) == f"{a}: extends = /: no such file, looked for /.yaml"
    a.write_text('extends: "b\\0c"\n')
    assert refusal(a).startswith(f"{a}: extends = b\\x00c: no such file, looked for ")
    a.write_text("extends: 3\n")
    assert refusal(a) == f"{a}: extends: expected a text, the file that is extended"


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_speeds_and_ramps_are_marked_as_choices_where_the_paper_is_silent(path):
    values = yaml.safe_load(path.read_text())
    if "ramp_transits" in values.get("loading", {}) and path.stem != "bar":
        line = next(x for x in path.read_text().splitlines() if "ramp_transits" in x)
        assert "# choice" in line
