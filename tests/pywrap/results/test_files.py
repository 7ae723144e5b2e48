"""Whole files or none (pywrap/lithofrac/results/files.py)."""

import io

import pytest

from lithofrac.results.files import write_json, write_text, write_whole

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


def test_file_of_before_is_kept_under_its_other_name(tmp_path):
    new, older = tmp_path / "a", tmp_path / "b"
    for text in ("1", "2", "3"):
        write_whole(new, lambda part, text=text: part.write_text(text), older=older)
    assert (new.read_text(), older.read_text()) == ("3", "2")


def test_texts_are_utf_8_whatever_the_locale(tmp_path, monkeypatch):
    monkeypatch.setattr(io, "text_encoding", lambda given, *_: given or "ascii")
    write_text(tmp_path / "a", "Zähigkeit 1°")
    assert (tmp_path / "a").read_bytes().decode("utf-8") == "Zähigkeit 1°"
