"""Break the code on purpose, a line at a time, and see whether a test notices.

Mutants are exact replacements of text, in `mutants.yaml`. Each is made in a copy of the working
tree, built there in increments, and tried by the few tests that are named for it. The code as it
stands is tried first, by all of these tests (the control). What survives is a hole in the tests.

`python3 tasks.py mutants` runs all and writes `reports/mutants.md`; with names of mutants it runs
these alone and writes nothing.
"""

import argparse
import os
import platform
import queue
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import yaml
from named_tests import missing

ROOT = Path(__file__).parents[2]
LIST = Path(__file__).with_name("mutants.yaml")
TABLE = ROOT / "reports" / "mutants.md"
WORK = ROOT / "build" / "mutants"
BIN = Path(sys.executable).parent
TIME_LIMIT = 300.0  # s, of the tests of a mutant: one that never ends is caught by that
OPTIONS = ("-Dbuildtype=release",)
CONTROL = "control"


class MutationError(Exception):
    """The list of mutants does not fit the code."""


@dataclass(frozen=True)
class Edit:
    """One replacement of text; `old` stands in `file` exactly once."""

    file: str
    old: str
    new: str


@dataclass(frozen=True)
class Mutant:
    """One way to be wrong, and the tests that should see it."""

    name: str
    breaks: str  # what, in words
    edits: tuple[Edit, ...]
    tests: tuple[str, ...]  # FILE or FILE::TEST, quick ones first


@dataclass(frozen=True)
class Outcome:
    """What came of a mutant."""

    mutant: Mutant
    caught: bool
    by: str  # the first test that failed, or why there is none
    seconds: float  # of build and tests


# ---------------------------------------------------------------- the list


def load(path: Path = LIST) -> list[Mutant]:
    """The mutants of a file.

    Raises
    ------
    MutationError
        When an entry lacks a key, has one too many, or repeats a name.
    """
    mutants: list[Mutant] = []
    for entry in yaml.safe_load(path.read_text(encoding="utf-8")):
        name = entry.get("name", "without a name")
        if set(entry) != {"name", "breaks", "edits", "tests"}:
            raise MutationError(f"mutant {name}: expected just name, breaks, edits and tests")
        if name == CONTROL or name in [mutant.name for mutant in mutants]:
            raise MutationError(f"mutant {name}: there is another one of this name")
        edits = tuple(Edit(**edit) for edit in entry["edits"])
        mutants.append(Mutant(name, entry["breaks"], edits, tuple(entry["tests"])))
    return mutants


def misfits(mutants: list[Mutant], root: Path = ROOT) -> list[str]:
    """Sentences on what no longer fits: text that is gone or not unique, tests that are gone."""
    found = []
    for mutant in mutants:
        for edit in mutant.edits:
            path = root / edit.file
            count = path.read_text(encoding="utf-8").count(edit.old) if path.is_file() else 0
            if count != 1:
                found.append(
                    f"mutant {mutant.name}: its old text stands {count} times in {edit.file}, "
                    f"expected once: {edit.old.strip()!r}"
                )
            if edit.old == edit.new:
                found.append(f"mutant {mutant.name}: it changes nothing")
        if not mutant.tests:
            found.append(f"mutant {mutant.name}: no test is named")
        for test in mutant.tests:
            wrong = missing(test, root)
            found += [f"mutant {mutant.name}: {wrong}"] if wrong else []
    return found


# ---------------------------------------------------------------- one lane: a tree and its build


@dataclass
class Lane:
    """A copy of the working tree with a build of its own."""

    home: Path
    jobs: int = 1  # compilers at a time

    @property
    def tree(self) -> Path:
        return self.home / "tree"

    @property
    def site(self) -> Path:
        return self.home / "site"

    def prepare(self, root: Path) -> None:
        """Bring the copy up to date; files that are equal keep their time, so ninja rests."""
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=root, check=True, capture_output=True, text=True,
        ).stdout.split("\0")  # fmt: skip
        wanted = {name for name in listed if name and (root / name).is_file()}
        for name in wanted:
            source, target = root / name, self.tree / name
            if target.is_file() and target.read_bytes() == source.read_bytes():
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
        for path in [path for path in self.tree.rglob("*") if path.is_file()]:
            if path.relative_to(self.tree).as_posix() not in wanted:
                path.unlink()

    def build(self) -> str:
        """Compile what has changed and install it; words if that fails."""
        folder = self.home / "build"
        commands = [
            [BIN / "ninja", "-C", folder, "-j", str(self.jobs), "--quiet"],
            [BIN / "meson", "install", "-C", folder, "--no-rebuild", "--only-changed", "--quiet"],
        ]
        if not (folder / "build.ninja").exists():
            places = [f"-Dpython.{kind}libdir={self.site}" for kind in ("plat", "pure")]
            commands.insert(0, [BIN / "meson", "setup", folder, self.tree, *places, *OPTIONS])
        env = os.environ | {"PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}"}
        for command in commands:
            done = subprocess.run(command, env=env, capture_output=True, text=True)
            if done.returncode:
                return (done.stdout + done.stderr)[-3000:]
        return ""

    def run_tests(self, tests: tuple[str, ...], *options: str) -> subprocess.CompletedProcess:
        """Run pytest in the copy, on its build; raises `subprocess.TimeoutExpired`."""
        env = os.environ | {
            "PYTHONPATH": str(self.site),
            "PYTHONDONTWRITEBYTECODE": "1",  # sources change within the second that a cache sees
            "LITHOFRAC_BUILD": "release",
            "OMP_NUM_THREADS": "1",
            "OMP_WAIT_POLICY": "passive",
            "MPLBACKEND": "Agg",
        }
        return subprocess.run(
            [BIN / "python", "-m", "pytest", "-rfE", "--tb=line", "-p", "no:cacheprovider",
             *options, *tests],
            cwd=self.tree, env=env, capture_output=True, text=True, timeout=TIME_LIMIT,
        )  # fmt: skip


def mutate(mutant: Mutant, tree: Path) -> Callable[[], None]:
    """Make the edits of a mutant in a tree; returns what takes them back."""
    before = {edit.file: (tree / edit.file).read_text(encoding="utf-8") for edit in mutant.edits}
    for edit in mutant.edits:
        path = tree / edit.file
        path.write_text(path.read_text(encoding="utf-8").replace(edit.old, edit.new))

    def take_back() -> None:
        for file, text in before.items():
            (tree / file).write_text(text)

    return take_back


def verdict(code: int, words: str) -> tuple[bool, str]:
    """Is it caught, and by what; from pytest's exit code and what it printed."""
    if code == 0:
        return False, "survives"
    failed = re.search(r"^(?:FAILED|ERROR) (\S+)", words, re.MULTILINE)
    if code == 1 and failed:
        return True, failed[1]
    if code < 0:
        return True, f"the process ends with signal {-code}"
    return False, "its tests do not run:\n" + words[-3000:]


def try_mutant(mutant: Mutant, lane: Lane) -> Outcome:
    """Make a mutant, build it, and run its tests."""
    start = time.monotonic()
    take_back = mutate(mutant, lane.tree)
    try:
        wrong = lane.build()
        if wrong:
            caught, by = False, "it does not compile:\n" + wrong
        else:
            done = lane.run_tests(mutant.tests, "--exitfirst")
            caught, by = verdict(done.returncode, done.stdout + done.stderr)
    except subprocess.TimeoutExpired:
        caught, by = True, f"no end within {TIME_LIMIT:.0f} s"
    finally:
        take_back()
    return Outcome(mutant, caught, by, time.monotonic() - start)


def try_control(tests: tuple[str, ...], lane: Lane) -> Outcome:
    """Run all tests on the code as it stands; `caught` is then bad news."""
    start = time.monotonic()
    control = Mutant(CONTROL, "nothing", (), tests)
    wrong = lane.build()
    if wrong:
        return Outcome(control, True, wrong, time.monotonic() - start)
    try:
        done = lane.run_tests(tests)
    except subprocess.TimeoutExpired:
        return Outcome(control, True, f"no end within {TIME_LIMIT:.0f} s", TIME_LIMIT)
    words = done.stdout if done.returncode else done.stdout.strip().splitlines()[-1].strip("= ")
    return Outcome(control, done.returncode != 0, words, time.monotonic() - start)


# ---------------------------------------------------------------- all of them


def run(mutants: list[Mutant], root: Path, n_lanes: int, say=print) -> list[Outcome]:
    """Outcomes, that of the control first, then in the order of the mutants."""
    lanes: queue.Queue[Lane] = queue.Queue()
    jobs = max(1, (os.cpu_count() or 1) // n_lanes)
    tests = tuple(dict.fromkeys(test for mutant in mutants for test in mutant.tests))

    def in_a_lane(mutant: Mutant | None) -> Outcome:
        lane = lanes.get()
        try:
            outcome = try_mutant(mutant, lane) if mutant else try_control(tests, lane)
        finally:
            lanes.put(lane)
        if not mutant:
            say(f"{'FAILS' if outcome.caught else 'passes':8} {CONTROL}: {outcome.by}")
        else:
            word = "caught" if outcome.caught else "ALIVE"
            say(f"{word:8} {mutant.name} ({outcome.seconds:.1f} s): {outcome.by}")
        return outcome

    for number in range(n_lanes):
        lane = Lane(WORK / f"lane{number + 1}", jobs)
        lane.prepare(root)
        lanes.put(lane)
    with ThreadPoolExecutor(n_lanes) as pool:
        return list(pool.map(in_a_lane, [None, *mutants]))


def commit_of(root: Path) -> str:
    """The commit of the code that was tried, and whether it had changes."""

    def git(*words):
        return subprocess.run(
            ["git", *words], cwd=root, capture_output=True, text=True
        ).stdout.strip()

    changed = git("status", "--porcelain", "--", ".", ":!reports")
    return git("rev-parse", "--short", "HEAD") + (" with changes" if changed else "")


def table(
    outcomes: list[Outcome], commit: str, seconds: float, processors: float, n_lanes: int
) -> str:
    """The report, Markdown."""
    control, *tried = outcomes
    caught = sum(outcome.caught for outcome in tried)
    lines = [
        "# Mutants: do the tests notice?",
        "",
        "Each row is one deliberate mistake, made in a copy of the code and tried by a few quick",
        "tests that are named for it (`tests/reliability/mutants.yaml`). A mutant that",
        "no test fails on would be a hole in the tests. Written by `python3 tasks.py mutants`.",
        "",
        f"- Commit: {commit}",
        f"- Caught: {caught} of {len(tried)}",
        f"- The code as it stands, by the same tests: {control.by}",
        f"- Time: {seconds / 60:.1f} minutes, {n_lanes} at a time; of processors "
        f"{processors / 60:.1f} minutes ({platform.machine()})",
        "",
        "| mutant | file | what is wrong | caught by | seconds |",
        "|---|---|---|---|---|",
    ]
    for outcome in tried:
        mutant = outcome.mutant
        files = ", ".join(dict.fromkeys(f"`{edit.file}`" for edit in mutant.edits))
        by = outcome.by.splitlines()[0].removeprefix("tests/") if outcome.by else ""
        by = f"`{by}`" if outcome.caught else f"**nothing: {by}**"
        lines.append(f"| {mutant.name} | {files} | {mutant.breaks} | {by} "
                     f"| {outcome.seconds:.0f} |")  # fmt: skip
    return "\n".join(lines) + "\n"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="tasks.py mutants", description=__doc__)
    parser.add_argument("names", nargs="*", help="mutants to run, all by default")
    parser.add_argument("--lanes", type=int, default=max(1, min(4, os.cpu_count() or 1)))
    given = parser.parse_args(arguments)
    mutants = load()
    unknown = set(given.names) - {mutant.name for mutant in mutants}
    wrong = [f"mutant {name}: no such one" for name in sorted(unknown)] or misfits(mutants)
    if wrong:
        print("\n".join(wrong), file=sys.stderr)
        return 2
    chosen = [m for m in mutants if m.name in given.names] if given.names else mutants
    start = time.monotonic()
    outcomes = run(chosen, ROOT, given.lanes)
    seconds = time.monotonic() - start
    if not given.names:
        times = os.times()
        text = table(
            outcomes,
            commit_of(ROOT),
            seconds,
            times.children_user + times.children_system,
            given.lanes,
        )
        TABLE.write_text(text, encoding="utf-8")
    control, *tried = outcomes
    alive = [outcome for outcome in tried if not outcome.caught]
    print(f"{len(tried) - len(alive)} of {len(tried)} caught in {seconds:.0f} s")
    return 1 if alive or control.caught else 0


if __name__ == "__main__":
    sys.exit(main())
