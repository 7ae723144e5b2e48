"""Keys from the command line, and a case written back as YAML."""

import yaml

from lithofrac.config.case import Case
from lithofrac.config.errors import ConfigError
from lithofrac.config.yaml_file import parsed


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
            raise ConfigError(f"--set {word}: expected KEY=VALUE")
        found[key.strip()] = parsed(text, f"--set {key}")
    return found


def text_of(case: Case) -> str:
    """The case with all its values in force, as the text of a case file."""
    return yaml.safe_dump(case.resolved(), sort_keys=False, allow_unicode=True)
