"""Checkpoints: two generations, refusals in words (pywrap/lithofrac/results/checkpoint.py)."""

from dataclasses import replace

import numpy as np
import pytest
from models import Elastic, hold, problem, rectangle

from lithofrac.errors import CoreError
from lithofrac.results import checkpoint

pytestmark = pytest.mark.no_core
ARRAYS = {"state": np.arange(5.0)}


def test_what_is_written_is_read(tmp_path):
    checkpoint.write(tmp_path, "mark", ARRAYS)
    arrays, refused = checkpoint.read(tmp_path, "mark")
    np.testing.assert_array_equal(arrays["state"], ARRAYS["state"])
    assert refused == []


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
    arrays, refused = checkpoint.read(tmp_path, "mark")
    assert arrays["state"].sum() == 0.0
    assert len(refused) == 1
    assert "not a whole checkpoint" in refused[0]


def test_other_problem_is_refused(tmp_path):
    checkpoint.write(tmp_path, "mark", ARRAYS)
    with pytest.raises(CoreError, match="belongs to another case, mesh or material"):
        checkpoint.read(tmp_path, "other")


def test_other_format_is_refused(tmp_path, monkeypatch):
    checkpoint.write(tmp_path, "mark", ARRAYS)
    monkeypatch.setattr(checkpoint, "FORMAT", checkpoint.FORMAT + 1)
    with pytest.raises(CoreError, match="written in another format"):
        checkpoint.read(tmp_path, "mark")


def test_no_checkpoint_is_said(tmp_path):
    with pytest.raises(CoreError, match="there is no checkpoint to resume from"):
        checkpoint.read(tmp_path, "mark")


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
