"""Problems of the scenes, made once for all tests of this folder."""

from functools import cache

import pytest

from lithofrac.config import find_case
from lithofrac.scenes import make_mesh, make_problem


@pytest.fixture(scope="session")
def problem_of():
    """problem_of(name, seed=1, key=value...): case and problem; dots in keys are written `__`."""

    @cache
    def made(name, seed=1, **overrides):
        keys = {key.replace("__", "."): value for key, value in overrides.items()}
        case = find_case(name, None, keys)
        return case, make_problem(case, make_mesh(case, seed))

    return made
