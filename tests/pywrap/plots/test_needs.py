"""Whatever a plot is given, it ends in a file or in one sentence (plots/needs.py)."""

from pathlib import Path

import pandas as pd
import pytest

from lithofrac.cli import main
from lithofrac.plots.draw import FIGURES, MOVIES, TABLES

pytestmark = pytest.mark.no_core

OUT = {"figure": "a.svg", "table": "a.csv", "movie": "a.gif"}
KINDS = [
    (what, kind)
    for what, known in (("figure", FIGURES), ("table", TABLES), ("movie", MOVIES))
    for kind in known
]
NO_RUNS = (
    "strength", "errors", "kirsch", "cracks", "bands", "punch", "single_element",
    "hole_initiation", "size_effect", "hole_fits", "options", "zigong", "zigong_fit",
)  # tables that a suite without such runs makes as well, and those of no input  # fmt: skip
NO_INPUT = ("zigong", "zigong_fit")
# Of what is no results folder, kind -> files.
FILES = {
    "single_element": ("triaxial_p10.parquet",),
    "measured": ("rock.yaml",),
    "stability": ("stability_limit.csv", "stability.csv"),
    "accuracy": ("accuracy.csv",),
    "speed": ("benchmark.json", "leave_out.csv", "growth.csv"),
    "study": ("study.yaml",),
    "variants": ("suite.yaml",),
    "options": ("rock.yaml",),
    "tautona": ("rock.yaml",),
    "zigong_prediction": ("rock.yaml",),
    "zigong_prediction_error": ("rock.yaml",),
    "results": ("bands.csv", "rock.yaml"),
    "run_time": ("bands.csv",),
    "claims": ("claims_bands.csv",),
    "hole_checks": ("bands.csv",),
    "speed_rows": ("benchmark.json",),
    "speed_targets": ("benchmark.json",),
    "hole_initiation": ("hole_initiation.csv",),
    "hole_fits": ("hole_initiation.csv",),
}
GARBAGE = {
    "nothing": b"",
    "bytes": b"PAR1\x00\xff\xfe{]" + bytes(range(256)),
    "rows": b"a,b\n1,2\n1,2,3,4\n",
    "json": b'{"rows": [1, {"name": 3}]}',
    "yaml": b"title: A case\nscene: {kind: hole}\n",
}


@pytest.fixture
def tried(tmp_path, capsys):
    """tried(what, kind, inputs): exit code and words of a plot, which leaves no half a file."""

    def attempt(what, kind, inputs):
        out = tmp_path / "drawn" / OUT[what]
        out.unlink(missing_ok=True)
        code = main(["plot", kind, *map(str, inputs), "--out", str(out)])
        said = capsys.readouterr().err
        print(code, said)
        assert out.exists() == (code == 0)
        assert code in (0, 2)
        lines = said.splitlines()  # of a case one a mistake
        assert all(line.startswith("lithofrac: ") and len(line) < 600 for line in lines)
        assert code == 0 or lines
        return code

    return attempt


@pytest.mark.parametrize(("what", "kind"), KINDS)
def test_no_input(tried, what, kind):
    assert tried(what, kind, []) == (0 if what == "table" and kind in NO_RUNS else 2)


@pytest.fixture
def bar(make_run):
    """Folder of a run without an axial measure, fields, probes and cracks."""
    folder = make_run("bar_wave", test="bar")
    path = folder / "history.parquet"
    pd.read_parquet(path)[["time_s", "step"]].assign(
        top_force_N=0.0, top_displacement_mm=0.0
    ).to_parquet(path)
    return folder


DRAWS_ANY = ("curves", "energy", "run_time")


@pytest.mark.parametrize(("what", "kind"), KINDS)
def test_a_run_of_another_kind(tried, bar, what, kind):
    code = tried(what, kind, [bar])
    if what != "table" and kind not in DRAWS_ANY:
        assert code == 2


@pytest.mark.parametrize("content", GARBAGE.values(), ids=GARBAGE)
@pytest.mark.parametrize(("what", "kind"), KINDS)
def test_damaged_files(tried, make_cracked_run, tmp_path, what, kind, content):
    """All files of a results folder, and those that a kind takes beside them."""
    folder = make_cracked_run("hole_r25.0")
    for path in folder.rglob("*.*"):
        if path.is_file() and path.name != "summary.json":
            path.write_bytes(content)
    files = [tmp_path / name for name in FILES.get(kind, ())]
    for path in files:
        path.write_bytes(content)
    for inputs in ([folder], files, [*files, folder]):
        if inputs:
            tried(what, kind, inputs)


@pytest.mark.parametrize("name", ["history", "energy", "cracks"])
@pytest.mark.parametrize(("what", "kind"), KINDS)
def test_a_table_of_other_columns_or_without_rows(tried, make_cracked_run, what, kind, name):
    folder = make_cracked_run("a")
    path = folder / f"{name}.parquet"
    table = pd.read_parquet(path)
    for other in (pd.DataFrame({"time_s": [0.0, 1.0]}), table[:0]):
        other.to_parquet(path)
        tried(what, kind, [folder])


@pytest.mark.parametrize(("what", "kind"), KINDS)
def test_a_yaml_file_or_an_empty_one(tried, tmp_path, what, kind):
    for name in ("z.yaml", "z.csv", "z.parquet", "z.txt"):
        (tmp_path / name).write_bytes(GARBAGE["yaml"] if name == "z.yaml" else b"")
        for count in (1, 2):
            assert tried(what, kind, count * [tmp_path / name]) == (0 if kind in NO_INPUT else 2)


@pytest.mark.parametrize(("what", "kind"), KINDS)
def test_a_folder_that_is_none_of_a_run(tried, tmp_path, what, kind):
    (tmp_path / "empty").mkdir()
    for path in (tmp_path / "empty", Path("/dev/null")):
        assert tried(what, kind, [path]) == (0 if kind in NO_INPUT else 2)
