"""Running a case from the command line (pywrap/lithofrac/cli.py, progress.py)."""

import io
import json
import os
import signal

import pandas as pd
import pytest

from lithofrac import cli
from lithofrac.cli import main
from lithofrac.config import find_case, load_case
from lithofrac.core import Run
from lithofrac.errors import CoreError
from lithofrac.progress import Progress
from lithofrac.results.files import MARK

SHORT = ["--set", "scene.element_size_mm=2.5", "--set", "output.records=20"]


def test_a_run_fills_its_folder_and_says_so(tmp_path, capsys):
    out = tmp_path / "bar"
    assert main(["run", "bar_wave", *SHORT, "--out", str(out)]) == 0
    said = capsys.readouterr()
    assert said.out.startswith("bar_wave: completed, ")
    assert "step" in said.err
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["status"], summary["case"]) == ("completed", "bar_wave")
    for name in ("history.parquet", "energy.parquet", "mesh.npz", "case.yaml", "fields.pvd"):
        assert (out / name).exists()
    assert [path.name for path in out.glob(".*")] == [MARK]


def test_the_case_in_the_folder_is_the_case_as_run(tmp_path):
    main(["run", "bar_wave", *SHORT, "--out", str(tmp_path / "a"), "--quiet"])
    asked = find_case("bar_wave", None, {"scene.element_size_mm": 2.5, "output.records": 20})
    assert load_case(tmp_path / "a" / "case.yaml") == asked


def test_running_the_case_of_a_folder_again_gives_the_same_numbers(tmp_path):
    first, second = tmp_path / "a", tmp_path / "b"
    main(["run", "bar_wave", *SHORT, "--out", str(first), "--quiet"])
    main(["run", str(first / "case.yaml"), "--out", str(second), "--quiet"])
    pd.testing.assert_frame_equal(
        *(pd.read_parquet(folder / "history.parquet") for folder in (first, second)),
        check_exact=True,
    )


def test_a_saved_mesh_gives_the_same_run(tmp_path):
    mesh, first, second = tmp_path / "mesh.npz", tmp_path / "a", tmp_path / "b"
    assert main(["mesh", "bar_wave", *SHORT, "--out", str(mesh)]) == 0
    main(["run", "bar_wave", *SHORT, "--out", str(first), "--quiet"])
    main(["run", "bar_wave", *SHORT, "--mesh", str(mesh), "--out", str(second), "--quiet"])
    pd.testing.assert_frame_equal(
        *(pd.read_parquet(folder / "history.parquet") for folder in (first, second)),
        check_exact=True,
    )


def test_a_second_run_leaves_nothing_of_the_first(tmp_path):
    out = tmp_path / "a"
    main(["run", "bar_wave", *SHORT, "--out", str(out), "--quiet"])
    (out / "notes.txt").write_text("mine")
    main(["run", "bar_wave", *SHORT, "--set", "output.fields=0", "--out", str(out), "--quiet"])
    assert not list(out.glob("fields/*"))
    assert not (out / "fields.pvd").exists()
    assert (out / "notes.txt").read_text() == "mine"


def test_quiet_prints_nothing(tmp_path, capsys):
    assert main(["run", "bar_wave", *SHORT, "--out", str(tmp_path / "a"), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_check_prints_the_plan(capsys):
    assert main(["check", "sandstone_triaxial_p10"]) == 0
    plan = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert plan["case"].endswith("sandstone_triaxial_p10: Sandstone, triaxial compression")
    assert "Mohr-Coulomb planes" in plan["uses"]
    assert {"elements", "steps", "leaves"} <= set(plan)


def test_a_numerical_failure_exits_with_3(tmp_path, monkeypatch, capsys):
    def failing(*args, **kwargs):
        raise CoreError("step 7, element 3: no consistent return")

    monkeypatch.setattr("lithofrac.run.simulate", failing)
    assert main(["run", "bar_wave", *SHORT, "--out", str(tmp_path / "a")]) == 3
    assert capsys.readouterr().err == "lithofrac: step 7, element 3: no consistent return\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_exits_with_130_and_goes_on(tmp_path, monkeypatch, capsys, number):
    """The signal comes while the core is at work on the fifth record."""
    out = tmp_path / "a"
    case = ["run", "bar_wave", *SHORT, "--out", str(out)]
    advance, calls = Run.advance, []

    def interrupted(self, steps, threads=1):
        advance(self, steps, threads)
        calls.append(steps)
        if len(calls) == 5:
            os.kill(os.getpid(), number)

    with monkeypatch.context() as patch:
        patch.setattr(Run, "advance", interrupted)
        assert main([*case, "--quiet"]) == 130
    said = capsys.readouterr().err
    assert said == (f"lithofrac: interrupted; the same command with --resume goes on from {out}\n")
    assert json.loads((out / "summary.json").read_text())["status"] == "interrupted"
    assert main([*case, "--resume", "--quiet"]) == 0
    assert json.loads((out / "summary.json").read_text())["status"] == "completed"
    assert main(["run", "bar_wave", *SHORT, "--out", str(tmp_path / "b"), "--quiet"]) == 0
    tables = [pd.read_parquet(tmp_path / run / "history.parquet") for run in "ab"]
    pd.testing.assert_frame_equal(*tables, check_exact=True)


def test_defects_of_the_program_are_not_hidden(tmp_path, monkeypatch):
    def broken(*args, **kwargs):
        raise ZeroDivisionError

    monkeypatch.setattr("lithofrac.run.simulate", broken)
    with pytest.raises(ZeroDivisionError):
        main(["run", "bar_wave", *SHORT, "--out", str(tmp_path / "a")])


class Terminal(io.StringIO):
    def isatty(self):
        return True


REPORT = {
    "step": 50,
    "steps": 100,
    "time_s": 1e-3,
    "percent": 50.0,
    "rate": 2.5e7,
    "cracks": 0,
    "residual": 1e-9,
    "seconds_left": 12.0,
}


@pytest.mark.no_core
def test_a_log_gets_plain_lines_and_a_terminal_a_bar():
    log, terminal = io.StringIO(), Terminal()
    for stream in (log, terminal):
        progress = Progress("bar", stream)
        progress(REPORT)
        progress(REPORT | {"step": 100, "percent": 100.0, "cracks": 7})
        progress.close()
    assert log.getvalue() == (
        "bar: step 100 of 100 (100 %), 1.0000 ms, 25.0M element-steps/s, 7 crack events, "
        "energy residual 1.0e-09, 12 s left\n"
    )
    assert "100%" in terminal.getvalue()
    assert "7 crack events" in terminal.getvalue()


def test_the_signal_of_a_time_limit_is_given_back(tmp_path):
    before = signal.getsignal(signal.SIGTERM)
    main(["run", "bar_wave", *SHORT, "--out", str(tmp_path / "a"), "--quiet"])
    assert signal.getsignal(signal.SIGTERM) is before
    assert cli.INTERRUPTED == 130


def test_a_point_is_driven_into_a_table(tmp_path):
    out = tmp_path / "new" / "curve.parquet"
    assert main(["point", "sandstone", "--confinement-MPa", "10", "--out", str(out)]) == 0
    peak = pd.read_parquet(out)["axial_stress_MPa"].max()
    assert peak == pytest.approx(187.0, rel=1e-3)  # Table 1 at 10 MPa


def test_several_confinements_fill_a_folder(tmp_path):
    words = ["point", "sandstone", "--confinement-MPa", "0", "2.5", "10", "--out", str(tmp_path)]
    assert main(words) == 0
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["triaxial_p00.parquet", "triaxial_p02.5.parquet", "triaxial_p10.parquet"]


def test_several_confinements_do_not_fit_into_a_file(tmp_path, capsys):
    out = tmp_path / "one.parquet"
    words = ["point", "sandstone", "--confinement-MPa", "0", "10", "--out", str(out)]
    assert main(words) == 2
    message = f"--out {out}: several confinements need a folder, not a file"
    assert message in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["--test", "torsion"],
            "test 'torsion': expected one of triaxial, plane_strain, extension, tension, "
            "stiff_confinement",
        ),
        (["--end-strain", "nan"], "--end-strain nan: expected a number between 0 and 1"),
        (["--end-strain", "-1"], "--end-strain -1: expected a number between 0 and 1"),
        (["--stiffness", "inf"], "--stiffness inf: expected a number from 0 to 1000"),
        (["--end-strain", "5"], "--end-strain 5: expected a number between 0 and 1"),
        (["--confinement-MPa", "-1"], "--confinement-MPa -1: expected a number from 0 to 1e+06"),
        (["--confinement-MPa", "inf"], "--confinement-MPa inf: expected a number from 0 to 1e+06"),
        (
            ["--confinement-MPa", "0", "1e308"],
            "--confinement-MPa 1e+308: expected a number from 0 to 1e+06",
        ),
    ],
)
def test_a_point_that_makes_no_sense_is_refused(tmp_path, capsys, words, message):
    assert main(["point", "sandstone", *words, "--out", str(tmp_path / "a.parquet")]) == 2
    assert capsys.readouterr().err == f"lithofrac: {message}\n"
    assert not list(tmp_path.iterdir())
