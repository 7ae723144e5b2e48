"""Checkpoints: two generations, refusals in words (pywrap/lithofrac/results/checkpoint.py)."""

import errno
from dataclasses import replace

import numpy as np
import pytest
from models import Elastic, hold, problem, rectangle

from lithofrac.errors import CheckpointError, CoreError
from lithofrac.results import checkpoint

pytestmark = pytest.mark.no_core
ARRAYS = {"state": np.arange(5.0)}


def test_what_is_written_is_read(tmp_path):
    checkpoint.write(tmp_path, "mark", ARRAYS)
    found = checkpoint.read(tmp_path, "mark")
    np.testing.assert_array_equal(found.arrays["state"], ARRAYS["state"])
    assert found.arrays.keys() == ARRAYS.keys()
    assert (found.path, found.same_build, found.notes) == (tmp_path / checkpoint.NAME, True, [])


@pytest.mark.parametrize("damage", ["cut", "flip"])
def test_broken_checkpoint_is_refused_and_the_one_before_is_used(tmp_path, damage):
    checkpoint.write(tmp_path, "mark", {"state": np.zeros(50)})
    checkpoint.write(tmp_path, "mark", {"state": np.ones(50)})
    path = tmp_path / checkpoint.NAME
    content = bytearray(path.read_bytes())
    if damage == "cut":
        content = content[: len(content) // 2]
    else:
        content[content.index(np.float64(1.0).tobytes())] ^= 1
    path.write_bytes(content)
    found = checkpoint.read(tmp_path, "mark")
    assert found.arrays["state"].sum() == 0.0
    [refused] = found.notes
    assert "not a whole checkpoint" in refused


def test_other_problem_is_refused(tmp_path):
    checkpoint.write(tmp_path, "mark", ARRAYS)
    with pytest.raises(CoreError, match="belongs to another case, mesh or material"):
        checkpoint.read(tmp_path, "other")


def test_other_format_is_refused(tmp_path, monkeypatch):
    checkpoint.write(tmp_path, "mark", ARRAYS)
    monkeypatch.setattr(checkpoint, "FORMAT", checkpoint.FORMAT + 1)
    was = checkpoint.FORMAT - 1
    with pytest.raises(CoreError, match=f"written in format {was}, expected {was + 1}"):
        checkpoint.read(tmp_path, "mark")


def test_no_checkpoint_is_said(tmp_path):
    with pytest.raises(CoreError, match="there is no checkpoint to resume from"):
        checkpoint.read(tmp_path, "mark")


def test_no_flipped_bit_gets_through(tmp_path):
    """Either the checkpoint is refused in one line, or the bit carries nothing (a date)."""
    arrays = {"state": np.arange(40.0), "history": np.ones((3, 2)), "finished": np.array(False)}
    checkpoint.write(tmp_path, "mark", arrays)
    path = tmp_path / checkpoint.NAME
    content, n_refused = path.read_bytes(), 0
    for place in range(0, len(content), 2):
        flipped = bytearray(content)
        flipped[place] ^= 1 << place % 8
        path.write_bytes(flipped)
        try:
            found = checkpoint.read(tmp_path, "mark")
        except CheckpointError as error:
            n_refused += 1
            assert "\n" not in str(error)
            continue
        assert found.arrays.keys() == arrays.keys()
        for name, values in arrays.items():
            np.testing.assert_array_equal(found.arrays[name], values, strict=True)
    assert n_refused > 0.35 * len(content)


def test_array_that_a_flipped_bit_has_shortened_is_refused(tmp_path):
    """The zip format does not look at its check sum then."""
    checkpoint.write(tmp_path, "mark", {"state": np.arange(9000.0)})
    path = tmp_path / checkpoint.NAME
    content = path.read_bytes()
    assert content.count(b"(9000,)") == 1
    path.write_bytes(content.replace(b"(9000,)", b"(8000,)"))
    with np.load(path) as file:
        assert len(file["state"]) == 8000, "numpy takes it for good"
    with pytest.raises(CheckpointError, match="its check sum is another one"):
        checkpoint.read(tmp_path, "mark")


@pytest.mark.parametrize("content", [b"", b"PK", b"\x93NUMPY", b"no archive"])
def test_what_is_no_archive_at_all_is_refused(tmp_path, content):
    (tmp_path / checkpoint.NAME).write_bytes(content)
    with pytest.raises(CheckpointError, match="not a whole checkpoint"):
        checkpoint.read(tmp_path, "mark")


def test_good_one_is_kept_when_the_newer_was_refused(tmp_path):
    """The next write gives up the broken one, and not the one that the run went on from."""
    for value in (1.0, 2.0):
        checkpoint.write(tmp_path, "mark", {"state": np.array(value)})
    (tmp_path / checkpoint.NAME).write_bytes(b"broken")
    assert checkpoint.recover(tmp_path, "mark").arrays["state"] == 1.0
    checkpoint.write(tmp_path, "mark", {"state": np.array(3.0)})
    (tmp_path / checkpoint.NAME).unlink()  # a kill in the middle of the write after this one
    assert checkpoint.read(tmp_path, "mark").arrays["state"] == 1.0


def test_write_that_fails_leaves_both_generations(tmp_path, monkeypatch):
    for value in (1.0, 2.0):
        checkpoint.write(tmp_path, "mark", {"state": np.array(value)})

    def full(part, **arrays):
        part.write_bytes(b"half")
        raise OSError(errno.ENOSPC, "No space left on device")

    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    monkeypatch.setattr(checkpoint.np, "savez", full)
    with pytest.raises(OSError, match="No space left"):
        checkpoint.write(tmp_path, "mark", {"state": np.array(3.0)})
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_another_build_is_noted(tmp_path, monkeypatch):
    checkpoint.write(tmp_path, "mark", ARRAYS)
    monkeypatch.setattr(checkpoint, "build", lambda: "another")
    found = checkpoint.read(tmp_path, "mark")
    assert not found.same_build
    [note] = found.notes
    assert note.endswith("made by another build, bits may differ from those of an unbroken run")


def test_fingerprint_sees_every_part_of_the_problem():
    mesh = rectangle(2, 2)
    base = problem(mesh, velocity_loads=(hold("top", [6, 7, 8], 1, 0.1),))
    moved = replace(mesh, nodes=mesh.nodes + 1e-9)
    others = [
        base,
        replace(base, mesh=moved),
        replace(base, materials=(Elastic(young=1e9),)),
        replace(base, velocity_loads=(hold("top", [6, 7, 8], 1, 0.2),)),
        replace(base, time_step_factor=0.8),
        replace(base, end_time=2.0),
        replace(base, axisymmetric=True),
    ]
    assert len({checkpoint.fingerprint(p) for p in others}) == len(others)
    assert checkpoint.fingerprint(base) == checkpoint.fingerprint(replace(base))
