"""What tests of the command line share."""

import pytest

from lithofrac.cli import main


@pytest.fixture
def refused(tmp_path, capsys):
    """refused(path, *options): what `lithofrac run` says, after checking that it did nothing."""

    def attempt(path, *options):
        out = tmp_path / "results"
        before = {p: p.read_bytes() if p.is_file() else None for p in tmp_path.rglob("*")}
        assert main(["run", str(path), "--out", str(out), *options]) == 2
        after = {p: p.read_bytes() if p.is_file() else None for p in tmp_path.rglob("*")}
        assert after == before
        said = capsys.readouterr()
        assert said.out == ""
        return said.err

    return attempt
