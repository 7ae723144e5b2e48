"""Keys and commands on the page about geometries of one's own (configs/examples/README.md)."""

import re
from pathlib import Path

from lithofrac.arguments import parser
from lithofrac.cli import main
from lithofrac.config import load_case
from lithofrac.scenes import make_mesh, make_problem


def blocks(language):
    """Code of that language in the page on own geometries."""
    page = Path("configs/examples/README.md").read_text()
    return re.findall(rf"```{language}[^\n]*\n(.*?)```", page, flags=re.DOTALL)


def test_the_keys_on_the_page_are_right(tmp_path):
    (tmp_path / "stope.geo").write_text(Path("configs/examples/stope.geo").read_text())
    (keys,) = blocks("yaml")
    (tmp_path / "own.yaml").write_text(keys)
    case = load_case(tmp_path / "own.yaml")
    assert make_problem(case, make_mesh(case)).measures.axial_load == "top_y"


def test_the_commands_on_the_page_are_right(capsys):
    commands = blocks("sh")[0]
    check, *others = [line.split()[1:] for line in commands.splitlines()]
    assert main(check) == 0
    assert "Two interacting holes" in capsys.readouterr().out
    for command in others:
        parser().parse_args(command)
