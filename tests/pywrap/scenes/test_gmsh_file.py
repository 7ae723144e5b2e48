"""Geometries of one's own: meshes, groups, loads and what is refused (scenes/gmsh_file.py)."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from lithofrac.config import ConfigError, find_case, load_case
from lithofrac.config.setting import text_of
from lithofrac.scenes import _gmsh, hole_quarter, make_mesh, make_problem

pytestmark = pytest.mark.no_core

SQUARE = """\
Point(1) = {0, 0, 0, 3};
Point(2) = {10, 0, 0, 3};
Point(3) = {10, 20, 0, 3};
Point(4) = {0, 20, 0, 3};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
"""
GROUPS = """\
Physical Surface("rock") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
"""
CAP = """\
Point(5) = {10, 25, 0, 3};
Point(6) = {0, 25, 0, 3};
Line(5) = {3, 5};
Line(6) = {5, 6};
Line(7) = {6, 4};
Curve Loop(2) = {-3, 5, 6, 7};
Plane Surface(2) = {2};
Physical Surface("cap") = {2};
Physical Curve("back") = {6};
"""
APART = """\
Point(13) = {10, 20, 0, 3};
Point(14) = {0, 20, 0, 3};
Point(5) = {10, 25, 0, 3};
Point(6) = {0, 25, 0, 3};
Line(13) = {13, 14};
Line(5) = {13, 5};
Line(6) = {5, 6};
Line(7) = {6, 14};
Curve Loop(2) = {-13, 5, 6, 7};
Plane Surface(2) = {2};
Physical Surface("cap") = {2};
Physical Curve("back") = {6};
"""
CASE = """\
title: Own
material: sandstone
scene: {kind: gmsh_file, file: own.geo, length_unit: mm}
loading: {kind: boundaries, held: {bottom: y}, pressed_MPa: {top: 5}}
"""


@pytest.fixture
def case_of(tmp_path):
    """case_of(geo, case=CASE, key=value...): a case and its file beside each other."""

    def made(geo, case=CASE, name="own.geo", **overrides):
        (tmp_path / name).write_text(geo)
        (tmp_path / "own.yaml").write_text(case)
        keys = {key.replace("__", "."): value for key, value in overrides.items()}
        return load_case(tmp_path / "own.yaml", keys)

    return made


@pytest.fixture
def refused(case_of):
    """refused(geo, ...): what is said of a file, without its name."""

    def attempt(geo, *more, **overrides):
        case = case_of(geo, *more, **overrides)
        with pytest.raises(ConfigError) as caught:
            make_problem(case, make_mesh(case))
        return str(caught.value).removeprefix(f"scene.file = {case.scene.file}: ")

    return attempt


def by_gmsh(geo, path, *options):
    """Mesh a text by hand, as a user would."""
    script = path.with_suffix(".by_hand.geo")
    script.write_text(geo)
    done = subprocess.run(
        [*_gmsh._gmsh(), script, "-2", "-o", path, "-v", "2", *options], capture_output=True
    )
    assert done.returncode == 0


def same(a, b):
    assert np.array_equal(a.nodes, b.nodes)
    assert np.array_equal(a.triangles, b.triangles)
    assert np.array_equal(a.body, b.body)
    assert a.body_names == b.body_names
    assert a.edge_sets.keys() == b.edge_sets.keys()
    assert all(np.array_equal(a.edge_sets[name], b.edge_sets[name]) for name in a.edge_sets)


def test_physical_groups_are_bodies_and_boundaries(case_of):
    mesh = make_mesh(case_of(SQUARE + GROUPS + CAP))
    assert mesh.body_names == ("rock", "cap")
    areas = [1e6 * mesh.areas()[mesh.body == i].sum() for i in (0, 1)]
    assert areas == pytest.approx([200.0, 50.0], rel=1e-12)
    assert set(mesh.edge_sets) == {"bottom", "right", "top", "back"}
    assert mesh.nodes[mesh.nodes_of("back"), 1] == pytest.approx(25e-3, rel=1e-15)
    sides = {(int(t[i]), int(t[(i + 1) % 3])) for t in mesh.triangles for i in range(3)}
    assert {tuple(edge) for edge in mesh.edge_sets["right"].tolist()} <= sides


def test_bodies_share_the_nodes_of_shared_curves_and_no_others(case_of):
    for text, shared in ((CAP, True), (APART, False)):
        mesh = make_mesh(case_of(SQUARE + GROUPS + text))
        rock, cap = (np.unique(mesh.triangles[mesh.body == i]) for i in (0, 1))
        both = np.intersect1d(rock, cap)
        assert np.array_equal(both, mesh.nodes_of("top") if shared else [])


@pytest.mark.parametrize(("unit", "height"), [("mm", 20e-3), ("cm", 0.2), ("m", 20.0)])
def test_lengths_are_in_the_unit_that_is_named(case_of, unit, height):
    mesh = make_mesh(case_of(SQUARE + GROUPS, scene__length_unit=unit))
    assert np.ptp(mesh.nodes[:, 1]) == pytest.approx(height, rel=1e-15)


@pytest.mark.parametrize(
    "options", [("-format", "msh22"), ("-format", "msh41"), ("-format", "msh41", "-bin")]
)
def test_a_mesh_file_is_read_as_it_is(case_of, tmp_path, options):
    whole = make_mesh(case_of(SQUARE + GROUPS + CAP))
    geo = "Mesh.Algorithm = 6;\nMesh.Smoothing = 10;\n" + SQUARE + GROUPS + CAP
    case = case_of("", CASE.replace("own.geo", "own.msh"), name="own.msh")
    by_gmsh(geo, tmp_path / "own.msh", *options)
    read = make_mesh(case)
    if "msh22" in options:
        same(read, whole)
    assert read.areas().sum() == pytest.approx(whole.areas().sum(), rel=1e-12)
    assert read.edge_sets["top"].shape == whole.edge_sets["top"].shape


def test_a_curve_in_two_groups_needs_format_2(case_of, tmp_path):
    """meshio keeps one group of each curve of format 4."""
    case = case_of("", CASE.replace("own.geo", "own.msh"), name="own.msh")
    geo = SQUARE + GROUPS + 'Physical Curve("ends") = {1, 3};\n'
    by_gmsh(geo, tmp_path / "own.msh", "-format", "msh22")
    sets = make_mesh(case).edge_sets
    both = np.concatenate([sets["bottom"], sets["top"]])
    assert np.array_equal(np.unique(sets["ends"], axis=0), np.unique(both, axis=0))
    by_gmsh(geo, tmp_path / "own.msh", "-format", "msh41")
    with pytest.raises(ConfigError, match=r"is empty; in format 4 .* expected format 2\.2$"):
        make_mesh(case)


def test_a_mesh_file_has_one_realisation(case_of, tmp_path):
    case = case_of("", CASE.replace("own.geo", "own.msh"), name="own.msh")
    by_gmsh(SQUARE + GROUPS, tmp_path / "own.msh")
    with pytest.raises(ConfigError, match=r"^mesh\.seed = 2: a \.msh is one mesh, expected 1$"):
        make_mesh(case, 2)


def test_a_built_in_scene_written_as_a_geo_has_the_same_bits(case_of, monkeypatch):
    written = []
    monkeypatch.setattr(
        hole_quarter, "mesh_from", lambda geo: written.append(geo) or _gmsh.mesh_from(geo)
    )
    built_in = find_case("kirsch")
    mesh = make_mesh(built_in)
    head = "".join(line for line in _gmsh.HEAD.splitlines(True) if "General" not in line)
    loading = """\
loading:
  kind: boundaries
  held: {bottom: y, left: x}
  pressed_MPa: {top: 1.0}
  ramp_transits: 40  # of half the height of the block
  hold_transits: 80
"""
    text = CASE.split("loading")[0] + loading
    material = {"extends": "tyndall_limestone", "elastic": True}
    own = case_of(head + written[0], text, scene__length_unit="m", material=material)
    same(make_mesh(own), mesh)
    a, b = make_problem(own, mesh), make_problem(built_in, mesh)
    assert (a.end_time, a.damping, a.materials) == (b.end_time, b.damping, b.materials)
    for own_load, load in zip(a.pressure_loads, b.pressure_loads, strict=True):
        assert np.array_equal(own_load.edges, load.edges)
        assert (own_load.pressure, own_load.ramp) == (load.pressure, load.ramp)
    for own_load, load in zip(a.velocity_loads, b.velocity_loads, strict=True):
        assert np.array_equal(own_load.nodes, load.nodes)
        assert (own_load.component, own_load.speed) == (load.component, load.speed)


def test_a_seed_gives_always_the_same_mesh_and_another_seed_another_one(case_of):
    fine = SQUARE.replace("0, 3}", "0, 0.8}") + GROUPS
    case = case_of(fine)
    first, second = make_mesh(case), make_mesh(case, 2)
    same(make_mesh(case), first)
    same(make_mesh(case, 2), second)
    alike = len(first.nodes) == len(second.nodes) and np.allclose(first.nodes, second.nodes)
    assert not alike
    assert len(second.triangles) == pytest.approx(len(first.triangles), rel=0.08)


def test_loads_are_held_pressed_and_driven_in_turn(case_of):
    loading = """\
loading:
  kind: boundaries
  held: {bottom: xy}
  pressed_MPa: {right: 5}
  driven: {top: {x_mm: 0.05, y_mm: -0.1}}
  speed_m_s: 0.02
  ramp_transits: 10
"""
    case = case_of(SQUARE + GROUPS, CASE.split("loading")[0] + loading)
    problem = make_problem(case, make_mesh(case))
    loads = {load.name: load for load in problem.velocity_loads}
    assert set(loads) == {"bottom_x", "bottom_y", "top_x", "top_y"}
    speeds = {name: load.speed for name, load in loads.items()}
    assert speeds == {"bottom_x": 0.0, "bottom_y": 0.0, "top_x": 0.01, "top_y": -0.02}
    (pressure,) = problem.pressure_loads
    ramp = 10 * 20e-3 / case.material.wave_speed
    assert (pressure.pressure, pressure.ramp.start) == (5e6, 0.0)
    assert pressure.ramp.duration == pytest.approx(ramp, rel=1e-12)
    start = loads["top_y"].ramp.start
    assert start == pressure.ramp.duration
    assert problem.end_time == pytest.approx(start + ramp / 2 + 0.1e-3 / 0.02, rel=1e-12)
    assert problem.measures is None


def test_the_axial_measure_is_that_of_the_named_curve(case_of):
    driven = {"driven": {"top": {"x_mm": 0, "y_mm": -0.1}}, "speed_m_s": 0.02, "axial": "top"}
    loading = {"kind": "boundaries", "held": {"bottom": "xy"}, **driven}
    keys = {"scene__materials": {"cap": "steel"}, "contact": {}}
    case = case_of(SQUARE + GROUPS + APART, loading=loading, **keys)
    measures = make_problem(case, make_mesh(case)).measures
    assert measures.axial_load == "top_y"
    assert (measures.area, measures.length) == pytest.approx((10e-3, 25e-3), rel=1e-12)


def test_a_node_that_two_curves_hold_is_held_once(case_of):
    loading = {"kind": "boundaries", "held": {"bottom": "xy", "right": "x"}}
    case = case_of(SQUARE + GROUPS, loading=loading | {"pressed_MPa": {"top": 1}})
    problem = make_problem(case, make_mesh(case))
    held = [(int(n), load.component) for load in problem.velocity_loads for n in load.nodes]
    assert len(held) == len(set(held))


def test_bodies_have_their_own_materials_and_friction(case_of):
    case = case_of(
        SQUARE + GROUPS + APART,
        scene__materials={"cap": "steel"},
        contact={"friction": {"rock-cap": 0.1, "rock-rock": 1.2}},
    )
    problem = make_problem(case, make_mesh(case))
    assert [material.title.split()[0] for material in problem.materials] == ["Sandstone", "Steel"]
    assert problem.contact.table(problem.mesh)[0].tolist() == [1.2, 0.1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "",
            "has no physical surface with a name, expected one for each body, as in "
            'Physical Surface("rock") = {1};',
        ),
        ("Physical Surface(7) = {1};", "has no physical surface with a name, expected one for "),
        (GROUPS + 'Physical Curve("left") = {};', "the physical curve 'left' is empty"),
        (GROUPS + 'Physical Surface("cap") = {};', "the physical surface 'cap' is empty"),
        (
            GROUPS + "Recombine Surface {1};",
            "holds elements of type quad, expected triangles of three nodes alone",
        ),
        (
            GROUPS + "Mesh.ElementOrder = 2;",
            "holds elements of type line3, expected triangles of three nodes alone",
        ),
        (
            GROUPS + 'Physical Surface("again") = {1};',
            "triangles are in two physical surfaces, expected each in one",
        ),
        (
            GROUPS + 'Point(9) = {0, 30, 0, 3};\nLine(9) = {4, 9};\nPhysical Curve("apart") = {9};',
            "the physical curve 'apart' is not made of sides of the triangles",
        ),
        (
            GROUPS + "Translate {0, 0, 1} { Surface {1}; }",
            "reaches from z = 1 to 1, expected the plane z = 0",
        ),
        (GROUPS + "Line(9) = {1, 99};", "gmsh gave no mesh: "),
        (GROUPS + "Exit;", "gmsh gave no mesh: no message"),
        (GROUPS + "oops oops;", "gmsh gave no mesh: line 15: Unknown variable 'oops'"),
    ],
    ids=["none", "unnamed", "curve", "surface", "quads", "order", "twice", "apart", "z", "point",
         "exit", "syntax"],
)  # fmt: skip
def test_a_file_that_is_no_scene_is_refused_in_one_sentence(refused, text, message):
    said = refused(SQUARE + text)
    assert message in said
    assert "\n" not in said


def test_no_surface_at_all_is_refused(refused):
    assert refused("Point(1) = {0, 0, 0};\n").startswith(("gmsh gave no mesh", "holds no triangl"))


def test_a_file_of_other_words_is_refused(refused, tmp_path):
    said = refused("no mesh\n", CASE.replace("own.geo", "own.msh"), name="own.msh")
    assert said.startswith("no mesh that can be read, expected Gmsh's format 2.2 or 4.1 (")
    assert "\n" not in said


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("1e155 -1e194", "holds a node at 1e+194, expected at most 1e+12"),
        ("nan 0", "holds nodes at no place, expected numbers"),
        ("1e400 0", "holds nodes at no place, expected numbers"),
    ],
)
def test_nodes_that_are_nowhere_are_refused(refused, tmp_path, place, message):
    by_gmsh(SQUARE + GROUPS, tmp_path / "own.msh", "-format", "msh22")
    text = re.sub(r"(?m)^1 0 0 0$", f"1 {place} 0", (tmp_path / "own.msh").read_text())
    assert refused(text, CASE.replace("own.geo", "own.msh"), name="own.msh") == message


def test_a_mesh_file_that_has_lost_an_end_is_refused(refused, tmp_path, capfd):
    by_gmsh(SQUARE + GROUPS, tmp_path / "own.msh", "-format", "msh22")
    text = (tmp_path / "own.msh").read_text().replace("$EndMeshFormat", "$EndMeshFromat")
    assert refused(text, CASE.replace("own.geo", "own.msh"), name="own.msh") == (
        "no mesh that can be read, expected Gmsh's format 2.2 or 4.1 ($MeshFormat not closed by "
        "$EndMeshFormat.)"
    )
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (
            {"loading__held": {"botom": "y"}},
            "loading.held.botom: no such physical curve, did you mean 'bottom'?",
        ),
        (
            {"scene__materials": {"cap": "steel"}},
            "scene.materials.cap: no such physical surface, expected one of: rock",
        ),
        (
            {"scene__materials": {"rock": "steel"}},
            "scene.materials: names all physical surfaces, expected one that is of the material "
            "of the case",
        ),
        (
            {"contact": {"friction": {"rock-steel": 0.1}}},
            "contact.friction.rock-steel = 0.1: unknown surface 'steel', expected one of: bottom, "
            "right, rock, top",
        ),
        (
            {"loading__driven": {"top": {"y_mm": -1}, "right": {"y_mm": 1}},
             "loading__speed_m_s": 1},
            "loading.driven.right: moves its node at (10, 20) mm along y otherwise than "
            "loading.driven.top, expected the same",
        ),
    ],
    ids=["curve", "surface", "all", "friction", "twice"],
)  # fmt: skip
def test_names_that_the_file_lacks_are_refused(refused, keys, message):
    assert refused(SQUARE + GROUPS, **keys) == message


def test_a_curve_inside_is_not_pressed(refused):
    assert refused(SQUARE + GROUPS + CAP) == (
        "loading.pressed_MPa.top: the curve lies inside of the mesh, expected a boundary"
    )


def test_elements_above_the_limit_are_refused_with_their_body(refused):
    said = refused(
        SQUARE + GROUPS + APART, scene__length_unit="m", scene__materials={"cap": "steel"}
    )
    assert said.startswith("physical surface 'rock': crack band width ")
    assert "is not below the limit of 280 mm" in said


def test_bodies_at_one_place_need_contact(case_of):
    case = case_of(SQUARE + GROUPS + APART, scene__materials={"cap": "steel"}, contact={})
    make_problem(case, make_mesh(case))
    case = case_of(SQUARE + GROUPS + APART, scene__materials={"cap": "steel"})
    with pytest.raises(ConfigError, match=r"^nodes \d+ and \d+ of the mesh are within 1e-06 of "):
        make_problem(case, make_mesh(case))


def test_a_mesh_with_a_flaw_is_refused_with_its_place(refused):
    """A hinge; other flaws are those of any mesh, see mesh_flaws.py."""
    corner = """\
Point(7) = {15, 20, 0, 3};
Point(8) = {15, 25, 0, 3};
Line(8) = {3, 7};
Line(9) = {7, 8};
Line(10) = {8, 3};
Curve Loop(3) = {8, 9, 10};
Plane Surface(3) = {3};
"""
    said = refused(SQUARE + corner + GROUPS.replace("{1};", "{1, 3};", 1))
    assert re.fullmatch(
        r"node \d+ joins parts that share no edge, expected a node of its own in each", said
    )


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ('SystemCall "touch TOUCHED";', "SystemCall"),
        ('System "touch TOUCHED";', "System"),
        ('Include "other.geo";', "Include"),
        ('Merge"other.msh";', "Merge"),
        ('Save "TOUCHED";', "Save"),
        ('Print "TOUCHED";', "Print"),
        ('Printf("a") > "TOUCHED";', "Printf"),
        ('Field[1] = ExternalProcess;\nField[1].CommandLine = "touch TOUCHED";', "ExternalProcess"),
        ('CreateDir "TOUCHED";', "CreateDir"),
        ('OnelabRun("a", "touch TOUCHED");', "OnelabRun"),
        ('General.LogFileName = "TOUCHED";', "General"),
        (
            'DefineString[a = {"TOUCHED", GmshOption StrCat("Gen", "eral.LogFileName")}];',
            "GmshOption",
        ),
        ('OnelabAction "reset";', "OnelabAction"),
        ('/* " */ SystemCall "touch TOUCHED"; // "', "SystemCall"),
    ],
)
def test_a_script_that_could_do_more_than_mesh_is_refused(refused, tmp_path, line, word):
    touched = tmp_path / "touched"
    said = refused(SQUARE + GROUPS + line.replace("TOUCHED", str(touched)))
    assert said.startswith(f"line 15: the word {word} is refused, even in a comment, because it ")
    assert not touched.exists()


def test_words_that_only_begin_alike_are_not_refused(case_of):
    assert len(make_mesh(case_of(SQUARE + GROUPS + "Saved = 1; // Printing, Includes")).nodes)


def test_the_file_and_materials_stand_beside_the_file_that_names_them(case_of, tmp_path):
    case_of(SQUARE + GROUPS + CAP)
    (tmp_path / "soft.yaml").write_text(Path("configs/materials/sandstone.yaml").read_text())
    (tmp_path / "child").mkdir()
    child = tmp_path / "child" / "child.yaml"
    child.write_text("extends: ../own\nscene: {materials: {cap: ../soft.yaml}}\n")
    case = load_case(child)
    assert case.scene.path.resolve() == tmp_path / "own.geo"
    assert case.scene.materials["cap"].young == 28e9


def test_a_case_written_back_is_the_same_case(case_of, tmp_path):
    case = case_of(SQUARE + GROUPS + APART, scene__materials={"cap": "steel"})
    (tmp_path / "again.yaml").write_text(text_of(case))
    assert load_case(tmp_path / "again.yaml") == case


@pytest.mark.parametrize("name", ["two_holes", "stope"])
def test_the_examples_are_right(name):
    case = load_case(Path(f"configs/examples/{name}.yaml"))
    problem = make_problem(case, make_mesh(case))
    assert problem.fracture is not None
    assert len(problem.mesh.triangles) < 12_000


def test_gmsh_is_not_imported():
    code = "import sys, lithofrac.scenes; sys.exit('gmsh' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
