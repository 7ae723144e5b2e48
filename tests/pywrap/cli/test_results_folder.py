"""What `lithofrac run` finds, may delete and resumes (pywrap/lithofrac/intake.py)."""

import json
import os
import signal

import numpy as np
import pytest

from lithofrac.cli import main
from lithofrac.config import load_case
from lithofrac.core import Run
from lithofrac.errors import CoreError
from lithofrac.results import checkpoint
from lithofrac.results.files import MARK

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

    monkeypatch.setattr("lithofrac.plan.plan", refusing)
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
    why = {"finished": "its run has come to its end", "another build": "another build has made it"}
    said = why.get(what, "its checkpoint is not of this run")
    assert capsys.readouterr().err == f"lithofrac: {folder}: {said}, starting anew\n"


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


def test_resume_with_other_guards_keeps_the_case_in_force(interrupted):
    """Guards may change on the way; the copy of the case says those of now."""
    stop = "guards.speed_stop"
    assert load_case(interrupted / "case.yaml").guards.speed_stop != 0.3
    words = ["run", "bar_wave", *SHORT, "--set", f"{stop}=0.3", "--resume"]
    assert main([*words, "--out", str(interrupted)]) == 0
    assert load_case(interrupted / "case.yaml").guards.speed_stop == 0.3


def test_half_files_of_a_killed_run_go(finished):
    parts = [".checkpoint.part.npz", ".history.part.parquet", "fields/.frame_0001.part.vtu"]
    for name in parts:
        (finished / name).write_text("half")
    assert main(["run", "bar_wave", *SHORT, "--out", str(finished)]) == 0
    assert not [name for name in parts if (finished / name).exists()]


# ---------------------------------------------------------------- files that no run has made


@pytest.mark.parametrize("name", ["case.yaml", "mesh.npz", "summary.json", "fields/frame_0001.vtu"])
def test_files_that_no_run_has_made_are_not_replaced(tmp_path, capsys, name):
    out = tmp_path / "mine"
    path = out / name
    path.parent.mkdir(parents=True)
    path.write_text('{"status": "mine"}')
    before = files(out)
    assert main(["run", "bar_wave", *SHORT, "--out", str(out)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --out {out}: the run would replace {path}, which none has made; expected a "
        "new or empty folder, or one of an earlier run\n"
    )
    assert files(out) == before


@pytest.mark.parametrize("gone", ["summary.json", "checkpoint", "mark"])
def test_results_of_an_earlier_run_are_replaced(finished, gone):
    """Also those of a version without the mark, and what Snakemake leaves of a run that failed."""
    marks = {"summary.json", "checkpoint", "mark"} - {gone}
    if "mark" not in marks:
        (finished / MARK).unlink()
    if "summary.json" not in marks:
        (finished / "summary.json").unlink()
    if "checkpoint" not in marks:
        for path in finished.glob("checkpoint*.npz"):
            path.unlink()
    (finished / "history.parquet").unlink()
    assert main(["run", "bar_wave", *SHORT, "--out", str(finished)]) == 0


@pytest.mark.parametrize("name", ["summary.json", "checkpoint.npz"])
def test_results_without_a_mark_are_known_by_one_file(finished, name):
    for path in finished.glob("*"):
        if path.name not in (name, "case.yaml", "fields"):
            path.unlink()
    (finished / MARK).unlink(missing_ok=True)
    assert main(["run", "bar_wave", *SHORT, "--out", str(finished)]) == 0


# ---------------------------------------------------------------- forged checkpoints


def forge(path, change):
    """Write a checkpoint anew with other arrays, under a right check sum."""
    with np.load(path) as file:
        arrays = {name: file[name] for name in file}
    for name in ("digest", "format", "build"):
        del arrays[name]
    mark = str(arrays.pop("fingerprint"))
    change(arrays)
    checkpoint._write(path, mark, arrays)


def without(name):
    return lambda arrays: arrays.pop(name)


def changed(name, how):
    return lambda arrays: arrays.update({name: how(arrays[name])})


FORGED = {
    "state gone": (without("state"), "it lacks 'state'"),
    "clocks gone": (without("clocks"), "it lacks 'clocks'"),
    "history gone": (without("history"), "it lacks 'history'"),
    "guards gone": (without("guards_first"), "it lacks 'guards_first'"),
    "clocks of texts": (changed("clocks", lambda a: a.astype(str)), "'clocks' holds <U32"),
    "one clock": (changed("clocks", lambda a: a[:1]), "'clocks' holds float64 of shape (1,)"),
    "clocks NaN": (changed("clocks", lambda a: a * np.nan), "'clocks' holds what is no finite"),
    "narrow history": (changed("history", lambda a: a[:, :-1]), "'history' holds float64 of "),
    "few energies": (changed("energy", lambda a: a[:-1]), "'energy' holds float64 of shape ("),
    "no records": (
        lambda a: a.update({name: a[name][:0] for name in ("history", "energy", "probes")}),
        "it holds no record",
    ),
    "short state": (changed("state", lambda a: a[:-1]), "checkpoint: it belongs to another model"),
    "half numbers": (changed("state", lambda a: a.astype("f4")), "'state' holds float32"),
    "finished as text": (changed("finished", lambda a: a.astype(str)), "'finished' holds <U5"),
}


@pytest.mark.parametrize(("change", "why"), FORGED.values(), ids=FORGED)
def test_a_forged_checkpoint_is_refused_and_the_one_before_is_used(
    interrupted, capsys, change, why
):
    newest, before = (interrupted / name for name in (checkpoint.NAME, checkpoint.PREVIOUS))
    before.write_bytes(newest.read_bytes())
    forge(newest, change)
    capsys.readouterr()
    words = ["run", "bar_wave", *SHORT, "--resume", "--out", str(interrupted)]
    assert main(words) == 0
    said = capsys.readouterr().err
    assert said.startswith(f"lithofrac: {newest}: not a checkpoint of this run ({why}")
    assert said.endswith(f"; going on from {checkpoint.PREVIOUS}\n")
    assert said.count("\n") == 1


def test_nothing_is_written_where_all_checkpoints_are_forged(interrupted, capsys):
    (interrupted / checkpoint.PREVIOUS).unlink()
    forge(interrupted / checkpoint.NAME, without("clocks"))
    kept = files(interrupted)
    capsys.readouterr()
    assert main(["run", "bar_wave", *SHORT, "--resume", "--out", str(interrupted)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --resume: {interrupted / checkpoint.NAME}: not a checkpoint of this run (it "
        "lacks 'clocks')\n"
    )
    assert files(interrupted) == kept


# ---------------------------------------------------------------- what never ends, other bytes


@pytest.mark.parametrize("what", ["pipe", "/dev/zero", "folder"])
def test_a_checkpoint_that_is_no_regular_file_is_refused(interrupted, capsys, what):
    (interrupted / checkpoint.PREVIOUS).unlink()
    path = interrupted / checkpoint.NAME
    path.unlink()
    if what == "pipe":
        os.mkfifo(path)
    elif what == "folder":
        path.mkdir()
    else:
        path.symlink_to(what)
    capsys.readouterr()
    assert main(["run", "bar_wave", *SHORT, "--resume", "--out", str(interrupted)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --resume: {path}: is no regular file, expected a checkpoint\n"
    )


@pytest.mark.parametrize(
    "words",
    [
        ["run", "bar_wave", "--out", "out/\udcff"],
        ["run", "\udcff.yaml", "--out", "out"],
        ["run", "bar_wave", "--mesh", "\udcff.npz", "--out", "out"],
        ["check", "\udcff.yaml"],
        ["mesh", "bar_wave", "--out", "\udcff.npz"],
        ["plot", "curves", "\udcff", "--out", "a.svg"],
        ["fit", "\udcff.csv", "--out", "a.yaml"],
        ["point", "sandstone", "--out", "\udcff.parquet"],
    ],
)
def test_paths_that_are_not_utf_8_are_refused_at_once(tmp_path, monkeypatch, capsys, words):
    """They cost the tables of a run at its end."""
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    named = next(word for word in words if "\udcff" in word).replace("\udcff", "\\udcff")
    said = f"lithofrac: {named}: is not UTF-8, expected words in UTF-8\n"
    assert capsys.readouterr().err == said
    assert not list(tmp_path.iterdir())
