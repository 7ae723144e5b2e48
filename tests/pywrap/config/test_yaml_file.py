"""Reading YAML (pywrap/lithofrac/config/yaml_file.py)."""

import pytest

from lithofrac.config import ConfigError
from lithofrac.config.yaml_file import read_yaml

pytestmark = pytest.mark.no_core


@pytest.fixture
def file(tmp_path):
    return tmp_path / "a.yaml"


def refusal(path) -> str:
    with pytest.raises(ConfigError) as caught:
        read_yaml(path)
    return str(caught.value)


def test_a_number_with_a_bare_exponent_is_a_number(file):
    file.write_text("a: 1e-3\nb: -2E6\nc: 1.5\nd: 3\ne: x1e3\n")
    assert read_yaml(file) == {"a": 1e-3, "b": -2e6, "c": 1.5, "d": 3, "e": "x1e3"}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "file is empty, expected a YAML mapping"),
        (b"# only words\n", "file is empty, expected a YAML mapping"),
        (b"- a\n", "holds a list, expected a YAML mapping of keys"),
        (b"a: 1\nb: 2\na: 3\n", "line 3, column 1: key 'a' stands twice in one mapping"),
        (b"a: {b: 1, b: 2}\n", "line 1, column 11: key 'b' stands twice in one mapping"),
        (b"1: a\n", "line 1, column 1: key 1: expected a text as key"),
        (b"a: \xff\n", "byte 3 is not UTF-8, expected a YAML file in UTF-8"),
        (b"a: [1\n", "line 2, column 1: expected ',' or ']', but got '<stream end>'"),
    ],
)
def test_a_file_that_is_no_mapping_is_refused(file, content, message):
    file.write_bytes(content)
    assert refusal(file) == f"{file}: {message}"


def test_a_missing_file_and_a_folder_are_refused(file):
    assert refusal(file) == f"{file}: no such file"
    assert refusal(file.parent) == f"{file.parent}: is a directory, expected a YAML file"


def test_no_objects_are_built(file):
    file.write_text("a: !!python/object/apply:os.getcwd []\n")
    assert "could not determine a constructor" in refusal(file)
