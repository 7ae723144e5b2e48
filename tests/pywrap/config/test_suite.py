"""Suites (pywrap/lithofrac/config/suite.py and configs/suite*.yaml)."""

from pathlib import Path

import pytest

from lithofrac.config import ConfigError, find_case, load_suite

pytestmark = pytest.mark.no_core

SUITE, QUICK = Path("configs/suite.yaml"), Path("configs/suite_quick.yaml")
CONFINEMENTS = (0, 5, 10, 20, 30)


@pytest.mark.parametrize("path", [SUITE, QUICK], ids=lambda path: path.stem)
def test_every_case_is_right(path):
    suite = load_suite(path)
    for name in suite.cases:
        assert suite.case(name).title


def test_the_suite_has_the_sandstone_at_all_confinements():
    suite = load_suite(SUITE)
    for p in CONFINEMENTS:
        assert suite.case(f"sandstone_triaxial_p{p:02d}").loading.confinement == p * 1e6
        for tag, k in (("", 0.02), ("k02_", 0.02), ("k01_", 0.01), ("k05_", 0.05)):
            case = suite.case(f"sandstone_plane_strain_{tag}p{p:02d}")
            loading = case.loading
            assert (loading.confinement, loading.lateral_stiffness_over_young) == (p * 1e6, k)
            assert case.fracture.on == case.scene.lateral_platens == (tag == "")
        soft = suite.case(f"sandstone_soft_p{p:02d}")
        assert (soft.loading.confinement, soft.scene.lateral_platens) == (p * 1e6, False)
        assert soft.fracture.on


def test_the_suite_has_the_punch_with_and_without_cracks():
    suite = load_suite(SUITE)
    found = {name: suite.case(f"punch_{name}") for name in ("gf60", "gf300", "gf1200")}
    for name, case in found.items():
        assert case.material.fracture_energy == float(name.removeprefix("gf"))
        assert case.contact is not None
        assert not case.fracture.on
    discrete, tension = suite.case("punch_discrete"), suite.case("punch_tension_only")
    assert discrete.fracture.mode == tension.fracture.mode == "inter_element"
    assert (discrete.material.compression, tension.material.compression) == (True, False)
    assert discrete.material == found["gf60"].material


def test_the_quick_suite_has_every_scene_of_the_suite():
    def kinds(path):
        suite = load_suite(path)
        return {suite.case(name).scene.kind for name in suite.cases}

    assert kinds(QUICK) == kinds(SUITE)
    assert set(load_suite(QUICK).cases) <= set(load_suite(SUITE).cases)


def test_a_seed_after_the_name_is_another_realisation():
    assert find_case("kirsch@seed3").mesh.seed == 3
    assert find_case("kirsch").mesh.seed == 1


def test_realisations_are_runs_of_their_own():
    names = load_suite(SUITE).names
    assert [name for name in names if name.startswith("hole_r16.3")] == [
        "hole_r16.3",
        "hole_r16.3@seed2",
        "hole_r16.3@seed3",
    ]
    assert len(names) == len(set(names))
    assert find_case(names[-1]).mesh.seed == 1


def test_null_tests_of_the_size_effect_differ_in_scale_alone():
    """Everything that has a length is in proportion to the radius, Gf as well."""
    base = find_case("hole_r25.0")
    for radius in (1.6, 6.4):
        case, scale = find_case(f"hole_null_r{radius:04.1f}"), radius / 25.0
        assert case.material.fracture_energy == pytest.approx(scale * base.material.fracture_energy)
        for value in ("radius", "wall_size", "element_size", "height"):
            assert getattr(case.scene, value) == pytest.approx(scale * getattr(base.scene, value))
        assert case.platens.thickness == pytest.approx(scale * base.platens.thickness)
        assert case.platens.overhang == pytest.approx(scale * base.platens.overhang)
        assert (case.loading, case.damping) == (base.loading, base.damping)


def test_a_case_is_found_by_name_or_by_file():
    by_name = find_case("sandstone_triaxial_p05")
    by_file = find_case(
        "configs/cases/sandstone_triaxial.yaml", None, {"loading.confinement_MPa": 5}
    )
    assert by_name == by_file


def test_the_installed_suite_serves_any_folder(tmp_path, monkeypatch):
    here = find_case("kirsch")
    monkeypatch.chdir(tmp_path)
    assert find_case("kirsch") == here


def refusal(path, text, name="a") -> str:
    path.write_text(text)
    with pytest.raises(ConfigError) as caught:
        load_suite(path).case(name)
    return str(caught.value)


def test_mistakes_are_named_with_the_entry(tmp_path):
    path = tmp_path / "s.yaml"
    case = Path("configs/cases/kirsch.yaml").resolve()
    head = "title: t\ncases:\n"
    assert refusal(path, head + f"  a: {{extends: {case}, set: {{scene.radius: 3}}}}") == (
        f"{path}: cases.a.set: scene.radius: unknown key, did you mean 'hole_radius_mm'?"
    )
    assert refusal(path, head + "  a: {extends: b}") == (
        f"{path}: cases.a.extends = b: no such file, expected {tmp_path / 'b.yaml'}"
    )
    assert refusal(path, head + f"  b: {{extends: {case}}}") == (
        f"{path}: cases.a: no such case, expected one of: b"
    )
    assert refusal(path, head + "  a: {}") == (
        f"{path}: cases.a.extends: missing key, expected a text"
    )
    assert refusal(path, "title: t\ncases: {}") == (
        f"{path}: cases: expected at least this many items: 1"
    )
    assert "cases.a/b" in refusal(path, head + "  a/b: {extends: c}")


def test_a_twin_is_another_case_of_the_suite(tmp_path):
    path = tmp_path / "s.yaml"
    case = Path("configs/cases/kirsch.yaml").resolve()
    head = f"title: t\ncases:\n  a: {{extends: {case}}}\n"
    path.write_text(head + f"  b: {{extends: {case}, twin: a}}\n")
    assert load_suite(path).variants == {"b": "a"}
    for twin in ("c", "b"):
        said = refusal(path, head + f"  b: {{extends: {case}, twin: {twin}}}\n")
        assert f"cases.b.twin = {twin}: expected another case of the suite" in said


def test_every_variant_of_the_suite_differs_from_its_twin_in_what_its_name_says():
    suite = load_suite("configs/suite.yaml")
    assert suite.variants
    for name, twin in suite.variants.items():
        one, other = suite.case(name), suite.case(twin)
        assert one.model_dump(exclude={"title"}) != other.model_dump(exclude={"title"}), name
        assert one.scene.kind == other.scene.kind


@pytest.mark.parametrize("name", ["a/../../b", "-a", "a b", "é"])
def test_a_name_that_is_no_folder_is_refused_with_what_it_may_hold(tmp_path, name):
    file = tmp_path / "suite.yaml"
    file.write_text(f"title: A\ncases:\n  {name}: {{extends: bar}}\n", encoding="utf-8")
    with pytest.raises(ConfigError, match="expected a name of letters, digits and any of _"):
        load_suite(file)
