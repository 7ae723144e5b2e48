"""What `lithofrac run` finds, may delete and resumes (pywrap/lithofrac/intake.py)."""

import json
import os
import signal

import pytest

from lithofrac.cli import main
from lithofrac.core import Run
from lithofrac.errors import CoreError
from lithofrac.results import checkpoint

SHORT = ["--set", "scene.element_size_mm=2.5", "--set", "output.records=20", "--quiet"]
MINE = ("table.parquet", "checkpoint_of_mine.npz", "fields/mine.vtu", "fields/frame_mine.vtu")


def files(folder) -> dict:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def finished(tmp_path):
    """Folder of a run that completed."""
    out = tmp_path / "out"
    assert main(["run", "bar_wave", *SHORT, "--out", str(out)]) == 0
    return out


def test_files_of_the_user_stay(finished):
    for name in MINE:
        (finished / name).write_text("mine")
    assert main(["run", "bar_wave", *SHORT, "--out", str(finished)]) == 0
    assert {(finished / name).read_text() for name in MINE} == {"mine"}


def test_an_empty_out_is_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as left:
        main(["run", "bar_wave", "--out", ""])
    assert left.value.code == 2
    assert "argument --out: empty, expected a path" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", ["run", "check"])
def test_what_the_core_refuses_is_bad_input_and_wipes_nothing(
    finished, monkeypatch, capsys, command
):
    def refusing(problem):
        raise CoreError("material 1: density is not positive")

    monkeypatch.setattr("lithofrac.run.plan", refusing)
    before = files(finished)
    out = ["--out", str(finished)] if command == "run" else []
    assert main([command, "bar_wave", *out]) == 2
    assert capsys.readouterr().err == "lithofrac: bar_wave: material 1: density is not positive\n"
    assert files(finished) == before


def test_a_run_does_not_replace_its_own_case_file(finished, capsys):
    before = files(finished)
    case = finished / "case.yaml"
    assert main(["run", str(case), "--out", str(finished)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --out {finished}: the run would replace its case file {case}\n"
    )
    assert files(finished) == before


def test_resume_without_a_checkpoint_is_bad_input(finished, tmp_path, capsys):
    new = tmp_path / "new"
    new.mkdir()
    (new / "mesh.npz").write_bytes((finished / "mesh.npz").read_bytes())
    assert main(["run", "bar_wave", *SHORT, "--resume", "--out", str(new)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --resume: {new}: there is no checkpoint to resume from\n"
    )
    assert [path.name for path in new.iterdir()] == ["mesh.npz"]


def test_resume_of_another_case_is_bad_input(finished, capsys):
    before = files(finished)
    other = ["--set", "loading.stress_MPa=2"]
    assert main(["run", "bar_wave", *SHORT, *other, "--resume", "--out", str(finished)]) == 2
    said = capsys.readouterr().err
    assert said.startswith("lithofrac: --resume: ")
    assert "belongs to another case, mesh or material" in said
    assert files(finished) == before


@pytest.mark.parametrize("threads", ["100000", "99999999999999999999", "-1", "1.5", "9" * 5000])
def test_threads_that_no_machine_has(tmp_path, capsys, threads):
    with pytest.raises(SystemExit) as left:
        main(["run", "bar_wave", "--out", str(tmp_path / "a"), "--threads", threads])
    assert left.value.code == 2
    assert "expected a whole number from 1 to " in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.fixture
def interrupted(tmp_path, monkeypatch):
    """Folder of a run that was stopped on its way."""
    out, advance, calls = tmp_path / "interrupted", Run.advance, []

    def stopping(self, steps, threads=1):
        advance(self, steps, threads)
        calls.append(steps)
        if len(calls) == 5:
            os.kill(os.getpid(), signal.SIGTERM)

    with monkeypatch.context() as patch:
        patch.setattr(Run, "advance", stopping)
        assert main(["run", "bar_wave", *SHORT, "--out", str(out)]) == 130
    return out


def first_step(folder, monkeypatch, *more):
    """Step at which `--resume-if-possible` begins."""
    steps, advance = [], Run.advance

    def noting(self, n, threads=1):
        steps.append(self.step)
        advance(self, n, threads)

    monkeypatch.setattr(Run, "advance", noting)
    words = ["run", "bar_wave", *SHORT, *more, "--resume-if-possible", "--out", str(folder)]
    assert main(words) == 0
    return steps[0]


def test_what_was_stopped_goes_on_if_possible(interrupted, monkeypatch, capsys):
    capsys.readouterr()
    assert first_step(interrupted, monkeypatch) > 0
    assert capsys.readouterr().err == ""


def test_no_folder_yet_is_a_new_run(tmp_path, monkeypatch, capsys):
    assert first_step(tmp_path / "new", monkeypatch) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("what", ["finished", "another case", "another build", "damaged"])
def test_what_is_not_this_run_stopped_is_run_anew(finished, interrupted, monkeypatch, capsys, what):
    """A run that is finished is wanted again because something has changed."""
    folder = finished if what == "finished" else interrupted
    more = ["--set", "loading.stress_MPa=2"] if what == "another case" else []
    if what == "another build":
        monkeypatch.setattr(checkpoint, "build", lambda: "another")
    if what == "damaged":
        (folder / checkpoint.PREVIOUS).unlink()
        (folder / checkpoint.NAME).write_bytes(b"PK")
    capsys.readouterr()
    assert first_step(folder, monkeypatch, *more) == 0
    assert capsys.readouterr().err == (
        f"lithofrac: {folder}: its checkpoint is not of this run, starting anew\n"
    )


def test_resume_with_another_build_is_noted(interrupted, monkeypatch, capsys):
    monkeypatch.setattr(checkpoint, "build", lambda: "another")
    capsys.readouterr()
    assert main(["run", "bar_wave", *SHORT, "--resume", "--out", str(interrupted)]) == 0
    note = (
        f"{interrupted / checkpoint.NAME}: made by another build, bits may differ from those of "
        "an unbroken run"
    )
    assert capsys.readouterr().err == f"lithofrac: {note}; going on from {checkpoint.NAME}\n"
    assert json.loads((interrupted / "summary.json").read_text())["notes"] == [note]


def test_half_files_of_a_killed_run_go(finished):
    parts = [".checkpoint.part.npz", ".history.part.parquet", "fields/.frame_0001.part.vtu"]
    for name in parts:
        (finished / name).write_text("half")
    assert main(["run", "bar_wave", *SHORT, "--out", str(finished)]) == 0
    assert not [name for name in parts if (finished / name).exists()]
