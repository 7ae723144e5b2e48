"""What the pages of the documentation hold: fenced blocks, inline code, commands.

Words behind the language of a block say how it is tested:

slow : so in the quick run (Python is compiled); run with the tests marked slow
clone : run by a shell in a fresh clone of the checkout, with the slow tests (test_clone.py)
slurm : with `clone`, on a real Slurm of one node; skipped where there is none
itself : `tasks.py test`, which runs these tests and so cannot be run by one of them
add="..." : words that each `lithofrac run` and `study` of the block gets, to be short; with
    `clone` each command of the block
file=NAME : the block is saved there

Blocks are read by markdown-it, which the report needs anyway; no kept library runs shell, YAML
and Python of one page in one session.
"""

import re
import shlex
from dataclasses import dataclass, field
from pathlib import Path

from markdown_it import MarkdownIt

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
PAGES += sorted((ROOT / "reports" / "guide").glob("*.md"))
PAGES += sorted(page for top in ("configs", "data") for page in (ROOT / top).rglob("*.md"))
FLAGS, OPTIONS = {"slow", "clone", "slurm", "itself"}, {"add", "file"}
ASSIGNMENT = re.compile(r"[A-Z_]+=.*\Z")


@dataclass(frozen=True)
class Block:
    """One fenced block of a page."""

    page: Path
    line: int
    language: str
    text: str
    flags: frozenset = frozenset()
    options: dict = field(default_factory=dict)

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def blocks(page):
    """Fenced blocks of a page in order."""
    for token in MarkdownIt().parse(page.read_text(encoding="utf-8")):
        if token.type != "fence":
            continue
        language, *words = shlex.split(token.info) or [""]
        pairs = dict(word.split("=", 1) for word in words if "=" in word)
        flags = frozenset(word for word in words if "=" not in word)
        yield Block(page, token.map[0] + 1, language, token.content, flags, pairs)


def spans(page):
    """Inline code of a page: (line, text)."""
    for token in MarkdownIt().enable("table").parse(page.read_text(encoding="utf-8")):
        for child in token.children or ():
            if child.type == "code_inline":
                yield token.map[0] + 1, child.content


def commands(text):
    """Words of each command of a shell block."""
    for line in text.replace("\\\n", " ").splitlines():
        for part in line.split("&&"):
            words = shlex.split(part, comments=True)
            while words and ASSIGNMENT.match(words[0]):
                words = words[1:]
            if words:
                yield words


def name_of(page):
    """Name of a page, as of a test."""
    return page.relative_to(ROOT).as_posix()
