"""What all tests share: which build is under test, and how much random work it can take.

`tasks.py test` runs the same tests on three builds and names the one in LITHOFRAC_BUILD:
release, checked (-O1, bounds, coverage) or sanitize (-O1, addresses, undefined behaviour). Which
tests a build runs, by their marks, is said there too.
"""

import os

import pytest
from hypothesis import settings

BUILD = os.environ.get("LITHOFRAC_BUILD", "release")
# Share of the random states that the slower builds take: they look for wrong memory, not for rare
# branches, and are 3 and 15 times slower.
SHARE = {"release": 1.0, "checked": 0.1, "sanitize": 0.02}[BUILD]

# The same examples for everyone and every time; a deadline would measure the machine.
settings.register_profile(
    "lithofrac",
    derandomize=True,
    deadline=None,
    max_examples={"release": 100, "checked": 30, "sanitize": 20}[BUILD],
)
settings.load_profile("lithofrac")


def pytest_report_header():
    return f"lithofrac build under test: {BUILD}"


@pytest.fixture(scope="session")
def build() -> str:
    """Name of the build under test."""
    return BUILD


@pytest.fixture(scope="session")
def n_random():
    """n_random(full, least=200): how many random states to try on the build under test."""
    return lambda full, least=200: max(min(full, least), round(full * SHARE))
