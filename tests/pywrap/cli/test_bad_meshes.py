"""Bad meshes: one exact sentence each, exit code 2, nothing written, no code run."""

import io
import os
import zipfile

import numpy as np
import pytest
from own_geometry import GROUPS, OWN, SQUARE, beside, sized

from lithofrac.cli import main
from lithofrac.errors import CheckpointError, FileError
from lithofrac.problem import Mesh
from lithofrac.results import checkpoint

CASE = """\
title: A bar
material: {extends: sandstone, elastic: true}
scene: {kind: bar, height_mm: 3.0, width_mm: 2.0, element_size_mm: 1.0}
loading: {kind: traction, stress_MPa: 1.0, ramp_transits: 1.0, hold_transits: 1.0}
output: {records: 5, fields: 0}
"""
PLATENS = """\
title: A prism
material: {extends: sandstone, elastic: true}
scene:
  {kind: plane_strain, height_mm: 4.0, width_mm: 2.0, element_size_mm: 1.0, structured: true}
loading: {kind: velocity, speed_m_s: 1.0, end_strain: 0.001}
platens: {material: steel, thickness_mm: 1.0}
contact: {}
"""
EXPECTED = "expected a mesh of `lithofrac mesh`"


@pytest.fixture
def bar(tmp_path):
    """bar(change, case=CASE) -> case file and mesh file, whose arrays `change` has seen."""

    def made(change=lambda arrays: None, case=CASE):
        path, mesh = tmp_path / "case.yaml", tmp_path / "mesh.npz"
        path.write_text(case)
        assert main(["mesh", str(path), "--out", str(mesh)]) == 0
        with np.load(mesh) as file:
            arrays = {name: file[name] for name in file}
        change(arrays)
        np.savez(mesh, **arrays)
        return path, mesh

    return made


def put(name, where, value):
    """A change of one number, or of all numbers in a row."""

    def change(arrays):
        arrays[name][where] = value

    return change


def drop(name):
    return lambda arrays: arrays.pop(name)


def also(name, rows):
    """A change that adds rows."""
    return lambda arrays: arrays.update({name: np.concatenate([arrays[name], rows(arrays)])})


def both(*changes):
    return lambda arrays: [change(arrays) for change in changes]


def kind(name, dtype):
    return lambda arrays: arrays.update({name: arrays[name].astype(dtype)})


def turn(arrays):
    arrays["triangles"][4] = arrays["triangles"][4, ::-1]


def flatten(arrays):
    a, b, c = arrays["triangles"][2]
    arrays["nodes"][c] = 0.5 * (arrays["nodes"][a] + arrays["nodes"][b])


def element_again(arrays):
    for name in ("triangles", "body"):
        arrays[name] = np.concatenate([arrays[name], arrays[name][:1]])


def hinge(arrays):
    """A triangle apart that shares one node with the rest."""
    corner = int(np.argmax(arrays["nodes"].sum(axis=1)))
    n = len(arrays["nodes"])
    more = arrays["nodes"][corner] + np.array([[1e-3, 0.0], [0.0, 1e-3]])
    arrays["nodes"] = np.vstack([arrays["nodes"], more])
    arrays["triangles"] = np.vstack([arrays["triangles"], [[corner, n, n + 1]]]).astype(np.int32)
    arrays["body"] = np.append(arrays["body"], np.int32(0))


def cut_open(arrays):
    """The upper row of elements has nodes of its own, at the same places: not merged."""
    nodes, triangles = arrays["nodes"], arrays["triangles"]
    upper = nodes[triangles].mean(axis=1)[:, 1] > 2e-3
    shared = np.flatnonzero(np.isclose(nodes[:, 1], 2e-3))
    copy = np.arange(len(nodes))
    copy[shared] = len(nodes) + np.arange(len(shared))
    triangles[upper] = copy[triangles[upper]]
    arrays["nodes"] = np.vstack([nodes, nodes[shared]])
    for name in ("edges:left", "edges:right"):
        edges = arrays[name]
        high = nodes[edges].mean(axis=1)[:, 1] > 2e-3
        edges[high] = copy[edges[high]]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("nodes", (3, 1), np.nan), "node 4 is at (0.002, nan), expected finite numbers"),
        (put("nodes", (3, 1), np.inf), "node 4 is at (0.002, inf), expected finite numbers"),
        (
            put("nodes", (3, 1), 1e300),
            "node 4 is 1e+300 m from the origin, expected at most 1e+09 m",
        ),
        (put("triangles", (1, 2), 99), "element 2 names node 100, expected 1 to 12"),
        (put("triangles", (1, 2), -1), "element 2 names node 0, expected 1 to 12"),
        (
            turn,
            "element 5 is clockwise, area -5e-07 m2, expected its nodes counter-clockwise around a "
            "positive area",
        ),
        (
            flatten,
            "element 3 is flat, area 0 m2, expected its nodes counter-clockwise around a positive "
            "area",
        ),
        (also("nodes", lambda a: a["nodes"][:1] + 9), "node 13 belongs to no element"),
        (
            element_again,
            "elements 1 and 13 lie on the same side of edge 1 - 3, expected one on each side",
        ),
        (
            hinge,
            "node 12 joins parts that share no edge, expected a node of its own in each",
        ),
        (put("body", 3, 7), "element 4 is of body 8, expected 1 to 1"),
        (
            lambda arrays: arrays.update(body_names=np.array(["rock", "x"])),
            "body 'x' has no element",
        ),
        (
            lambda arrays: arrays.update(body_names=np.array(["rock", "rock"])),
            "bodies are named rock, rock, expected a name for each",
        ),
        (
            put("edges:top", 0, [0, 11]),
            "edge set 'top' names 1 - 12, expected a side of an element, which lies on its left",
        ),
        (drop("triangles"), f"{EXPECTED} (it lacks triangles)"),
        (
            kind("nodes", complex),
            "nodes are complex128 of shape (12, 2), expected numbers of shape (n, 2)",
        ),
        (
            kind("triangles", float),
            "triangles are float64 of shape (12, 3), expected whole numbers of shape (n, 3)",
        ),
        (
            lambda arrays: arrays.update(body=arrays["body"][:-1]),
            "body is int32 of shape (11,), expected one whole number for each triangle",
        ),
        (
            lambda arrays: arrays.update(
                triangles=arrays["triangles"][:0], body=arrays["body"][:0]
            ),
            "holds no triangle, expected at least one of three nodes",
        ),
    ],
    ids=["nan", "inf", "far", "index_high", "index_low", "inverted", "flat", "unreferenced",
         "non_manifold", "hinge", "body", "empty_body", "body_twice", "edge_set", "missing",
         "complex", "float", "length", "none"],
)  # fmt: skip
def test_a_flaw_is_named_with_its_place(bar, refused, capsys, change, message):
    path, mesh = bar(change)
    capsys.readouterr()
    assert refused(path, "--mesh", str(mesh)) == f"lithofrac: {mesh}: {message}\n"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda arrays: arrays.update(body_names=np.array(["platen"])),
            "the mesh has the bodies platen, expected rock",
        ),
        (drop("edges:top"), "the mesh has no edge set 'top', expected a mesh of this case"),
        (
            lambda arrays: arrays.update({"edges:top": arrays["edges:top"][:0]}),
            "the mesh has no edge set 'top', expected a mesh of this case",
        ),
        (
            cut_open,
            "nodes {pair} of the mesh are within 1e-06 of its shortest edge of each other, "
            "expected one node there, or a section contact: that keeps the parts apart",
        ),
    ],
    ids=["body", "edge_set", "empty_set", "not_merged"],
)
def test_a_mesh_of_another_case_is_refused(bar, refused, capsys, change, message):
    path, mesh = bar(change)
    nodes = Mesh.load(mesh).nodes
    twins = [
        f"{i + 1} and {j + 1}"
        for i in range(len(nodes))
        for j in range(i + 1, len(nodes))
        if np.array_equal(nodes[i], nodes[j])
    ]
    capsys.readouterr()
    expected = message.format(pair=twins[0] if twins else "")
    assert refused(path, "--mesh", str(mesh)) == f"lithofrac: {path}: {expected}\n"


def test_nodes_at_one_place_are_a_joint_where_there_is_contact(bar, tmp_path):
    path, mesh = bar(cut_open)
    out = tmp_path / "out"
    words = ["run", str(path), "--mesh", str(mesh), "--out", str(out), "--quiet"]
    assert main([*words, "--set", "contact.default_friction=0.5"]) == 0


def test_bodies_that_overlap_are_refused_with_their_depth(bar, refused, capsys):
    """By more than a thousandth of the shortest edge, which contact takes back."""

    def sunk(by):
        def change(arrays):
            own = arrays["body"] == list(arrays["body_names"]).index("top_platen")
            arrays["nodes"][np.unique(arrays["triangles"][own]), 1] -= by

        return change

    path, mesh = bar(sunk(1e-5), PLATENS)
    capsys.readouterr()
    said = refused(path, "--mesh", str(mesh))
    assert said.startswith(f"lithofrac: {path}: contact: node ")
    assert " m stands 1.00E-05 m inside another part; parts must not overlap at the start" in said
    assert said.count("\n") == 1
    path, mesh = bar(sunk(0.9e-6), PLATENS)
    out = path.parent / "out"
    assert main(["run", str(path), "--mesh", str(mesh), "--out", str(out), "--quiet"]) == 0


@pytest.mark.parametrize("contact", [(), ("--set", "contact.default_friction=0.5")])
def test_parts_that_overlap_are_refused_without_contact_too(bar, refused, capsys, contact):
    """Where nothing keeps parts apart, a mesh that lays them on each other is no case either."""

    def sunk(arrays):
        cut_open(arrays)
        upper = arrays["nodes"][arrays["triangles"]].mean(axis=1)[:, 1] > 2e-3
        arrays["nodes"][np.unique(arrays["triangles"][upper]), 1] -= 1e-4

    path, mesh = bar(sunk)
    capsys.readouterr()
    said = refused(path, "--mesh", str(mesh), *contact)
    assert said.startswith(f"lithofrac: {path}: {'contact' if contact else 'mesh'}: node ")
    assert " m stands 1.00E-04 m inside another part; parts must not overlap at the start" in said
    assert said.count("\n") == 1


BAR_ACROSS = """\
Point(5) = {-5, 8, 0, 30};
Point(6) = {15, 8, 0, 30};
Point(7) = {15, 12, 0, 30};
Point(8) = {-5, 12, 0, 30};
Line(5) = {5, 6};
Line(6) = {6, 7};
Line(7) = {7, 8};
Line(8) = {8, 5};
Curve Loop(2) = {5, 6, 7, 8};
Plane Surface(2) = {2};
Physical Surface("bar") = {2};
Transfinite Curve {1, 2, 3, 4, 5, 6, 7, 8} = 2;
Transfinite Surface {1, 2};
"""


@pytest.mark.parametrize("contact", ["", "contact: {}\n"], ids=["bare", "contact"])
def test_bodies_of_a_geometry_that_cross_are_refused_by_check(tmp_path, capsys, contact):
    """Two bars with nodes at their corners alone: none of them is inside the other."""
    path = beside(tmp_path, sized(SQUARE + GROUPS, 30) + BAR_ACROSS, OWN + contact)
    assert main(["check", str(path)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith(f"lithofrac: {path}: {'contact' if contact else 'mesh'}: elements ")
    assert " of two parts cross at " in said.err
    assert said.err.endswith(" m deep; parts must not overlap at the start\n")


def test_a_file_that_is_no_mesh(bar, refused, capsys, tmp_path):
    path, mesh = bar()
    whole = mesh.read_bytes()
    capsys.readouterr()
    mesh.write_bytes(b"no mesh")
    words = f"lithofrac: {mesh}: {EXPECTED}"
    assert refused(path, "--mesh", str(mesh)) == f"{words} (File is not a zip file)\n"
    flipped = bytearray(whole)
    flipped[whole.index(np.float64(2e-3).tobytes())] ^= 1
    mesh.write_bytes(flipped)
    assert refused(path, "--mesh", str(mesh)) == f"{words} (Bad CRC-32 for file 'nodes.npy')\n"
    mesh.write_bytes(whole[: len(whole) // 2])
    assert refused(path, "--mesh", str(mesh)) == f"{words} (File is not a zip file)\n"
    with zipfile.ZipFile(mesh, "w") as file:
        file.writestr("nodes.npy", b"words")
    assert refused(path, "--mesh", str(mesh)) == f"{words} ('nodes' is no array)\n"
    mesh.unlink()
    message = f"lithofrac: {mesh}: no such file, {EXPECTED}\n"
    assert refused(path, "--mesh", str(mesh)) == message
    mesh.mkdir()
    message = f"lithofrac: {mesh}: is no regular file, {EXPECTED}\n"
    assert refused(path, "--mesh", str(mesh)) == message


def test_a_small_file_that_unfolds_without_end_is_refused(bar, refused, capsys, monkeypatch):
    path, mesh = bar()
    capsys.readouterr()
    monkeypatch.setattr("lithofrac.npz.MOST_BYTES", 1_000_000)
    with zipfile.ZipFile(mesh, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("nodes.npy", bytes(1_100_000))
    assert mesh.stat().st_size < 10_000
    assert refused(path, "--mesh", str(mesh)) == (
        f"lithofrac: {mesh}: {EXPECTED} (1.1e+06 bytes unpacked, at most 1e+06 are read)\n"
    )


# ---------------------------------------------------------------- code in a file


class Trap:
    """Leaves a file behind when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return os.mkdir, (str(self.path),)


def trapped(path, **arrays) -> bytes:
    """An .npz with a pickled object that acts when it is read."""
    trap = np.empty(1, dtype=object)
    trap[0] = Trap(path)
    with io.BytesIO() as file:
        np.savez(file, **arrays, trap=trap)
        return file.getvalue()


def test_the_trap_of_these_tests_works(tmp_path):
    with np.load(io.BytesIO(trapped(tmp_path / "sprung")), allow_pickle=True) as file:
        file["trap"]
    assert (tmp_path / "sprung").exists()


def test_no_code_in_a_mesh_is_run(bar, refused, capsys, tmp_path):
    path, mesh = bar()
    with np.load(mesh) as file:
        arrays = {name: file[name] for name in file}
    mesh.write_bytes(trapped(tmp_path / "sprung", **arrays))
    capsys.readouterr()
    assert refused(path, "--mesh", str(mesh)) == (
        f"lithofrac: {mesh}: {EXPECTED} (Object arrays cannot be loaded when allow_pickle=False)\n"
    )
    with pytest.raises(FileError):
        Mesh.load(mesh)
    assert not (tmp_path / "sprung").exists()


def test_no_code_in_a_checkpoint_is_run(tmp_path):
    checkpoint.write(tmp_path, "mark", {"state": np.zeros(5)})
    file = tmp_path / checkpoint.NAME
    with np.load(file) as content:
        arrays = {name: content[name] for name in content}
    file.write_bytes(trapped(tmp_path / "sprung", **arrays))
    with pytest.raises(CheckpointError, match="allow_pickle=False"):
        checkpoint.read(tmp_path, "mark")
    file.write_bytes(b"cos\nmkdir\n(S'" + str(tmp_path / "sprung").encode() + b"'\ntR.")
    with pytest.raises(CheckpointError, match="not a whole checkpoint"):
        checkpoint.read(tmp_path, "mark")
    assert not (tmp_path / "sprung").exists()
