"""Whole files or none (pywrap/lithofrac/results/files.py)."""

import pytest

from lithofrac.results.files import write_json, write_whole

pytestmark = pytest.mark.no_core


def test_failure_leaves_the_old_file_and_no_part(tmp_path):
    target = tmp_path / "a.json"
    write_json(target, {"x": 1})

    def fail(part):
        part.write_text("half")
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        write_whole(target, fail)
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]
    assert '"x": 1' in target.read_text()


def test_not_a_number_never_reaches_json(tmp_path):
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(tmp_path / "a.json", {"x": float("nan")})
    assert list(tmp_path.iterdir()) == []
