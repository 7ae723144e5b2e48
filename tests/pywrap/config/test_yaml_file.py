"""Reading YAML (pywrap/lithofrac/config/yaml_file.py)."""

import pytest

from lithofrac.config import ConfigError
from lithofrac.config.yaml_file import parsed, read_yaml, text_of

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
    ("text", "value"),
    [
        ("010", 10),
        ("-08", -8),
        ("+3", 3),
        ("1.0e9", 1e9),
        ("1.e3", 1e3),
        ("1E+3", 1e3),
        (".5", 0.5),
        ("5.", 5.0),
        ("09.5", 9.5),
        ("-.inf", float("-inf")),
        ("1:30", "1:30"),
        ("1:30.5", "1:30.5"),
        ("1_000", "1_000"),
        ("0x10", "0x10"),
        ("0b11", "0b11"),
        ("1.2.3", "1.2.3"),
        (".", "."),
        ("-", [None]),
    ],
)
def test_numbers_are_those_of_yaml_1_2(text, value):
    assert parsed(text, "a") == value
    assert type(parsed(text, "a")) is type(value)


@pytest.mark.parametrize("value", ["1e3", "010", "1.e3", "1:30", "true", 1e-5, 1e22, 3, -0.5, "ü"])
def test_what_is_written_is_read_back(value):
    read = parsed(text_of({"a": value}), "a")["a"]
    assert (type(read), read) == (type(value), value)


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


@pytest.mark.parametrize(
    "tag", ["!!bool maybe", "!!float ''", "!!int ''", "!!timestamp x", "!!binary 1", "!!set [a]"]
)
def test_a_tag_with_the_wrong_content_is_refused_in_a_sentence(file, tag):
    file.write_text(f"a: {tag}\n")
    said = refusal(file)
    assert said.startswith(f"{file}: ")
    assert "\n" not in said


def test_a_text_that_unfolds_without_end_is_refused(file):
    lines = ["a0: &a0 [x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 12)]
    file.write_text("\n".join(lines))
    assert refusal(file) == f"{file}: line 2, column 10: aliases are not taken"


def test_what_is_written_holds_no_aliases():
    same = [1.5, 2.5]
    assert parsed(text_of({"a": same, "b": same}), "a") == {"a": same, "b": same}


def test_no_objects_are_built(file):
    file.write_text("a: !!python/object/apply:os.getcwd []\n")
    assert "could not determine a constructor" in refusal(file)
