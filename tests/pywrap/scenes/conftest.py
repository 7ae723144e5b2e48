"""Problems of the scenes, made once for all tests of this folder."""

from functools import cache

import pytest
from own_geometry import OWN, beside

from lithofrac.config import ConfigError, find_case, load_case
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


@pytest.fixture
def case_of(tmp_path):
    """case_of(geo, case=OWN, key=value...): a case and its file beside each other."""

    def made(geo, case=OWN, name="own.geo", **overrides):
        path = beside(tmp_path, geo, case, name)
        keys = {key.replace("__", "."): value for key, value in overrides.items()}
        return load_case(path, keys)

    return made


@pytest.fixture
def refused(case_of):
    """refused(geo, ...): what is said of a file, without its name."""

    def attempt(geo, *more, **overrides):
        case = case_of(geo, *more, **overrides)
        with pytest.raises(ConfigError) as caught:
            make_problem(case, make_mesh(case))
        return str(caught.value).removeprefix(f"scene.file = {case.scene.file}: ")

    return attempt
