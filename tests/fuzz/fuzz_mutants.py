"""Mutants of right inputs, each wholly given by its seed.

Bytes are flipped, cut, copied and replaced; texts get words that parsers trip over; mappings and
arrays are changed piece by piece, so that many mutants are still well-formed and reach the core.
"""

import io
import random
from dataclasses import dataclass

import numpy as np
import yaml
from fuzz_bases import CASES, CHECKPOINTS, DATA, MATERIALS, MESHED, OTHER_MSH, OWN, STUDY, SUITE

from lithofrac.results.checkpoint import _digest

WORDS = (
    b"nan", b".nan", b".inf", b"-.inf", b"1e400", b"-1e400", b"1e-400", b"9" * 400, b"-0", b"0x10",
    b"1_0", b"1:30", b"null", b"~", b"true", b"yes", b"''", b'"\\x00"', b'"\\uD800"', b"\x00",
    b"\xff", b"\xc3\x28", b"\xef\xbb\xbf", b"\t", b"\r\n", b"\r", b"\n\n", b"&a ", b"*a", b"<<: ",
    b"!!python/object/apply:os.system [exit]", b"!!bool maybe", b"!!float ''", b"!!int a",
    b"!!timestamp x", b"!!binary x", b"!!set {a}", b"!!omap [a]", b"? ", b": ", b"- ", b"{", b"}",
    b"[" * 50, b"[" * 5000, b"]", b"---\n", b"...\n", b"%YAML 9.9\n", b"# ", b"| ", b"> ", b"'",
    b'"', b"\\", b"extends: case\n", b"../", b"/dev/zero", b"/etc/passwd", b",", b";", b"\x1b[31m",
    "\u2028".encode(), "\u00e9".encode(), b"x" * 3000,
)  # fmt: skip
VALUES = (
    None, True, False, "", "x", "off", "a\nb", "\x1b", "../up", "/dev/zero", "steel", "x" * 500,
    -1, 0, 1, 2, 0.0, -0.0, 1e-300, 1e300, float("nan"), float("inf"), float("-inf"), 10**30,
    -(10**30), 10**400, 2**31, 2**63, 1e-9, 0.5, 90, 89.999, [], {}, [1], [1, 2, 3, 4], [0.0] * 9,
    ["a"], {"a": 1}, {"kind": "bar"}, {"extends": "rock"}, [[]], [None],
)  # fmt: skip
FACTORS = (
    0.01, 0.1, 0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 3.0, 10.0, 100.0, 1e-3, 1e3, 1e-6, 1e6, 1e9, -1.0,
    0.0,
)  # fmt: skip
ENDS = (
    1e-9,
    1e-6,
    1e-3,
    0.5,
    0.4999999,
    0.999999,
    1.0,
    89.999999,
    1e3,
    1e4,
    1e5,
    1e6,
    1e7,
    1e9,
    1e12,
    1e18,
)  # of the ranges of keys
WORDS_OF_KEYS = {
    "mode": ("off", "inter_element", "intra_element"), "weights": ("volume", "failure_factor"),
    "reset": ("normal", "paper"), "relative_to": ("affine", "ground"),
    "sense": ("shorten", "stretch"), "hardening": ("compressive", "total"),
    "coupling": ("implicit", "explicit"), "band_width": ("sqrt_2A", "sqrt_A"),
}  # fmt: skip
# Keys that bases leave out -> section (of a case; "" is the top) and values.
MORE_KEYS = {
    "release_steps": ("fracture", (0, 1, 50, 1_000_000)),
    "interval_steps": ("fracture", (1, 5, 1_000_000)),
    "reset": ("fracture", ("paper",)),
    "weights": ("fracture", ("failure_factor",)),
    "alpha_1_s": ("damping", (0.0, 1.0, 1e6, 1e12)),
    "tolerance": ("contact", (1e-6, 1e-3, 1e3)),
    "default_friction": ("contact", (0.0, 10.0, 1e3)),
    "seed": ("mesh", (2, 7, 2**31 - 1)),
    "structured": ("scene", (True, False)),
    "whole_height": ("scene", (True,)),
    "laterally_fixed": ("scene", (True,)),
    "lateral_platens": ("scene", (True, False)),
    "rigid": ("platens", (True,)),
    "sense": ("loading", ("stretch", "shorten")),
    "confinement_MPa": ("loading", (0.0, 1.0, 1e3, 1e6)),
    "lateral_stiffness_over_young": ("loading", (0.0, 0.1, 10.0, 1e3)),
    "budget_element_steps": ("", (1.0, 1e3, 1e18)),
    "fracture": ("", ("off", {"mode": "inter_element"}, {"mode": "intra_element"})),
    "contact": ("", ({}, {"default_friction": 0.5})),
    "material": ("", ("./rock.yaml", "./regular.yaml", "./steel.yaml", "sandstone", "quartzite")),
    "elastic": ("material", (True,)),
    "compression": ("material", (False,)),
    "reference_size_mm": ("material", (0.1, 2.0, 100.0)),
}
LOOPS = (
    b"For i In {1:1e15}\na = i;\nEndFor", b"For i In {1:9}\na = i;",
    b"Macro M\nCall M;\nReturn\nCall M;",
    b"If (1)", b"a[] = {1:1e9};", b"Mesh.MeshSizeFactor = 1e-9;", b"Exit;", b"Abort;",
    b"Mesh.Algorithm = 99;", b"Delete Model;", b"Physical Curve(\"a\") = {1:1e6};",
)  # fmt: skip
CELLS = (
    b"", b"-1", b"0", b"1", b"2", b"3", b"7", b"13", b"99", b"0.5", b"1e308", b"abc", b"4294967297",
)  # fmt: skip
MORE = 1_000_000  # from this seed on: checkpoints and scripts of gmsh
KINDS = (*CASES, "velocity", "traction", "boundaries")


@dataclass(frozen=True)
class Mutant:
    """Input of one trial.

    files : name -> content, one of them changed; words : of the command line, or "data";
    base : of a mesh, the case that it belongs to
    """

    seed: int
    target: str
    files: dict[str, bytes]
    words: tuple[str, ...]


def mutant(seed: int, meshes: dict[str, bytes]) -> Mutant:
    """The mutant of a seed; `meshes` holds the right mesh of every case, as an .npz."""
    choose = random.Random(seed)
    if seed >= MORE:
        return choose.choice((_checkpoint, _checkpoint, _geo))(seed, choose, meshes)
    makers = (_case, _material, _suite, _mesh, _own, _data)
    make = choose.choices(makers, weights=(34, 16, 6, 22, 13, 9))[0]
    return make(seed, choose, meshes)


def _folder() -> dict[str, bytes]:
    return {name: text.encode() for name, text in MATERIALS.items()}


def _case(seed: int, choose: random.Random, meshes: dict[str, bytes]) -> Mutant:
    names = [name for name in CASES if name not in MESHED]
    name = choose.choice(MESHED if choose.random() < 0.08 else names)
    text, how = _text(CASES[name].encode(), choose)
    return Mutant(
        seed, f"case {name}, {how}", _folder() | {"case.yaml": text}, ("check", "case.yaml")
    )


def _material(seed: int, choose: random.Random, meshes: dict[str, bytes]) -> Mutant:
    file = choose.choice([name for name in MATERIALS for _ in range(2 if "rock" in name else 1)])
    users = {"regular.yaml": ["triaxial"], "steel.yaml": ["plane_strain"]}
    name = choose.choice(users.get(file, ["single_element", "bar", "plane_strain"]))
    text, how = _text(MATERIALS[file].encode(), choose)
    files = _folder() | {"case.yaml": CASES[name].encode(), file: text}
    return Mutant(seed, f"material {file} of {name}, {how}", files, ("check", "case.yaml"))


def _suite(seed: int, choose: random.Random, meshes: dict[str, bytes]) -> Mutant:
    if choose.random() < 0.5:
        text, how = _text(STUDY.encode(), choose)
        files = {"case.yaml": CASES["single_element"].encode(), "study.yaml": text}
        return Mutant(seed, f"study, {how}", _folder() | files, ("study",))
    text, how = _text(SUITE.encode(), choose)
    cases = {f"{name}.yaml": CASES[name].encode() for name in ("single_element", "triaxial")}
    words = ("check", choose.choice(["first", "second", "first@seed2"]), "--suite", "suite.yaml")
    return Mutant(seed, f"suite, {how}", _folder() | cases | {"suite.yaml": text}, words)


def _mesh(seed: int, choose: random.Random, meshes: dict[str, bytes]) -> Mutant:
    name = choose.choice([*CASES, "own"])
    if choose.random() < 0.15:
        mesh, how = _bytes(meshes[name], choose), "bytes"
    else:
        mesh, how = _arrays(meshes[name], choose)
    files = _folder() | {"case.yaml": CASES.get(name, OWN).encode(), "mesh.npz": mesh}
    if name == "own":
        files["own.msh"] = meshes["own_22.msh"]
    words = ("run", "case.yaml", "--mesh", "mesh.npz")
    return Mutant(seed, f"mesh of {name}, {how}", files, words)


def _own(seed: int, choose: random.Random, meshes: dict[str, bytes]) -> Mutant:
    """A Gmsh file, or the case that names it."""
    file = choose.choice(("own_22.msh", "own_22.msh", *OTHER_MSH))
    case, mesh = OWN.encode(), meshes[file]
    if choose.random() < 0.25:
        case, how = _text(case, choose)
    elif choose.random() < 0.6 and "binary" not in file:
        mesh, how = _cells(mesh, choose, b" "), "cells"
    else:
        mesh, how = _bytes(mesh, choose), "bytes"
    files = _folder() | {"case.yaml": case, "own.msh": mesh}
    return Mutant(seed, f"own {file}, {how}", files, ("check", "case.yaml"))


def _geo(seed: int, choose: random.Random, meshes: dict[str, bytes]) -> Mutant:
    """A script of gmsh, which has most of a second and may hold loops."""
    script, how = meshes["own.geo"], "bytes"
    if choose.random() < 0.4:
        script, how = _cells(script, choose, b" "), "cells"
    elif choose.random() < 0.3:
        lines = script.splitlines()
        lines.insert(choose.randrange(len(lines)), choose.choice(LOOPS))
        script, how = b"\n".join(lines), "loop"
    else:
        script = _bytes(script, choose)
    case = OWN.encode().replace(b"own.msh", b"own.geo")
    files = _folder() | {"case.yaml": case, "own.geo": script}
    return Mutant(seed, f"own.geo, {how}", files, ("check", "case.yaml"))


def _checkpoint(seed: int, choose: random.Random, meshes: dict[str, bytes]) -> Mutant:
    """A checkpoint that a run is to go on from; with the right check sum where arrays change."""
    name = choose.choice(CHECKPOINTS)
    content, how = meshes[f"{name}.checkpoint"], "bytes"
    if choose.random() < 0.5:
        content = _bytes(content, choose)
    else:
        content, how = _arrays(content, choose, FORGERIES, forged=True)
    files = _folder() | {
        "case.yaml": CASES[name].encode(),
        "results/mesh.npz": meshes[name],
    }
    words = ("run", "case.yaml", "--resume")
    files["results/checkpoint.npz"] = content
    return Mutant(seed, f"checkpoint of {name}, {how}", files, words)


def _data(seed: int, choose: random.Random, meshes: dict[str, bytes]) -> Mutant:
    file = choose.choice(list(DATA))
    files = {name: text.encode() for name, text in DATA.items()}
    if file.endswith(".yaml"):
        files[file], how = _text(files[file], choose)
    elif choose.random() < 0.5:
        files[file], how = _bytes(files[file], choose), "bytes"
    else:
        files[file], how = _cells(files[file], choose), "cells"
    return Mutant(seed, f"data {file}, {how}", files, ("data",))


# ---------------------------------------------------------------- bytes


def _bytes(content: bytes, choose: random.Random) -> bytes:
    """One to eight changes of bytes."""
    found = bytearray(content)
    for _ in range(choose.choice((1, 1, 1, 2, 4, 8))):
        at = choose.randrange(len(found) + 1)
        end = min(len(found), at + choose.choice((1, 1, 2, 8, 64)))
        change = choose.randrange(8)
        if change <= 1 and at < len(found):
            found[at] ^= 1 << choose.randrange(8)
        elif change == 2 and at < len(found):
            found[at] = choose.randrange(256)
        elif change == 3:
            del found[at:end]
        elif change == 4:
            found[at:at] = found[at:end]
        elif change == 5:
            there = choose.randrange(len(found) + 1)
            found[there:there] = found[at:end]
        elif change == 6:
            found[at : choose.choice((at, end))] = choose.choice(WORDS)
        elif choose.random() < 0.3:
            del found[at:]
    return bytes(found)


def _cells(content: bytes, choose: random.Random, gap: bytes = b",") -> bytes:
    """Change cells and rows of a table."""
    rows = [line.split(gap) for line in content.splitlines()]
    for _ in range(choose.choice((1, 1, 2, 4))):
        row = choose.randrange(len(rows))
        cell = choose.randrange(len(rows[row])) if rows[row] else 0
        change = choose.randrange(8)
        if change >= 4 and rows[row]:
            rows[row][cell] = _other_cell(rows[row][cell], choose)
        elif change <= 1 and rows[row]:
            rows[row][cell] = choose.choice((*WORDS, *CELLS))
        elif change == 2 and rows[row]:
            del rows[row][cell]
        elif change == 3:
            rows[row].insert(cell, choose.choice(WORDS))
        else:
            rows.insert(row, list(rows[choose.randrange(len(rows))]))
    return b"\n".join(gap.join(row) for row in rows) + b"\n"


def _other_cell(cell: bytes, choose: random.Random) -> bytes:
    """Another number in the place of one; else the same."""
    try:
        value = float(cell)
    except ValueError:
        return cell
    if cell.strip().isdigit() and choose.random() < 0.7:
        return str(max(0, int(cell) + choose.choice((-2, -1, 1, 2)))).encode()
    return repr(value * choose.choice(FACTORS)).encode()


# ---------------------------------------------------------------- mappings


def _text(content: bytes, choose: random.Random) -> tuple[bytes, str]:
    """Change a YAML text as bytes or as a mapping; the text and how it was made."""
    if choose.random() < 0.25:
        return _bytes(content, choose), "bytes"
    values = yaml.safe_load(content)
    for _ in range(choose.choice((1, 1, 1, 1, 2, 2, 3, 6))):
        _change(values, choose)
    text = yaml.safe_dump(values, sort_keys=False, allow_unicode=choose.random() < 0.5)
    return text.encode(errors="replace"), "keys"


def _places(values, found=None) -> list:
    """(holder, key) of every value inside, deep ones too."""
    found = [] if found is None else found
    keys = values if isinstance(values, dict) else range(len(values))
    for key in list(keys):
        found.append((values, key))
        if isinstance(values[key], (dict, list)):
            _places(values[key], found)
    return found


def _change(values: dict, choose: random.Random) -> None:
    places = _places(values)
    if not places:
        return
    numbers = [(holder, key) for holder, key in places if _is_number(holder[key])]
    words = [(holder, key) for holder, key in places if key in WORDS_OF_KEYS]
    kind = choose.random()
    if kind < 0.4 and numbers:
        holder, key = choose.choice(numbers)
        holder[key] = _scaled(holder[key], choose)
        return
    if kind < 0.5 and numbers:
        holder, key = choose.choice(numbers)
        end = choose.choice(ENDS)
        holder[key] = round(end) if isinstance(holder[key], int) and end >= 1 else end
        return
    if kind < 0.55 and words:
        holder, key = choose.choice(words)
        holder[key] = choose.choice(WORDS_OF_KEYS[key])
        return
    if kind < 0.7:
        _add_key(values, choose)
        return
    holder, key = choose.choice(places)
    value, change = holder[key], choose.randrange(12)
    if _is_number(value) and change <= 6:
        holder[key] = _scaled(value, choose)
    elif change == 7:
        del holder[key]
    elif change == 8 and isinstance(holder, dict):
        holder[str(key)[::-1] + choose.choice(("", "s", "_mm"))] = holder.pop(key)
    elif change == 9 and isinstance(holder, dict):
        other, its_key = choose.choice(places)
        holder[key] = other[its_key] if not isinstance(other[its_key], (dict, list)) else 1
    elif change == 10 and key == "kind":
        holder[key] = choose.choice(KINDS)
    elif change == 11:  # all numbers of a section, or of a list
        for place, number in list(
            holder.items() if isinstance(holder, dict) else enumerate(holder)
        ):
            holder[place] = 0 * number if _is_number(number) else number
    elif isinstance(value, bool):
        holder[key] = not value
    else:
        holder[key] = choose.choice(VALUES)


def _add_key(values: dict, choose: random.Random) -> None:
    """A key that may be there, mostly where it belongs; a material has its keys at the top."""
    key = choose.choice(list(MORE_KEYS))
    section, choices = MORE_KEYS[key]
    holder = values.get(section, values) if section else values
    if not isinstance(holder, dict):
        holder = values[section] = {"extends": holder} if section == "material" else {}
    holder[key] = choose.choice(choices)


def _is_number(value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _scaled(value, choose: random.Random):
    """Another number, mostly one that could be meant; whole numbers mostly stay whole."""
    found = float(value) * choose.choice(FACTORS) if abs(value) < 1e300 else value
    whole = choose.random() < (0.8 if isinstance(value, int) else 0.1)
    return round(found) if whole and abs(found) < 1e300 else found


# ---------------------------------------------------------------- meshes


def _arrays(
    content: bytes, choose: random.Random, changes: tuple = (), forged: bool = False
) -> tuple[bytes, str]:
    """Change arrays of a mesh, or of a checkpoint that is `forged`, and write a whole .npz; its
    bytes and how it was made."""
    with np.load(io.BytesIO(content)) as file:
        arrays = {name: file[name] for name in file}
    random_numbers = np.random.default_rng(choose.getrandbits(32))
    names = []
    for _ in range(choose.choice((1, 1, 1, 1, 2, 3))):
        change = choose.choice(changes or CHANGES)
        try:
            change(arrays, choose, random_numbers)
        except (ArithmeticError, KeyError, IndexError, TypeError, ValueError):
            continue  # a change before this one left nothing to change
        names.append(change.__name__.strip("_"))
    if forged:
        arrays.pop("digest", None)
        arrays["digest"] = np.array(_digest(arrays))
    with io.BytesIO() as file:
        np.savez(file, **arrays)
        return file.getvalue(), "+".join(names) or "as it is"


def _one(array: np.ndarray, random_numbers) -> tuple:
    return tuple(int(random_numbers.integers(n)) for n in array.shape)


def _node_value(arrays, choose, random_numbers):
    nodes = arrays["nodes"]
    where = _one(nodes, random_numbers)
    values = (np.nan, np.inf, -np.inf, 1e300, -1e300, 1e-300, 0.0, -nodes[where], 2 * nodes[where])
    nodes[where] = choose.choice(values)


def _node_moved(arrays, choose, random_numbers):
    nodes = arrays["nodes"]
    i = int(random_numbers.integers(len(nodes)))
    nodes[i] += choose.choice((1e-9, 1e-6, 1e-4, 1e-3)) * random_numbers.normal(size=2)


def _all_scaled(arrays, choose, random_numbers):
    arrays["nodes"] = arrays["nodes"] * choose.choice((1e-30, 1e-9, 1e-3, 0.5, 2, 1e3, 1e9, -1, 0))


def _all_moved(arrays, choose, random_numbers):
    arrays["nodes"] = arrays["nodes"] + choose.choice((-1.0, 1e-3, 1.0, 1e6, 1e12))


def _two_nodes_at_one_place(arrays, choose, random_numbers):
    nodes = arrays["nodes"]
    i, j = random_numbers.integers(len(nodes), size=2)
    nodes[i] = nodes[j]


def _node_added(arrays, choose, random_numbers):
    arrays["nodes"] = np.vstack([arrays["nodes"], arrays["nodes"][:1]])


def _node_copied(arrays, choose, random_numbers):
    """One element takes a copy of a node: a cut, or a hinge."""
    triangles = arrays["triangles"]
    where = _one(triangles, random_numbers)
    arrays["nodes"] = np.vstack([arrays["nodes"], arrays["nodes"][triangles[where]]])
    triangles[where] = len(arrays["nodes"]) - 1


def _number(arrays, choose, random_numbers):
    name = choose.choice([name for name in arrays if arrays[name].dtype.kind == "i"])
    array = arrays[name]
    values = (-1, 0, 1, 2, len(arrays["nodes"]), 10**6, 2**31 - 1, -(2**31))
    array[_one(array, random_numbers)] = choose.choice(values)


def _turned(arrays, choose, random_numbers):
    triangles = arrays["triangles"]
    i = int(random_numbers.integers(len(triangles)))
    triangles[i] = triangles[i][::-1]


def _element_twice(arrays, choose, random_numbers):
    i = int(random_numbers.integers(len(arrays["triangles"])))
    for name in ("triangles", "body"):
        arrays[name] = np.concatenate([arrays[name], arrays[name][i : i + 1]])


def _elements_gone(arrays, choose, random_numbers):
    n = choose.choice((1, 1, 2, 10, len(arrays["triangles"]) - 1, len(arrays["triangles"])))
    gone = random_numbers.permutation(len(arrays["triangles"]))[:n]
    for name in ("triangles", "body"):
        arrays[name] = np.delete(arrays[name], gone, axis=0)


def _element_gone_with_its_nodes(arrays, choose, random_numbers):
    """A smaller mesh without a flaw of its own, unless it leaves a hinge."""
    gone = int(random_numbers.integers(len(arrays["triangles"])))
    for name in ("triangles", "body"):
        arrays[name] = np.delete(arrays[name], gone, axis=0)
    used, triangles = np.unique(arrays["triangles"], return_inverse=True)
    new = np.full(len(arrays["nodes"]), -1, np.int32)
    new[used] = np.arange(len(used))
    arrays["nodes"] = arrays["nodes"][used]
    arrays["triangles"] = triangles.reshape(-1, 3).astype(np.int32)
    for name in [name for name in arrays if name.startswith("edges:")]:
        edges = new[arrays[name]]
        arrays[name] = edges[(edges >= 0).all(axis=1)]


def _permuted(arrays, choose, random_numbers):
    order = random_numbers.permutation(len(arrays["triangles"]))
    arrays["triangles"], arrays["body"] = arrays["triangles"][order], arrays["body"][order]


def _array_gone(arrays, choose, random_numbers):
    del arrays[choose.choice(list(arrays))]


def _array_renamed(arrays, choose, random_numbers):
    name = choose.choice(list(arrays))
    arrays[choose.choice(("nodes", "edges:", "edges:x", "x", "format"))] = arrays.pop(name)


def _other_type(arrays, choose, random_numbers):
    name = choose.choice(list(arrays))
    kind = choose.choice(("f4", "f8", "i8", "i2", "u4", "c16", "U8", "S4", "?", "O", ">f8", "f2"))
    arrays[name] = arrays[name].astype(kind)


def _other_shape(arrays, choose, random_numbers):
    name = choose.choice(list(arrays))
    change = choose.randrange(5)
    array = arrays[name]
    shapes = (array.ravel(), array[:0], array[..., None], array.T, array[:-1])
    arrays[name] = np.ascontiguousarray(shapes[change])


def _object_inside(arrays, choose, random_numbers):
    arrays[choose.choice([*arrays, "more"])] = np.array([{"a": 1}], dtype=object)


def _bodies(arrays, choose, random_numbers):
    names = (["rock", "rock"], ["platen"], [""], [], ["rock", "x"], ["top_platen", "rock"])
    arrays["body_names"] = np.array(choose.choice(names), dtype="U12")


def _body_moved(arrays, choose, random_numbers):
    """Nodes of one body: a gap or an overlap."""
    own = arrays["body"] == random_numbers.integers(arrays["body"].max() + 1)
    nodes = np.unique(arrays["triangles"][own])
    arrays["nodes"][nodes] += choose.choice((1e-9, 1e-6, 1e-5, 1e-3)) * random_numbers.normal(
        size=2
    )


CHANGES = (
    _node_value, _node_moved, _node_moved, _all_scaled, _all_moved, _two_nodes_at_one_place,
    _node_added, _node_copied, _number, _number, _turned, _element_twice, _elements_gone,
    _element_gone_with_its_nodes, _element_gone_with_its_nodes, _permuted, _array_gone,
    _array_renamed, _other_type, _other_shape, _object_inside, _bodies, _body_moved, _body_moved,
)  # fmt: skip
# Of checkpoints: what a run looks at before it goes on.
FORGERIES = (_array_gone, _array_gone, _array_renamed, _other_type, _other_shape, _object_inside)
