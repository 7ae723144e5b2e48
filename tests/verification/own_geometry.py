"""Geometries of one's own that several tests share: a block, a cap on it, files."""

import subprocess

import numpy as np

from lithofrac.scenes import _gmsh, hole_quarter, make_mesh

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
OWN = """\
title: Own
material: sandstone
scene: {kind: gmsh_file, file: own.geo, length_unit: mm}
loading: {kind: boundaries, held: {bottom: y}, pressed_MPa: {top: 5}}
"""
MSH = OWN.replace("own.geo", "own.msh")
KIRSCH_LOADING = """\
loading:
  kind: boundaries
  held: {bottom: y, left: x}
  pressed_MPa: {top: 1.0}
  ramp_transits: 40  # of half the height of the block
  hold_transits: 4
"""


def sized(geo, size):
    """The texts above with another element size [mm]."""
    return geo.replace(", 0, 3};", f", 0, {size}}};")


def beside(folder, geo, case, name="own.geo"):
    """Write a geometry and a case that names it; path of the case."""
    (folder / name).write_text(geo)
    (folder / "own.yaml").write_text(case)
    return folder / "own.yaml"


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


def hole_as_geo(case, monkeypatch):
    """Mesh of a built-in case with a quarter of a hole, and the same scene as a `.geo`."""
    written = []
    monkeypatch.setattr(
        hole_quarter, "mesh_from", lambda geo: written.append(geo) or _gmsh.mesh_from(geo)
    )
    mesh = make_mesh(case)
    head = "".join(line for line in _gmsh.HEAD.splitlines(True) if "General" not in line)
    return mesh, head + written[0]
