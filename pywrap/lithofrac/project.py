"""Start a project: a small commented folder with a case, a material, a study and a README."""

from __future__ import annotations

import shutil
from pathlib import Path

from lithofrac.config.errors import ConfigError
from lithofrac.config.material import PACKAGED

TEMPLATE = PACKAGED / "project"


def make(folder: Path) -> list[Path]:
    """Copy the template to `folder`, whole or not at all; returns the files.

    Raises
    ------
    ConfigError
        When the folder, or a file of that name, is there already, or cannot be written.
    """
    if folder.exists() or folder.is_symlink():
        raise ConfigError(f"{folder}: is there already, expected a new name; nothing was changed")
    part = folder.with_name(f".{folder.name}.part")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(TEMPLATE, part, copy_function=shutil.copyfile)
        part.rename(folder)
    except OSError as error:
        raise ConfigError(f"{folder}: cannot be written ({error.strerror})") from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return sorted(folder.iterdir())
