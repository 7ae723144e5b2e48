"""Tests that a table names: do they exist, and who runs them?"""

import ast
from pathlib import Path


def marks_of(path: Path) -> dict[str, bool]:
    """Names of the tests of a file, and whether each is left to `test --all` (marked slow)."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    marks = [
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign)
        and any(isinstance(name, ast.Name) and name.id == "pytestmark" for name in node.targets)
    ]
    return {
        node.name: any("mark.slow" in ast.unparse(mark) for mark in marks + node.decorator_list)
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }


def missing(named: str, root: Path) -> str:
    """What is wrong with `FILE` or `FILE::TEST`, relative to `root`; empty if it exists."""
    file, _, test = named.partition("::")
    if not (root / file).is_file():
        return f"{named}: no such file"
    tests = marks_of(root / file)
    if not tests:
        return f"{named}: the file has no tests"
    if test and test not in tests:
        return f"{named}: the file has no such test"
    return ""
