"""What a .geo of anybody's may not hold: gmsh scripts can run commands, and read and write files.

gmsh has no switch that forbids it. The words are looked for everywhere, comments and texts
included, so that no way of quoting hides one. Do not run scripts that you have not read.
"""

import re

COMMANDS = (
    "System", "SystemCall", "NonBlockingSystemCall", "OnelabRun", "OnelabAction", "ExternalProcess",
    "CommandLine", "Plugin", "Solver", "General", "GmshOption", "Sleep",
    "StringToName", "S2N",  # which make any word out of pieces
)  # fmt: skip
FILES = (
    "Include", "Merge", "MergeWithBoundingBox", "ShapeFromFile", "Structured", "FileName",
    "Save", "Print", "Printf", "CreateDir", "View", "PostProcessing",
)  # fmt: skip
FORBIDDEN = re.compile(rf"(?<![A-Za-z0-9_])({'|'.join(COMMANDS + FILES)})(?![A-Za-z0-9_])")


def forbidden(text: str) -> str:
    """Why a script is refused, or nothing if it is not."""
    for number, line in enumerate(text.splitlines(), start=1):
        found = FORBIDDEN.search(line)
        if found:
            what = "run commands" if found[1] in COMMANDS else "read or write files"
            return (
                f"line {number}: the word {found[1]} is refused, even in a comment, because it "
                f"can {what}"
            )
    return ""
