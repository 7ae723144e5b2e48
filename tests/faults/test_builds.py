"""What flags of the compiler change: nothing, but where they fuse a product and a sum into one.

`native=false` has no such instruction, so it has the same bits at any optimisation. A build that is
tuned for its processor differs by rounding until the first crack; then the order of events decides.
"""

import os
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from fault_runs import ROOT, assert_same

pytestmark = [pytest.mark.slow, pytest.mark.one_build]
BUILDS = {"O0": ["-Dbuildtype=debug", "-Doptimization=0"], "O3": []}


@pytest.fixture(scope="module")
def portable_runs(cracking, tmp_path_factory):
    """Optimisation -> folder of the run of a portable build, made here."""
    home, runs = tmp_path_factory.mktemp("builds"), {}
    for name, options in BUILDS.items():
        site = home / name
        settings = [f"-Csetup-args={option}" for option in ["-Dnative=false", *options]]
        subprocess.run(
            [
                sys.executable, "-m", "pip", "install", "-q", "--no-build-isolation", "--no-deps",
                "--target", str(site), f"-Cbuild-dir={site}-build", *settings, str(ROOT),
            ],
            check=True,
        )  # fmt: skip
        runs[name] = home / f"run-{name}"
        variables = {**os.environ, "PYTHONPATH": str(site)}
        assert cracking.run(runs[name], env=variables) == (0, "")
    return runs


@pytest.mark.restart
def test_optimisation_changes_no_bit_of_a_portable_build(portable_runs):
    assert_same(portable_runs["O0"], portable_runs["O3"])


def test_other_instructions_change_rounding_alone_until_the_first_crack(unbroken, portable_runs):
    one, other = (
        pd.read_parquet(folder / "history.parquet") for folder in (unbroken, portable_runs["O3"])
    )
    first = int(np.argmax(one["cracks"] > 0))
    assert first > 10
    assert int(np.argmax(other["cracks"] > 0)) == first
    for name in one:
        scale = one[name].abs().max() or 1.0
        np.testing.assert_allclose(
            one[name][:first], other[name][:first], rtol=0, atol=1e-9 * scale
        )
