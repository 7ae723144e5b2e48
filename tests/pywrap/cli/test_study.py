"""Own projects and studies (pywrap/lithofrac/project.py, study.py, pywrap/rules/study.smk).

Every command runs as a user would run it: as a process, outside the checkout.
"""

import fcntl
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from lithofrac import study as starting
from lithofrac.analysis.study import SUMMARY
from lithofrac.cli import main
from lithofrac.config.cost import OWN_ELEMENTS, Cost
from lithofrac.results.columns import ENERGY_COLUMNS

pytestmark = pytest.mark.no_core  # it runs cases, but what is tested is the study around them

CASE = Path("configs/cases/single_element.yaml").resolve()
STUDY = f"""\
title: Rate
base: {CASE}
set: {{loading.end_strain: 0.001}}
grid: {{loading.speed_m_s: [0.1, 0.2]}}
name: v{{loading.speed_m_s}}
quantities: [peak_stress_MPa]
plot: {{x: loading.speed_m_s, y: [peak_stress_MPa]}}
"""


def lithofrac(folder, *words):
    return subprocess.run(
        [sys.executable, "-m", "lithofrac", *words],
        cwd=folder, capture_output=True, text=True, timeout=600,
    )  # fmt: skip


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """Folder of `lithofrac init`, with its study run as its README says."""
    empty = tmp_path_factory.mktemp("empty")
    made = lithofrac(empty, "init", "mine")
    assert (made.returncode, made.stderr) == (0, "")
    readme = (empty / "mine" / "README.md").read_text()
    commands = re.findall(r"^lithofrac ([^#\n]*)", readme, re.MULTILINE)
    assert [command.split()[0] for command in commands] == ["check", "run", "study"]
    for command in commands:
        done = lithofrac(empty / "mine", *command.split())
        assert done.returncode == 0, done.stderr
    return empty / "mine"


def ran(done):
    """Runs that a call of `lithofrac study` started."""
    assert done.returncode == 0, done.stderr
    return re.findall(r"^Mesh and run (\S+)$", done.stderr, re.MULTILINE)


def test_a_new_user_comes_to_a_figure_of_an_own_study(project):
    out = project / "out" / "study"
    table = pd.read_parquet(out / "table.parquet")
    assert len(table) == 6
    assert table["peak_stress_MPa"].between(50.0, 300.0).all()
    assert table["loading.confinement_MPa"].nunique() == 3
    figure = (out / "figure.svg").read_text()
    assert figure.startswith("<?xml") and len(figure) > 5000
    assert (project / "out" / "case" / "fields.pvd").exists()


def test_quantities_that_are_known_are_those_of_a_run(project):
    summary = json.loads((project / "out" / "case" / "summary.json").read_text())
    numbers = {
        name
        for name, value in summary.items()
        if value is None or (isinstance(value, int | float) and not isinstance(value, bool))
    }
    assert set(SUMMARY) == numbers - {"commit"}
    assert set(ENERGY_COLUMNS) == set(summary["energy"])


def test_only_what_changed_is_run(project):
    command = ("study", "study.yaml", "--out", "out/study")
    assert ran(lithofrac(project, *command)) == []
    study, rock = project / "study.yaml", project / "rock.yaml"
    text = study.read_text()
    study.write_text(text.replace("[0, 5, 10]", "[0, 5]"))
    assert ran(lithofrac(project, *command)) == []
    assert len(pd.read_parquet(project / "out" / "study" / "table.parquet")) == 4
    study.write_text(text.replace("[0, 5, 10]", "[0, 7]").replace("[0.01, 0.3]", "[0.01]"))
    assert ran(lithofrac(project, *command)) == ["confinement_MPa_7_rock-platen_0.01"]
    rock.write_text(rock.read_text().replace("2800.0", "2700.0  # measured"))
    assert len(ran(lithofrac(project, *command))) == 2


def test_init_refuses_to_overwrite(tmp_path, capsys):
    folder = tmp_path / "mine"
    folder.mkdir()
    assert main(["init", str(folder)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: {folder}: is there already, expected a new name; nothing was changed\n"
    )
    assert list(tmp_path.rglob("*")) == [folder]


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.yaml"
    path.write_text(STUDY)
    return path


def test_without_a_folder_the_runs_are_listed(study, capsys):
    assert main(["study", str(study)]) == 0
    assert capsys.readouterr().out == (
        "v0.1: loading.speed_m_s = 0.1\n"
        "v0.2: loading.speed_m_s = 0.2\n"
        "2 runs are right; --out DIR runs them\n"
    )
    assert list(study.parent.iterdir()) == [study]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "loading.speed_m_s: [0.1, 0.2]",
            "loading.speed_m_s: [0.1, -0.2]",
            "{file}: grid: loading.speed_m_s = -0.2: expected a number from 1e-09 to 10000"
            " (run v-0.2)",
        ),
        (
            "loading.end_strain",
            "loading.end_stran",
            "{file}: set: loading.end_stran: unknown key, did you mean 'end_strain'?"
            " (run v0.1 and 1 more)",
        ),
        (
            "quantities: [",
            "quantities: [peak, ",
            "{file}: quantities.0 = peak: no such quantity, expected one of: ",
        ),
    ],
    ids=["value", "key", "quantity"],
)
def test_a_wrong_study_starts_nothing(study, capsys, old, new, message):
    study.write_text(STUDY.replace(old, new))
    assert main(["study", str(study), "--out", str(study.parent / "out")]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith(f"lithofrac: {message.format(file=study)}")
    assert len(said.err.splitlines()) == 1
    assert list(study.parent.iterdir()) == [study]


def test_the_folder_of_the_study_is_no_results_folder(study, capsys):
    assert main(["study", str(study), "--out", str(study.parent)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --out {study.parent}: holds the study file itself, expected another folder\n"
    )
    assert list(study.parent.iterdir()) == [study]


def test_two_studies_do_not_share_a_folder(study, capsys):
    out = study.parent / "out"
    (out / "log").mkdir(parents=True)
    with open(out / "log" / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert main(["study", str(study), "--out", str(out)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --out {out}: another study is at work there, expected a folder of its own\n"
    )
    assert not list((out / "cases").iterdir())


def test_a_run_that_fails_is_named_and_the_others_are_kept(study):
    study.write_text(STUDY.replace("[0.1, 0.2]", "[0.1, 1e-9]"))
    done = lithofrac(study.parent, "study", "study.yaml", "--out", "out", "--quiet")
    assert (done.returncode, done.stdout) == (3, "")
    said = done.stderr.splitlines()
    assert len(said) == 1
    assert said[0].startswith("lithofrac: v1e-09: cases/v1e-09.yaml: loading.speed_m_s = 1e-09: ")
    assert (study.parent / "out/runs/v0.1/summary.json").exists()
    assert not (study.parent / "out/table.parquet").exists()
    study.write_text(STUDY.replace("[0.1, 0.2]", "[0.1]"))
    assert ran(lithofrac(study.parent, "study", "study.yaml", "--out", "out")) == []
    assert len(pd.read_parquet(study.parent / "out/table.parquet")) == 1


def test_a_study_that_is_stopped_leaves_no_run_behind_and_goes_on(study):
    study.write_text(STUDY.replace("[0.1, 0.2]", "[0.0001, 0.0002]"))  # minutes
    with subprocess.Popen(
        [sys.executable, "-m", "lithofrac", "study", "study.yaml", "--out", "out", "--cores", "1"],
        cwd=study.parent, stderr=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        process.stderr.readline()  # the first run has begun
        process.send_signal(signal.SIGTERM)
        said = process.stderr.read()
    assert process.returncode == 130
    assert "lithofrac: interrupted" in said
    assert not _running_below(study.parent)
    study.write_text(STUDY)
    assert len(ran(lithofrac(study.parent, "study", "study.yaml", "--out", "out"))) == 2
    assert (study.parent / "out/figure.svg").exists()


def _running_below(folder):
    """Processes whose working folder is in `folder`."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            here = os.readlink(process / "cwd")
        except OSError:  # ended, or another user's
            continue
        if here.startswith(str(folder)):
            found.append(process.name)
    return found


def test_profile_that_is_not_there_is_refused_before_anything_is_written(study, tmp_path, capsys):
    out = tmp_path / "nothing"
    assert main(["study", str(study), "--out", str(out), "--profile", "lsf"]) == 2
    assert capsys.readouterr().err == (
        "lithofrac: --profile lsf: no such profile, expected a folder that holds config.yaml, or "
        "one of: pbs, slurm\n"
    )
    assert not out.exists()


BLOCK = """\
h = 10;
Point(1) = {0, 0, 0}; Point(2) = {40, 0, 0}; Point(3) = {40, 60, 0}; Point(4) = {0, 60, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Physical Surface("pillar") = {1}; Physical Curve("floor") = {1}; Physical Curve("roof") = {3};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;
"""
PILLAR = """\
title: Pillar
material: sandstone
scene: {kind: gmsh_file, file: block.geo, length_unit: mm}
loading:
  kind: boundaries
  held: {floor: xy}
  driven: {roof: {x_mm: 0, y_mm: -0.01}}
  speed_m_s: 0.4
  axial: roof
"""
PILLARS = """\
title: Pillars
base: pillar.yaml
grid: {loading.speed_m_s: [0.4]}
name: v{loading.speed_m_s}
quantities: [elements]
plot: {x: loading.speed_m_s, y: [elements]}
"""


def test_a_study_follows_the_geometry_file_of_its_base(tmp_path):
    """Named by a relative path, as the guide does it; an edited file is meshed and run again."""
    mine = tmp_path / "mine"
    mine.mkdir()
    for name, text in (("block.geo", BLOCK), ("pillar.yaml", PILLAR), ("s.yaml", PILLARS)):
        (mine / name).write_text(text)

    def elements():
        done = lithofrac(tmp_path, "study", "mine/s.yaml", "--out", "out")
        assert done.returncode == 0, done.stderr
        return pd.read_parquet(tmp_path / "out" / "table.parquet")["elements"].tolist()

    coarse = elements()
    assert elements() == coarse
    (mine / "block.geo").write_text(BLOCK.replace("h = 10", "h = 5"))
    (fine,) = elements()
    assert fine > 3 * coarse[0]


HOLES = f"""\
title: Friction of two holes
base: {Path("configs/examples/two_holes.yaml").resolve()}
grid: {{contact.default_friction: [0.2, 0.4]}}
name: f{{contact.default_friction}}
quantities: [peak_stress_MPa]
plot: {{x: contact.default_friction, y: [peak_stress_MPa]}}
"""


def test_an_own_geometry_asks_a_cluster_for_what_its_mesh_takes(tmp_path, monkeypatch):
    """By elements and steps of the mesh, made once for both runs, instead of a fixed guess."""
    import lithofrac.meshed_cost

    meshed, make_mesh = [], lithofrac.meshed_cost.make_mesh
    monkeypatch.setattr(
        lithofrac.meshed_cost, "make_mesh", lambda case: meshed.append(case) or make_mesh(case)
    )
    file, out = tmp_path / "study.yaml", tmp_path / "out"
    file.write_text(HOLES)
    study, texts = starting.checked(file)
    costs = starting.own_costs(study)
    assert list(costs) == ["f0.2", "f0.4"]
    assert len(meshed) == 1
    cost = Cost(**costs["f0.2"])
    assert cost.elements == len(make_mesh(study.case("f0.2")).triangles) != OWN_ELEMENTS
    (out / "cases").mkdir(parents=True)
    starting._write_inputs(file, texts, out, costs)
    done = subprocess.run(
        [*(sys.executable, "-P", "-m", "snakemake", "--snakefile", str(starting.RULES)),
         *("--directory", str(out), "--dry-run")],
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    said = done.stdout + done.stderr
    assert cost.group == "short"  # the fixed guess is not
    assert said.count("Group job short") == 2, said
