"""Keys from the command line, and a case written back as YAML."""

from pathlib import Path

from lithofrac.config import yaml_file
from lithofrac.config.case import Case
from lithofrac.config.errors import ConfigError, one_line
from lithofrac.config.gmsh_file import GmshFile


def settings(words: list[str]) -> dict:
    """Turn `loading.confinement_MPa=10` into a key and a value, read as in a YAML file.

    Raises
    ------
    ConfigError
        When a word has no `=`, no key, or a value that is not YAML.
    """
    found = {}
    for word in words:
        key, equals, text = word.partition("=")
        if not key or not equals:
            raise ConfigError(f"--set {one_line(word)}: expected KEY=VALUE")
        found[key.strip()] = yaml_file.parsed(text, f"--set {one_line(key)}")
    return found


def kept(case: Case) -> tuple[Case, dict[str, Path]]:
    """A case that stands in a folder of its own, and the files that it then needs beside it.

    Returns
    -------
    tuple
        The case, which names its geometry beside itself, and name there -> file to copy.
    """
    scene = case.scene
    if not isinstance(scene, GmshFile):
        return case, {}
    name = f"geometry{scene.path.suffix}"
    return case.model_copy(update={"scene": scene.model_copy(update={"file": name})}), {
        name: scene.path
    }


def text_of(case: Case) -> str:
    """The case with all its values in force, as the text of a case file."""
    return yaml_file.text_of(case.resolved())
