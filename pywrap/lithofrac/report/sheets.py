"""Which figures stand on which sheet.

A sheet names its figures, by file name without suffix, in a comment that Markdown does not show:

    <!-- figures: punch fractures_punch_* events_punch_* -->

`*` stands for anything. The sheet is the scene: its page and its category in the report show these
figures, each once, in this order. In the sheet as it is committed, pictures of those that are in
the gallery follow the comment; a page has its figures in their place.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from lithofrac.data import DataError

FIGURES = re.compile(
    r"(?P<comment><!-- figures:(?P<patterns>( +[\w.*?@\[\]-]+)+) -->\n)"
    r"(!\[[^\]\n]*\]\([^)\n]*\)\n)*"
)


@dataclass(frozen=True)
class Sheet:
    """One V&V sheet.

    name : of its file without suffix; begins with its number
    title : its first heading
    text : the whole file
    """

    name: str
    title: str
    text: str

    @property
    def category(self) -> str:
        """Number and title, by which the report sorts."""
        return f"{self.name.split('_')[0]} {self.title}"

    def figures(self, names: list[str]) -> list[str]:
        """Those of the figures that stand on this sheet, in its order."""
        blocks = FIGURES.finditer(self.text)
        found = [chosen(block["patterns"], names) for block in blocks]
        return list(dict.fromkeys(name for some in found for name in some))


def load_sheets(folder: Path) -> list[Sheet]:
    """All sheets of a folder, in the order of their names."""
    sheets = []
    for path in sorted(Path(folder).glob("*.md")):
        text = path.read_text(encoding="utf-8")
        sheets.append(Sheet(path.stem, text.splitlines()[0].lstrip("# "), text))
    return sheets


def category_of(figure: str, sheets: list[Sheet]) -> str:
    """Category of the first sheet that shows a figure.

    Raises
    ------
    DataError
        When none does.
    """
    for sheet in sheets:
        if sheet.figures([figure]):
            return sheet.category
    raise DataError(
        f"figure {figure}: stands on no sheet, expected it in a comment <!-- figures: ... -->"
    )


def place(text: str, names: list[str], show: Callable[[str], str]) -> str:
    """Put what `show(name)` gives of each figure where the comments of a sheet name it."""
    return _shown(text, names, lambda comment, some: "\n".join(map(show, some)))


def pictured(text: str, names: list[str], folder: str) -> str:
    """A sheet with links to the pictures `folder/NAME.png` below the comments that name them."""

    def below(comment: str, some: list[str]) -> str:
        return comment + "".join(f"![{name}]({folder}/{name}.png)\n" for name in some)

    return _shown(text, names, below)


def _shown(text: str, names: list[str], put: Callable[[str, list[str]], str]) -> str:
    """Replace each comment of a sheet by what `put` makes of it and its figures, each once."""
    shown: set[str] = set()

    def placed(block: re.Match) -> str:
        some = [name for name in chosen(block["patterns"], names) if name not in shown]
        shown.update(some)
        return put(block["comment"], some)

    return FIGURES.sub(placed, text)


def chosen(patterns: str, names: list[str]) -> list[str]:
    """Names that fit patterns, those of the first pattern first, each once."""
    fits = [name for pattern in patterns.split() for name in sorted(names)
            if fnmatchcase(name, pattern)]  # fmt: skip
    return list(dict.fromkeys(fits))
