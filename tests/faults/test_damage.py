"""A checkpoint that is damaged or old is refused in a sentence; the one before it is used."""

import signal

import numpy as np
import pytest
from fault_runs import assert_same, files

from lithofrac.cli import main
from lithofrac.results.checkpoint import FORMAT, NAME, PREVIOUS

pytestmark = pytest.mark.restart


def cut(path):
    path.write_bytes(path.read_bytes()[:-1000])


def flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 4
    path.write_bytes(content)


def empty(path):
    path.write_bytes(b"")


def older(path):
    with np.load(path) as file:
        arrays = {name: file[name] for name in file}
    np.savez(path, **{**arrays, "format": np.array(FORMAT - 1)})


DAMAGES = pytest.mark.parametrize(
    ("damage", "why"),
    [
        (cut, "not a whole checkpoint (BadZipFile: File is not a zip file)"),
        (flip, "not a whole checkpoint (BadZipFile: Bad CRC-32 for file "),
        (empty, "not a whole checkpoint (EOFError: No data left in file)"),
        (older, f"written in format {FORMAT - 1}, expected {FORMAT}"),
    ],
)


@pytest.fixture(scope="module")
def stopped(cracking, tmp_path_factory):
    """Files of a run that was stopped after half of its way."""
    out = tmp_path_factory.mktemp("stopped") / "out"
    assert cracking.stop(out, signal.SIGTERM, 30.5)[0] == 130
    return files(out)


@pytest.fixture
def out(stopped, tmp_path):
    """A fresh copy of its folder."""
    for name, content in stopped.items():
        path = tmp_path / "out" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return tmp_path / "out"


@DAMAGES
def test_one_before_is_used(cracking, unbroken, out, capsys, damage, why):
    damage(out / NAME)
    assert main(cracking.words(out, "--resume")) == 0
    said = capsys.readouterr().err
    assert said.startswith(f"lithofrac: {out / NAME}: {why}")
    assert said.endswith(f"; going on from {PREVIOUS}\n")
    assert said.count("\n") == 1
    assert_same(unbroken, out)


@DAMAGES
def test_nothing_is_written_where_both_are_damaged(cracking, out, capsys, damage, why):
    for name in (NAME, PREVIOUS):
        damage(out / name)
    before = files(out)
    assert main(cracking.words(out, "--resume")) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"lithofrac: --resume: {out / NAME}: {why}")
    assert f"; {out / PREVIOUS}: {why}" in said
    assert said.count("\n") == 1
    assert files(out) == before
