"""Keys of a geometry of one's own (config/gmsh_file.py): defaults, and one sentence a mistake."""

import pytest

from lithofrac.config import ConfigError, load_case

pytestmark = pytest.mark.no_core

SCENE = {"kind": "gmsh_file", "file": "own.geo", "length_unit": "mm"}
PRESSED = {"kind": "boundaries", "held": {"bottom": "y"}, "pressed_MPa": {"top": 5}}
DRIVEN = {"kind": "boundaries", "driven": {"top": {"y_mm": -1}}, "speed_m_s": 0.1}


@pytest.fixture
def case_of(tmp_path):
    """case_of(scene=..., loading=..., ...): a case beside an empty own.geo and own.msh."""
    (tmp_path / "own.geo").write_text("")
    (tmp_path / "own.msh").write_text("")
    path = tmp_path / "own.yaml"
    path.write_text("title: Own\nmaterial: sandstone\n")

    def made(scene=SCENE, loading=PRESSED, **more):
        scene = scene | {"file": str(tmp_path / scene["file"])}
        return load_case(path, {"scene": scene, "loading": loading, **more})

    return made


def test_ways_are_in_metres_and_the_farthest_sets_the_time(case_of):
    loading = DRIVEN | {"driven": {"top": {"x_mm": 0, "y_mm": -1}, "left": {"x_mm": 4}}}
    found = case_of(loading=loading).loading
    assert found.driven["top"].components == {0: 0.0, 1: -1e-3}
    assert found.driven["left"].components == {0: 4e-3}
    assert found.farthest == 4e-3


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"scene": SCENE | {"file": "none.geo"}}, "scene.file: {folder}/none.geo: no such file"),
        (
            {"scene": SCENE | {"file": "own.yaml"}},
            "scene.file: {folder}/own.yaml: expected a file that ends in .geo or .msh",
        ),
        (
            {"scene": SCENE | {"length_unit": "inch"}},
            "scene.length_unit = inch: unknown word, expected one of: cm, m, mm",
        ),
        (
            {"scene": {"kind": "gmsh_file", "file": "own.geo"}},
            "scene.length_unit: missing key, expected one of: m, cm, mm",
        ),
        (
            {"scene": SCENE | {"materials": {"cap": "stel"}}},
            "material 'stel': no such material, did you mean 'steel'?",
        ),
        (
            {"scene": SCENE | {"materials": {"cap": {"extends": "steel", "poison_ratio": 0}}}},
            "scene.materials.cap.poison_ratio: unknown key, did you mean 'poisson_ratio'?",
        ),
        (
            {"scene": SCENE | {"file": "own.msh"}, "mesh": {"seed": 2}},
            "mesh.seed = 2: a .msh is one mesh, expected 1",
        ),
        (
            {"loading": {"kind": "velocity", "speed_m_s": 0.1, "end_strain": 0.01}},
            "loading.kind = velocity: the scene gmsh_file expects boundaries",
        ),
        (
            {"loading": {"kind": "boundaries", "held": {"bottom": "y"}}},
            "loading: driven: missing key, expected it or pressed_MPa: nothing is loaded",
        ),
        (
            {"loading": PRESSED | {"held": {"bottom": "z"}}},
            "loading.held.bottom = z: unknown word, expected one of: x, xy, y",
        ),
        (
            {"loading": PRESSED | {"speed_m_s": 1}},
            "loading: speed_m_s = 1: no curve is driven, expected driven or no speed",
        ),
        (
            {"loading": {"kind": "boundaries", "driven": {"top": {"y_mm": -1}}}},
            "loading: speed_m_s: missing key, expected a number where curves are driven",
        ),
        (
            {"loading": DRIVEN | {"driven": {"top": {}}}},
            "loading.driven.top: expected x_mm, y_mm or both",
        ),
        (
            {"loading": DRIVEN | {"driven": {"top": {"y_mm": 0}}}},
            "loading: driven: no curve goes anywhere, expected it under held",
        ),
        (
            {"loading": DRIVEN | {"driven": {"top": {"z_mm": 1}}}},
            "loading.driven.top.z_mm: unknown key, ",
        ),
        (
            {"loading": DRIVEN | {"axial": "bottom"}},
            "loading: axial = bottom: expected a curve that is driven along one axis",
        ),
        (
            {"fracture": {"mode": "inter_element"}},
            "fracture.mode = inter_element: faces of cracks need a section contact:, expected it "
            "or off",
        ),
    ],
)
def test_a_wrong_key_is_refused_in_one_sentence(case_of, tmp_path, given, message):
    with pytest.raises(ConfigError) as caught:
        case_of(**given)
    said = str(caught.value)
    assert said.startswith("command line: " + message.format(folder=tmp_path))
    assert "\n" not in said


def test_boundaries_belong_to_geometries_of_ones_own(tmp_path):
    path = tmp_path / "bar.yaml"
    path.write_text("title: Bar\nmaterial: steel\n")
    bar = {"kind": "bar", "height_mm": 10, "width_mm": 2, "element_size_mm": 1}
    with pytest.raises(ConfigError, match="the scene bar has none, expected gmsh_file"):
        load_case(path, {"scene": bar, "loading": PRESSED})


def test_platens_have_no_place(case_of):
    with pytest.raises(ConfigError, match=r"platens: the scene gmsh_file has none but its own"):
        case_of(platens={"material": "steel", "thickness_mm": 1})


def test_an_elastic_case_may_crack_in_another_body(case_of):
    scene = SCENE | {"materials": {"reef": "sandstone"}}
    cracks = {"contact": {}, "fracture": {"mode": "inter_element"}}
    assert case_of(scene, material="steel", **cracks).fracture.on
    with pytest.raises(ConfigError, match="the material is elastic"):
        case_of(material="steel", **cracks)
