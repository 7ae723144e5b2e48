"""Drift against references (analysis/scalars.py, references.py, regression.py)."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from lithofrac.analysis.references import make, read, write
from lithofrac.analysis.regression import compare, sentences
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.analysis.scalars import TABLES, mesh_hash, scalars
from lithofrac.cli import main
from lithofrac.data import DataError
from lithofrac.plots.draw import TABLES as ALL_TABLES
from lithofrac.problem import Mesh

ROOT = Path(__file__).parents[3]
no_core = pytest.mark.no_core
# Tables that a regression leaves alone, and why.
NOT_WATCHED = {
    "single_element": "driven point, held against its closed form by tests",
    "options": "driven point, held against the table of the sheet by tests",
    "errors": "moves with every digitised curve",
    "tautona": "measured",
    "zigong": "measured",
    "zigong_fit": "measured",
    **dict.fromkeys(("zigong_prediction", "zigong_prediction_error"), "measured"),
    **dict.fromkeys(("size_effect", "hole_fits", "hole_checks"), "made of hole_initiation"),
    "claims": "verdicts on runs that are watched",
    "variants": "differences between runs that are watched",
    "study": "of the files of users",
    **dict.fromkeys(("speed_rows", "speed_targets"), "of the machine"),
    "run_time": "of the machine; the rest stands in summary.json",
    "results": "words made of the other tables",
}


@pytest.fixture
def finished(tmp_path):
    """finished(name, build, x, **changes of summary.json) -> folder of a run with a small mesh."""

    def made(name, build="portable", x=1.0, **changes):
        folder = tmp_path / build / name
        folder.mkdir(parents=True, exist_ok=True)
        nodes = np.array([[0.0, 0.0], [x, 0.0], [0.0, 1.0]])
        edges = {"bottom": np.array([[0, 1]], dtype=np.int32)}
        body = np.zeros(1, dtype=np.int32)
        mesh = Mesh(nodes, np.array([[0, 1, 2]], dtype=np.int32), body, ("rock",), edges)
        mesh.save(folder / "mesh.npz")
        (folder / "case.yaml").write_text(yaml.safe_dump({"scene": {"kind": "bar"}}))
        summary = {
            "status": "completed", "case": name, "version": "0.1.0", "commit": "0123456789ab",
            "native": build == "native", "elements": 1, "steps": 100, "cracks": 20,
            "peak_stress_MPa": 100.0, "peak_strain": None, "energy_residual": 1e-9,
            "core_seconds": 1.0, "wall_seconds": 1.0, "threads": 1, "notes": [],
            "energy": {"external_J": 50.0, "kinetic_J": 1e-3, "residual_J": 1e-12},
        }  # fmt: skip
        (folder / "summary.json").write_text(json.dumps(summary | changes))
        return folder

    return made


@pytest.fixture
def references(finished, tmp_path, data_folder):
    """Folder with references of two cases, `a` and `b`, and two more meshes of `a`."""
    runs = [finished("a"), finished("b"), finished("a@seed2", cracks=23)]
    runs.append(finished("a@seed3", cracks=18))
    twins = [finished("a", "native"), finished("b", "native")]
    numbers, meshes = make(find_runs(runs), find_runs(twins), data_folder)
    folder = tmp_path / "references"
    write(folder, numbers, meshes, "the first ones", find_runs(runs))
    return folder


@pytest.fixture
def held(references, data_folder):
    """held(folders) -> comparison with the references, and its lines."""

    def made(*folders):
        known = read(references)
        found = compare(find_runs(list(folders)), known, data_folder)
        return found, sentences(found, known)

    return made


def tolerance_of(folder, case, quantity):
    rows = pd.read_csv(folder / "numbers.csv").set_index(["case", "quantity"])
    return tuple(rows.loc[(case, quantity), ["kind", "tolerance", "reason"]])


@no_core
def test_runs_that_made_the_references_have_not_drifted(held, finished):
    found, lines = held(finished("a"), finished("b"))
    assert not found.drifted
    assert found.compared == 16
    assert lines[0].startswith("16 numbers compared: 0 moved, 0 missing, 0 new")
    assert lines[1].endswith("commit 0123456789ab: the first ones")


@no_core
def test_number_that_moved_is_named_with_its_amount(held, finished):
    found, lines = held(finished("a"), finished("b", peak_stress_MPa=101.0))
    assert found.drifted
    assert lines[0] == "b:"
    assert lines[1].split() == [
        "peak_stress_MPa", "100", "->", "101", "+1", "%,", "allowed", "0.0001", "(rounding)",
    ]  # fmt: skip
    assert lines[2].startswith("16 numbers compared: 1 moved")


@no_core
def test_counts_may_move_by_the_spread_of_the_realisations(held, finished, references):
    assert tolerance_of(references, "a", "cracks") == ("absolute", 5.0, "realisations")
    assert tolerance_of(references, "b", "cracks") == ("absolute", 0.0, "exact")
    assert not held(finished("a", cracks=25), finished("b"))[0].drifted
    assert list(held(finished("a", cracks=26), finished("b"))[0].moved["now"]) == [26]
    assert held(finished("a"), finished("b", cracks=21))[0].drifted


@no_core
def test_cracks_that_vanish_have_moved_however_far_their_count_spreads(held, finished, references):
    numbers = pd.read_csv(references / "numbers.csv")
    wide = (numbers["case"] == "a") & (numbers["quantity"] == "cracks")
    numbers.loc[wide, "tolerance"] = 1e3
    numbers.to_csv(references / "numbers.csv", index=False)
    assert not held(finished("a", cracks=1), finished("b"))[0].drifted
    assert list(held(finished("a", cracks=0), finished("b"))[0].moved["quantity"]) == ["cracks"]


@no_core
def test_energies_are_held_by_the_largest_of_their_run(held, finished):
    near = {"external_J": 50.0, "kinetic_J": 1e-3 + 4e-5, "residual_J": 1.0}
    assert not held(finished("a", energy=near), finished("b"))[0].drifted
    far = near | {"kinetic_J": 1e-3 + 6e-5}
    assert held(finished("a", energy=far), finished("b"))[0].drifted


@no_core
def test_residual_is_noise_below_its_limit(held, finished):
    assert not held(finished("a", energy_residual=9e-7), finished("b"))[0].drifted
    assert held(finished("a", energy_residual=2e-6), finished("b"))[0].drifted


@no_core
def test_rounding_that_grew_gives_way_to_the_spread(finished, data_folder):
    runs = [finished("a"), finished("a@seed2", peak_stress_MPa=104.0)]
    twin = finished("a", "native", peak_stress_MPa=100.01)
    numbers, _ = make(find_runs(runs), find_runs([twin]), data_folder)
    rows = numbers.set_index("quantity")
    assert tuple(rows.loc["peak_stress_MPa", ["tolerance", "reason"]]) == (4.0, "realisations")
    assert rows.loc["cracks", "tolerance"] == 1.0  # it agrees by chance


@no_core
def test_missing_case_is_drift_and_a_new_number_is_said(held, finished):
    found, lines = held(finished("a", crack_angle_deg=30.0))
    assert found.drifted
    assert set(found.missing["case"]) == {"b"}
    assert "a: new, without a reference: crack_angle_deg" in lines
    assert any(line.startswith("b: missing: cracks, elements") for line in lines)
    found, _ = held(finished("a", crack_angle_deg=30.0), finished("b"))
    assert not found.drifted


@no_core
def test_changed_mesh_is_said_first(held, finished):
    found, lines = held(finished("a", x=1.1, peak_stress_MPa=1.0), finished("b"))
    assert found.drifted
    assert lines[0].startswith("a: the mesh is another one")
    assert not held(finished("a", x=1.0 + 1e-12), finished("b"))[0].meshes


@no_core
@pytest.mark.parametrize("part", ["nodes", "triangles", "edge_sets"])
def test_mesh_hash_sees_every_part(finished, part):
    folder = finished("a")
    before, mesh = mesh_hash(Run(folder)), Mesh.load(folder / "mesh.npz")
    if part == "nodes":
        mesh.nodes[1, 0] += 1e-8
    elif part == "triangles":
        mesh.triangles[0] = mesh.triangles[0, [1, 2, 0]]
    else:
        mesh.edge_sets["bottom"][0] = [1, 2]
    mesh.save(folder / "mesh.npz")
    assert mesh_hash(Run(folder)) != before


@no_core
def test_number_that_is_not_there_moves_when_it_comes_and_the_other_way(held, finished):
    for changes in ({"peak_strain": 0.01}, {"peak_stress_MPa": None}):
        found, lines = held(finished("a", **changes), finished("b"))
        assert list(found.moved["quantity"]) == list(changes)
        assert "none" in lines[1]


@no_core
def test_run_that_did_not_complete_is_refused(finished, data_folder):
    with pytest.raises(DataError, match="'failed', expected a completed run"):
        scalars([Run(finished("a", status="failed"))], data_folder)


@no_core
def test_native_runs_make_no_references(finished, data_folder):
    native, portable = find_runs([finished("a", "native")]), find_runs([finished("a")])
    with pytest.raises(DataError, match="not of a native=false build"):
        make(native, native, data_folder)
    with pytest.raises(DataError, match="no run of a native build beside it"):
        make(portable, portable, data_folder)


@no_core
@pytest.mark.parametrize("why", ["", "  \n"])
def test_references_without_a_reason_are_refused_and_nothing_is_written(
    references, finished, why, capsys
):
    before = {path: path.read_text() for path in references.iterdir()}
    words = ["references", str(finished("a")), "--twin", str(finished("a", "native"))]
    assert main([*words, "--why", why, "--references", str(references)]) == 2
    assert "no reason" in capsys.readouterr().err
    assert {path: path.read_text() for path in references.iterdir()} == before


@no_core
def test_update_adds_a_line_that_says_when_and_why(references, finished):
    words = ["references", str(finished("a", commit="abc")), str(finished("a@seed2"))]
    words += ["--twin", str(finished("a", "native"))]
    assert main([*words, "--why", "finer,\n ramps", "--references", str(references)]) == 0
    lines = pd.read_csv(references / "updates.csv")
    assert list(lines["why"]) == ["the first ones", "finer, ramps"]
    assert list(lines["cases"]) == [2, 1]
    assert list(lines["commit"]) == ["0123456789ab", "0123456789ab abc"]
    assert lines["date"].str.fullmatch(r"\d{4}-\d\d-\d\d \d\d:\d\d UTC").all()


@no_core
def test_exit_code_says_whether_anything_moved(references, finished, capsys):
    words = ["--references", str(references)]
    folders = [str(finished("a")), str(finished("b"))]
    assert main(["compare", *folders, *words]) == 0
    finished("b", cracks=7)
    assert main(["compare", *folders, *words]) == 4
    assert "cracks" in capsys.readouterr().out
    assert main(["compare", *folders, "--references", "nowhere"]) == 2
    assert main(["compare", "no_run", *words]) == 2


@no_core
def test_every_table_is_watched_or_left_alone_for_a_reason():
    assert set(TABLES) | set(NOT_WATCHED) == set(ALL_TABLES)
    assert not set(TABLES) & set(NOT_WATCHED)


@no_core
def test_tables_are_watched_by_case_and_point(make_cracked_run, data_folder):
    folder = make_cracked_run("sandstone_soft_p00", confinement=0.0)
    summary = json.loads((folder / "summary.json").read_text()) | {"energy": {}}
    (folder / "summary.json").write_text(json.dumps(summary))
    found = scalars([Run(folder)], data_folder).set_index("quantity")
    assert found.loc["cracks", "nature"] == "count"
    assert found.loc["bands.median_crack_angle_deg", "nature"] == "picked"
    assert found.loc["cracks.tensile_percent", "value"] == pytest.approx(200.0 / 3.0)
    assert found.loc["strength.strength_MPa", "value"] == pytest.approx(100.16, abs=0.01)


def test_one_case_of_the_quick_suite_is_where_its_references_are(tmp_path, data_folder):
    """The real comparison, on any build: rounding does not reach this continuum case."""
    name, folder = "sandstone_triaxial_p10", tmp_path / "sandstone_triaxial_p10"
    suite = str(ROOT / "configs" / "suite_quick.yaml")
    assert main(["run", name, "--suite", suite, "--out", str(folder), "--quiet"]) == 0
    known = read(ROOT / "tests" / "references").of([name])
    found = compare([Run(folder)], known, data_folder)
    assert not found.drifted, "\n".join(sentences(found, known))
    assert found.compared > 30
