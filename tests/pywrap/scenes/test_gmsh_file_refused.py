"""Geometries of one's own: what is refused, and in which words (scenes/gmsh_file.py)."""

import re
import time

import pytest
from own_geometry import APART, CAP, GROUPS, MSH, SQUARE, by_gmsh

from lithofrac.config import ConfigError
from lithofrac.scenes import _gmsh, make_mesh, make_problem

pytestmark = pytest.mark.no_core


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
    said = refused("no mesh\n", MSH, name="own.msh")
    assert said.startswith("no mesh that can be read, expected Gmsh's format 2.2 or 4.1 (")
    assert "\n" not in said


@pytest.mark.parametrize(
    ("version", "message"),
    [
        (
            "msh41",
            "holds elements in no physical group, expected those of groups alone: save it with "
            "Mesh.SaveAll = 0",
        ),
        (
            "msh22",
            "triangles are in no physical surface with a name, expected all in one (saved with "
            "Mesh.SaveAll = 0)",
        ),
    ],
)
def test_a_mesh_file_of_all_elements_is_refused_with_what_to_do(
    refused, tmp_path, version, message
):
    by_gmsh(SQUARE + GROUPS, tmp_path / "own.msh", "-format", version, "-save_all")
    assert refused((tmp_path / "own.msh").read_text(), MSH, name="own.msh").endswith(message)


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
    assert refused(text, MSH, name="own.msh") == message


def test_a_mesh_file_that_has_lost_an_end_is_refused(refused, tmp_path, capfd):
    by_gmsh(SQUARE + GROUPS, tmp_path / "own.msh", "-format", "msh22")
    text = (tmp_path / "own.msh").read_text().replace("$EndMeshFormat", "$EndMeshFromat")
    assert refused(text, MSH, name="own.msh") == (
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
        ('StringToName[StrCat("Sys", "temCall")] "touch TOUCHED";', "StringToName"),
        ('S2N[StrCat("Sa", "ve")] "TOUCHED";', "S2N"),
        ("Sleep 100000;", "Sleep"),
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


@pytest.mark.parametrize(
    "loop",
    [
        "For i In {1:1e15}\na = i;\nEndFor",
        "For i In {1:1e15}\nPoint(1000 + i) = {i, 0, 0};\nEndFor",
    ],
)
def test_a_loop_without_end_is_stopped_in_a_sentence(refused, monkeypatch, loop):
    monkeypatch.setattr(_gmsh, "OWN_TIME_LIMIT", 3.0)
    start = time.monotonic()
    said = refused(f"{SQUARE}{GROUPS}{loop}\n")
    assert time.monotonic() - start < 30.0
    assert said.startswith("gmsh was stopped after 3 s; look for a loop or call that does not end")


def test_a_recursion_without_end_is_refused(refused, monkeypatch):
    monkeypatch.setattr(_gmsh, "OWN_TIME_LIMIT", 10.0)
    said = refused(f"{SQUARE}{GROUPS}Macro Again\nCall Again;\nReturn\nCall Again;\n")
    assert said.startswith("gmsh ")


def test_a_loop_that_ends_is_meshed(case_of):
    loop = "For i In {1:100}\na = i;\nEndFor\n"
    assert len(make_mesh(case_of(SQUARE + GROUPS + loop)).nodes)
