"""Pipes, devices and folders in the place of files are refused (plain_file.py)."""

import os
import signal

import pytest

from lithofrac.cli import main

pytestmark = pytest.mark.no_core

CASE = """\
title: A bar
material: ./rock.yaml
scene: {kind: bar, height_mm: 20.0, width_mm: 5.0, element_size_mm: 2.5}
loading: {kind: traction, stress_MPa: 1.0, ramp_transits: 1.0, hold_transits: 1.0}
"""
OWN = """\
title: One of my own
material: sandstone
scene: {kind: gmsh_file, file: NAME, length_unit: mm}
loading: {kind: boundaries, pressed_MPa: {top: 1.0}}
"""
# Words of a command, and the file of it that never ends.
COMMANDS = {
    "fit": (["fit", "tests.csv", "--base", "sandstone", "--out", "out.yaml"], "tests.csv"),
    "base": (["fit", "right.csv", "--base", "rock.yaml", "--out", "out.yaml"], "rock.yaml"),
    "case": (["check", "case.yaml"], "case.yaml"),
    "material": (["check", "case.yaml"], "rock.yaml"),
    "suite": (["check", "a", "--suite", "suite.yaml"], "suite.yaml"),
    "mesh": (["run", "bar_wave", "--mesh", "a.npz", "--out", "out"], "a.npz"),
    "geo": (["check", "own.yaml"], "own.geo"),
    "msh": (["check", "own.yaml"], "own.msh"),
    "study": (["study", "study.yaml"], "study.yaml"),
    "show": (["show", "run"], "run/summary.json"),
    "compare": (["compare", "run", "--references", "."], "numbers.csv"),
    "report": (["report", "out", "--out", "a.md"], "out/tables/a.csv"),
    "table": (["plot", "accuracy", "a.csv", "--out", "a.svg"], "a.csv"),
    "energy": (["plot", "energy", "run", "--out", "a.svg"], "run/energy.parquet"),
    "fields": (["plot", "pattern", "run", "--out", "a.svg"], "run/fields.pvd"),
    "benchmark": (["plot", "speed_rows", "benchmark.json", "--out", "a.csv"], "benchmark.json"),
}


@pytest.fixture
def in_time():
    """Ends a test that waits for a file."""

    def late(number, frame):
        raise TimeoutError("the file was read without end")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(60)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("what", ["pipe", "device", "folder"])
@pytest.mark.parametrize(("words", "name"), COMMANDS.values(), ids=COMMANDS)
def test_what_never_ends_is_refused_in_one_sentence(
    tmp_path, monkeypatch, capsys, in_time, what, words, name
):
    configs = os.path.abspath("configs")
    monkeypatch.chdir(tmp_path)
    os.symlink(configs, "configs")
    (tmp_path / "right.csv").write_text("confinement_MPa,strength_MPa\n0,100\n10,150\n")
    (tmp_path / "case.yaml").write_text(CASE)
    (tmp_path / "own.yaml").write_text(OWN.replace("NAME", name))
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "summary.json").write_text('{"status": "completed"}')
    (tmp_path / "run" / "case.yaml").write_text("scene: {kind: bar}\n")
    path = tmp_path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    if what == "pipe":
        os.mkfifo(path)
    elif what == "folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero")
    assert main(words) == 2
    said = capsys.readouterr().err
    assert said.startswith("lithofrac: ")
    assert said.count("\n") == 1
    assert name.split("/")[-1] in said or "run: holds no summary.json" in said


@pytest.mark.parametrize("name", ["fit", "geo", "report", "table", "show", "benchmark"])
def test_what_is_larger_than_any_such_file_is_refused(tmp_path, monkeypatch, capsys, in_time, name):
    words, name = COMMANDS[name]
    configs = os.path.abspath("configs")
    monkeypatch.chdir(tmp_path)
    os.symlink(configs, "configs")
    (tmp_path / "own.yaml").write_text(OWN.replace("NAME", name))
    path = tmp_path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "wb") as file:
        file.truncate(1_000_000_000_000)  # a hole: it takes no disk
    assert main(words) == 2
    said = capsys.readouterr().err
    assert f"{name}: is larger than 1e+07 bytes, expected " in said
    assert said.count("\n") == 1
