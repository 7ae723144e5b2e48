"""Study files (pywrap/lithofrac/config/study.py)."""

import re
from pathlib import Path

import pytest

from lithofrac.config import ConfigError, load_suite
from lithofrac.config.study import load_study

pytestmark = pytest.mark.no_core

CONFIGS = Path("configs")
STUDY = """\
title: Confinement
base: {base}
grid: {{loading.confinement_MPa: [0, 5], scene.element_size_mm: [0.5, 1]}}
quantities: [peak_stress_MPa]
plot: {{x: loading.confinement_MPa, y: [peak_stress_MPa], series: scene.element_size_mm}}
"""


@pytest.fixture
def study_of(tmp_path):
    """study_of(old, new, ...): the study above with words replaced."""

    def made(*pairs):
        text = STUDY.format(base=(CONFIGS / "cases" / "sandstone_triaxial.yaml").resolve())
        for old, new in zip(pairs[::2], pairs[1::2], strict=True):
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "study.yaml"
        path.write_text(text)
        return load_study(path)

    return made


@pytest.mark.parametrize(
    ("file", "pattern"), [("punch_gf", r"punch_gf\d+"), ("hole_size", r"hole_r\d\d\.\d(@seed\d)?")]
)
def test_studies_of_the_paper_are_the_cases_of_the_suite(file, pattern):
    study, suite = (
        load_study(CONFIGS / "studies" / f"{file}.yaml"),
        load_suite("configs/suite.yaml"),
    )
    assert study.names == [name for name in suite.names if re.fullmatch(pattern, name)]
    for name in study.names:
        assert study.case(name) == suite.case(name), name


def test_every_combination_of_a_grid_is_a_run(study_of):
    study = study_of()
    assert study.names == [
        f"confinement_MPa_{p}_element_size_mm_{h}" for p in (0, 5) for h in (0.5, 1)
    ]
    case = study.case("confinement_MPa_5_element_size_mm_1")
    assert (case.loading.confinement_MPa, case.scene.element_size_mm) == (5.0, 1.0)
    assert case.title == "Sandstone, triaxial compression"


def test_a_name_takes_keys_and_formats(study_of):
    name = "name: p{loading.confinement_MPa:02d}_h{scene.element_size_mm:.1f}\nquantities"
    assert study_of("quantities", name).names == ["p00_h0.5", "p00_h1.0", "p05_h0.5", "p05_h1.0"]


def test_a_number_that_no_format_takes_is_refused(study_of):
    name = "name: p{loading.confinement_MPa:.1f}\nquantities"
    with pytest.raises(ConfigError, match=r"MPa:\.1f\}: int too large to convert to float$"):
        study_of("quantities", name, "[0, 5]", f"[1{'0' * 400}]")


def test_realisations_are_other_meshes(study_of):
    study = study_of(
        "quantities", "realisations: 2\nquantities", "[0, 5]", "[5]", "[0.5, 1]", "[1]"
    )
    one = "confinement_MPa_5_element_size_mm_1"
    assert study.names == [one, f"{one}@seed2"]
    assert [study.case(name).mesh.seed for name in study.names] == [1, 2]
    assert study.overrides(f"{one}@seed2") == study.overrides(one)


def test_set_holds_in_all_runs_and_an_override_wins(study_of):
    study = study_of("grid", "set: {loading.end_strain: 0.01, loading.confinement_MPa: 9}\ngrid")
    for name in study.names:
        loading = study.case(name).loading
        assert loading.end_strain == 0.01
        assert loading.confinement_MPa == study.overrides(name)["loading.confinement_MPa"]


def test_nested_keys_are_columns_by_their_dotted_names(study_of):
    grid = "grid: {loading.confinement_MPa: [0, 5], scene.element_size_mm: [0.5, 1]}"
    study = study_of(
        grid,
        "cases: {a: {scene: {element_size_mm: 1}}, b: {loading.confinement_MPa: 2}}",
    )
    assert study.keys == ["scene.element_size_mm", "loading.confinement_MPa"]


GRID = "grid: {loading.confinement_MPa: [0, 5], scene.element_size_mm: [0.5, 1]}\n"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("title", "titel", "titel: unknown key, did you mean 'title'?"),
        (GRID, "", "grid, cases: expected one of the two"),
        (GRID, f"{GRID}cases: {{a: {{}}}}\n", "grid, cases: expected one of the two"),
        (
            "[0, 5]",
            "5",
            "grid.loading.confinement_MPa = 5: expected a list",
        ),
        (
            "[0, 5]",
            "[]",
            "grid.loading.confinement_MPa: expected a list of numbers, texts or switches; "
            "mappings and lists of values belong under cases",
        ),
        (
            "[0, 5]",
            "[5, 5]",
            "name: two runs of the grid are called confinement_MPa_5_element_size_mm_0.5, expected "
            "a name with all keys and no value twice: "
            "loading.confinement_MPa, scene.element_size_mm",
        ),
        (
            "quantities",
            "name: p{loading.confinement_MPa:0999999999}\nquantities",
            "name = p{loading.confinement_MPa:0999999999}: {loading.confinement_MPa:0999999999}: "
            "expected a width below 100",
        ),
        (
            "quantities",
            "name: ../p{loading.confinement_MPa}\nquantities",
            "name = ../p{loading.confinement_MPa}: gives '../p0', expected letters, digits and any "
            "of _ . -",
        ),
        (
            "quantities",
            "name: p{loading.confinment_MPa}\nquantities",
            "name = p{loading.confinment_MPa}: {loading.confinment_MPa} is no key of the grid, "
            "did you mean 'loading.confinement_MPa'?",
        ),
        (
            "quantities",
            "name: a/{loading.confinement_MPa}_{scene.element_size_mm}\nquantities",
            "name = a/{loading.confinement_MPa}_{scene.element_size_mm}: gives 'a/0_0.5', expected "
            "letters, digits and any of _ . -",
        ),
        (
            "x: loading.confinement_MPa",
            "x: confinement",
            "plot.x = confinement: no such column of the study, did you mean "
            "'loading.confinement_MPa'?",
        ),
        (
            "y: [peak_stress_MPa]",
            "y: [peak]",
            "plot.y.0 = peak: no such quantity of the study, expected one of: peak_stress_MPa",
        ),
        (
            "quantities",
            "realisations: 9999\nquantities",
            "realisations = 9999: expected a whole number from 1 to 1000",
        ),
        (
            "[0.5, 1]}",
            "[0.5, 1], mesh.seed: [1, 2]}\nrealisations: 2",
            "realisations = 2: expected 1 where mesh.seed is overridden",
        ),
    ],
    ids=lambda value: value[:24].strip() if isinstance(value, str) else None,
)
def test_a_wrong_study_says_file_key_value_and_what_was_expected(
    study_of, tmp_path, old, new, message
):
    with pytest.raises(ConfigError) as said:
        study_of(old, new)
    assert f"{tmp_path}/study.yaml: {message}" in str(said.value).splitlines()


def test_a_wrong_override_is_named_by_its_place_in_the_study(study_of, tmp_path):
    study = study_of("element_size_mm", "elementsize_mm")
    with pytest.raises(ConfigError) as said:
        study.case(study.names[0])
    assert str(said.value) == (
        f"{tmp_path}/study.yaml: grid: scene.elementsize_mm: unknown key, "
        "did you mean 'element_size_mm'?"
    )


def test_a_missing_base_is_named(study_of, tmp_path):
    study = study_of("sandstone_triaxial", "sandstone_biaxial")
    with pytest.raises(ConfigError, match=r"study.yaml: base = .*: no such file, expected "):
        study.case(study.names[0])
