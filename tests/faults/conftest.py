"""The case that is killed, and what it comes to when nobody does."""

import random
from pathlib import Path

import pytest
from fault_runs import CASE, RECORDS, Cracking, summary


@pytest.fixture(scope="session")
def cracking(tmp_path_factory) -> Cracking:
    """The case, ready to run."""
    file = tmp_path_factory.mktemp("case") / "cracking.yaml"
    file.write_text(CASE, encoding="utf-8")
    return Cracking(file)


@pytest.fixture(scope="session")
def unbroken(cracking, tmp_path_factory) -> Path:
    """Folder of the run that nothing has stopped."""
    out = tmp_path_factory.mktemp("unbroken") / "out"
    assert cracking.run(out) == (0, "")
    said = summary(out)
    assert said["cracks"] > 20
    assert said["contact_pairs_max"] > 20
    return out


@pytest.fixture
def moments():
    """moments(n, seed) -> n random moments of the run, in checkpoints; the same each time."""

    def made(n: int, seed: int) -> list[float]:
        source = random.Random(seed)
        return [source.uniform(0.0, RECORDS) for _ in range(n)]

    return made
