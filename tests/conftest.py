"""What all tests share: which build is under test, and how much random work it can take.

`tasks.py test` runs the same tests on three builds and names the one in LITHOFRAC_BUILD:
release, checked (-O1, bounds, coverage) or sanitize (-O1, addresses, undefined behaviour).
"""

import os

import pytest
from hypothesis import settings

BUILD = os.environ.get("LITHOFRAC_BUILD", "release")
# Share of the random states that the slower builds take: they look for wrong memory, not for rare
# branches, and are 3 and 15 times slower.
SHARE = {"release": 1.0, "checked": 0.1, "sanitize": 0.02}[BUILD]
RELEASE_ONLY = ("no_core", "one_build")

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


def pytest_collection_modifyitems(config, items):
    """Some tests tell nothing about a special build: no core, or all the program around it."""
    if BUILD == "release":
        return
    left_out = [item for item in items if any(map(item.get_closest_marker, RELEASE_ONLY))]
    gone = set(left_out)
    items[:] = [item for item in items if item not in gone]
    config.hook.pytest_deselected(items=left_out)


@pytest.fixture(scope="session")
def build() -> str:
    """Name of the build under test."""
    return BUILD


@pytest.fixture(scope="session")
def n_random():
    """n_random(full, least=200): how many random states to try on the build under test."""
    return lambda full, least=200: max(min(full, least), round(full * SHARE))
