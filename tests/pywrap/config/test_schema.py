"""Generated JSON schemas (pywrap/lithofrac/config/schema.py)."""

from pathlib import Path

import jsonschema
import pytest

from lithofrac.config.schema import schemas, text_of
from lithofrac.config.yaml_file import read_yaml

pytestmark = pytest.mark.no_core

CONFIGS = Path("configs")
FILES = [
    *((path, "case") for path in sorted((CONFIGS / "cases").glob("*.yaml"))),
    *((path, "case") for path in sorted((CONFIGS / "examples").glob("*.yaml"))),
    *((path, "material") for path in sorted((CONFIGS / "materials").glob("*.yaml"))),
    *((path, "suite") for path in sorted(CONFIGS.glob("suite*.yaml"))),
    *((path, "study") for path in sorted((CONFIGS / "studies").glob("*.yaml"))),
    (CONFIGS / "project" / "case.yaml", "case"),
    (CONFIGS / "project" / "rock.yaml", "material"),
    (CONFIGS / "project" / "study.yaml", "study"),
]


@pytest.mark.parametrize("name", ["case", "material", "suite", "study"])
def test_schema_files_are_those_of_the_models(name):
    written = (CONFIGS / "schema" / f"{name}.schema.json").read_text()
    assert written == text_of(schemas()[name]), "python -m lithofrac.config.schema configs/schema"


@pytest.mark.parametrize(("path", "name"), FILES, ids=lambda value: str(value))
def test_config_files_satisfy_their_schema(path, name):
    jsonschema.validate(read_yaml(path), schemas()[name])


def test_a_schema_refuses_an_unknown_key():
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"title": "a", "speed": 3}, schemas()["case"])
