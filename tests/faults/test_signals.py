"""Ctrl-C and SIGTERM: a checkpoint, a sentence, exit code 130 (pywrap/lithofrac/run.py, cli.py)."""

import os
import signal
import subprocess
import sys
import time
import tomllib

import pytest
from fault_runs import LITHOFRAC, ROOT, assert_same, summary

from lithofrac.cli import main
from lithofrac.results.recorder import Recorder

pytestmark = pytest.mark.restart
SIGNALS = pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])


@pytest.fixture(autouse=True)
def listening():
    """Ctrl-C is heard; a shell starts what it sends to the background deaf to it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@SIGNALS
def test_stopped_run_keeps_where_it_was(cracking, unbroken, tmp_path, number):
    out = tmp_path / "out"
    code, said = cracking.stop(out, number, 30.5)
    assert code == 130
    assert said == f"lithofrac: interrupted; the same command with --resume goes on from {out}\n"
    stopped = summary(out)
    assert stopped["status"] == "interrupted"
    assert 0 < stopped["steps"] < summary(unbroken)["steps"]
    assert cracking.run(out, "--resume") == (0, "")
    assert_same(unbroken, out)


@SIGNALS
def test_stopped_within_its_first_record_it_keeps_that(
    cracking, unbroken, tmp_path, monkeypatch, capsys, number
):
    out, note = tmp_path / "out", Recorder._note_fragments

    def stopped(self):
        os.kill(os.getpid(), number)
        note(self)

    with monkeypatch.context() as patch:
        patch.setattr(Recorder, "_note_fragments", stopped)
        assert main(cracking.words(out)) == 130
    said = capsys.readouterr().err
    assert said == f"lithofrac: interrupted; the same command with --resume goes on from {out}\n"
    assert summary(out)["steps"] == 0
    assert main(cracking.words(out, "--resume")) == 0
    assert_same(unbroken, out)


@SIGNALS
def test_stopped_before_its_first_record_it_has_nothing_to_keep_and_says_so(
    cracking, tmp_path, monkeypatch, capsys, number
):
    out = tmp_path / "out"

    def stopped(*_):
        os.kill(os.getpid(), number)
        time.sleep(10.0)  # another thread may be told first; the interruption ends this

    monkeypatch.setattr(Recorder, "__init__", stopped)
    assert main(cracking.words(out)) == 130
    assert capsys.readouterr().err == "lithofrac: interrupted\n"
    assert not (out / "summary.json").exists()
    assert not list(out.glob("checkpoint*"))


# Read by Python before anything else: Ctrl-C as a module is about to be imported, within a line of
# Python or within a text that is executed, which Python itself takes down in another way.
EARLY = """
import signal, sys

class Early:
    def find_spec(self, name, *_):
        if name == {module!r}:
            {line}

sys.meta_path.insert(0, Early())
"""


def installed() -> list[str]:
    """What pip writes into the `lithofrac` on the path."""
    named = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]["lithofrac"]
    module, function = named.split(":")
    return [
        sys.executable,
        "-c",
        f"import sys; from {module} import {function} as main; sys.exit(main())",
    ]


@pytest.mark.no_core  # it ends before the core is there
@pytest.mark.parametrize(
    "line",
    [
        "signal.raise_signal(signal.SIGINT)",
        "exec('signal.raise_signal(signal.SIGINT)')",
        "signal.raise_signal(signal.SIGTERM)",
    ],
    ids=["line", "text", "SIGTERM"],
)
@pytest.mark.parametrize("module", ["lithofrac.cli", "argparse", "lithofrac.intake", "pydantic"])
@pytest.mark.parametrize("start", [LITHOFRAC, installed()], ids=["module", "script"])
def test_ctrl_c_while_modules_are_imported_is_one_sentence(tmp_path, start, module, line):
    (tmp_path / "sitecustomize.py").write_text(EARLY.format(module=module, line=line))
    before = [path for path in (os.environ.get("PYTHONPATH"),) if path]
    variables = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *before])}
    done = subprocess.run(
        [*start, "check", "bar_wave"], env=variables, capture_output=True, text=True, timeout=60
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "lithofrac: interrupted\n")


@pytest.mark.no_core  # it ends before there is a mesh
@SIGNALS
def test_stopped_while_it_meshes_nothing_is_left(tmp_path, number):
    (tmp_path / "tmp").mkdir()
    variables = {**os.environ, "TMPDIR": str(tmp_path / "tmp")}
    words = ["run", "hole_r25.0", "--out", "out", "--quiet"]
    process = subprocess.Popen(
        [*LITHOFRAC, *words], cwd=tmp_path, env=variables, stderr=subprocess.PIPE, text=True
    )
    until = time.monotonic() + 60.0
    while not list((tmp_path / "tmp").glob("*/.fltk")):  # gmsh is at work
        assert process.poll() is None
        assert time.monotonic() < until, "no mesh is begun"
        time.sleep(0.001)
    process.send_signal(number)
    said = process.communicate(timeout=60)[1]
    assert (process.returncode, said) == (130, "lithofrac: interrupted\n")
    assert not list((tmp_path / "tmp").iterdir())
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@SIGNALS
def test_stopped_at_random_moments(cracking, unbroken, moments, tmp_path, number):
    for i, moment in enumerate(moments(10, seed=int(number))):
        out = tmp_path / str(i)
        code, said = cracking.stop(out, number, moment)
        assert code in (0, 130)
        assert said.count("\n") == (code == 130)
        if (out / "checkpoint.npz").exists():
            assert cracking.run(out, "--resume") == (0, "")
            assert_same(unbroken, out)
        else:
            assert said == "lithofrac: interrupted\n"
