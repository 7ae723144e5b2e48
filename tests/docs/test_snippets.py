"""Every command and every file of the documentation, run as its reader would.

A page is one session: its fenced blocks are taken in order, in a temporary folder that has the
configs and the data of the checkout; that of a project, in the folder of the project. Words behind
the language of a block say more: pages.py. Those that set up, build or submit are run by
test_clone.py; here their programs, commands and options must exist.

Commands of lithofrac run in this process, through `main`: starting forty would take a minute.
"""

import contextlib
import doctest
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from pages import FLAGS, OPTIONS, PAGES, ROOT, Block, blocks, commands, name_of, spans

from lithofrac.arguments import parser
from lithofrac.cli import COMMANDS, main
from lithofrac.config.yaml_file import read_yaml

pytestmark = pytest.mark.no_core  # it runs cases, but what is tested is not the build of the core

RULES = [ROOT / "Snakefile", *(ROOT / "pywrap" / "rules").glob("*.smk")]
TARGET = re.compile(r"[a-z_]+\Z")
ELSEWHERE = {"clone", "itself"}  # not run in this session


def subparser(command):
    """Parser of one command of lithofrac."""
    return next(a for a in parser()._actions if a.choices and command in a.choices).choices[command]


def check_lithofrac(words, whole=True):
    """A command with its options, and where it is whole with all it needs."""
    if words[:1] == ["--version"]:
        return
    assert words[0] in COMMANDS, f"lithofrac has no command {words[0]}"
    if whole:
        parser().parse_args(words)
        return
    known = subparser(words[0])._option_string_actions
    for word in words[1:]:
        assert not word.startswith("--") or word in known, f"lithofrac {words[0]} has no {word}"


def check_tasks(words, whole=True):
    """A task of tasks.py and its options."""
    text = (ROOT / "tasks.py").read_text()
    assert f"python3 tasks.py {words[0]} " in text, f"tasks.py has no task {words[0]}"
    for word in words[1:]:
        passed_on = words[0] == "reproduce" and word == "--dry-run"  # to Snakemake
        assert not word.startswith("-") or word in text or passed_on, f"tasks.py has no {word}"


def check_snakemake(words, whole=True):
    """Targets that are rules."""
    rules = "".join(path.read_text() for path in RULES)
    value_of = ""
    for word in words:
        value = value_of in ("--cores", "--config") or value_of.startswith("--slurm-status")
        if TARGET.match(word) and not value:
            assert f"rule {word}:" in rules, f"there is no rule {word}"
        if value_of == "--profile":
            assert (ROOT / word / "config.yaml").is_file(), f"there is no profile {word}"
        value_of = word


def check_python(words, whole=True):
    """A task of tasks.py, `-m venv`, or a command that the Slurm of the tests is started for."""
    if words[:2] == ["-m", "venv"]:
        return
    if words[:1] == ["tests/slurm/one_node.py"]:
        CHECKS[words[1]](words[2:], whole)
        return
    assert words[:1] == ["tasks.py"], f"python3 {' '.join(words)}: expected a task of tasks.py"
    check_tasks(words[1:], whole)


def nothing_to_check(words, whole=True):
    """Programs that are not ours."""


CHECKS = {
    "lithofrac": check_lithofrac,
    "python3": check_python,
    "snakemake": check_snakemake,
    "pip": nothing_to_check,
    "pytest": nothing_to_check,
    ".": nothing_to_check,
}


class Readings:
    """Files that this process opens for reading, while somebody listens."""

    def __init__(self):
        self.of: set | None = None

    def __call__(self, event, arguments):
        if event == "open" and self.of is not None and isinstance(arguments[0], (str, os.PathLike)):
            if not set(arguments[1] or "r") & set("wax"):
                self.of.add(os.path.abspath(arguments[0]))


READINGS = Readings()
sys.addaudithook(READINGS)  # one for all tests, as none is ever taken away


class Session:
    """A reader at work on one page."""

    def __init__(self, folder, monkeypatch, slow):
        self.folder, self.monkeypatch, self.slow = folder, monkeypatch, slow
        self.names: dict = {"__name__": "page"}
        self.saved: dict = {}  # path -> block
        self.read: set = set()  # paths that commands and Python have read

    def take(self, block):
        """Do what a block says."""
        unknown = (block.flags - FLAGS) | (block.options.keys() - OPTIONS)
        assert not unknown, f"{block}: unknown words {sorted(unknown)}"
        language = block.language
        if language == "math":  # tests/docs/test_theory.py
            return
        if "file" in block.options:
            self.save(block)
        elif language == "sh":
            for words in commands(block.text):
                self.run(block, words)
        elif language == "console":
            self.compare(block)
        elif language == "python":
            code = compile(block.text, str(block), "exec")
            if self.slow or "slow" not in block.flags:
                with self.listening():
                    exec(code, self.names)
        else:
            pytest.fail(f"{block}: a block in {language or 'no language'} that nothing runs")

    def save(self, block):
        """A block that is a file."""
        path = Path(block.options["file"])
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(block.text, encoding="utf-8")
        self.saved[str(path.absolute())] = block
        if path.suffix == ".yaml":
            read_yaml(path)

    @contextlib.contextmanager
    def listening(self):
        """Note which files are read."""
        READINGS.of = self.read
        try:
            yield
        finally:
            READINGS.of = None

    def unread(self):
        """Saved files that nothing has read."""
        return [f"{block}: {path}" for path, block in self.saved.items() if path not in self.read]

    def run(self, block, words):
        """One command; returns what it printed."""
        program, *rest = words
        if block.flags & ELSEWHERE or ("slow" in block.flags and not self.slow):
            program = Path(program).name or program  # own/bin/pip
            assert program in CHECKS, f"{block}: {program}: nobody knows how to check it"
            CHECKS[program](rest)
            if "clone" in block.flags:  # which see to it that the files are there
                self.read |= {path for path in self.saved if Path(path).name in block.text}
            return ""
        if program == "cd":
            self.monkeypatch.chdir(*rest)
            return ""
        if program == "sh":
            done = subprocess.run(words, capture_output=True, text=True, timeout=600)
            self.read.add(os.path.abspath(rest[0]))
            assert done.returncode == 0, f"{block}: {shlex.join(words)}: {done.stderr}"
            return done.stdout
        assert program == "lithofrac", f"{block}: {program}: expected lithofrac, or `clone`"
        if rest[0] in ("run", "study"):
            rest += shlex.split(block.options.get("add", ""))
        rest = [file for word in rest for file in expanded(word)]
        out, err = io.StringIO(), io.StringIO()
        streams = contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)
        with streams[0], streams[1], self.listening():
            try:
                code = main(rest)
            except SystemExit as ended:  # --version
                code = ended.code
        assert not code, f"{block}: lithofrac {shlex.join(rest)}: exit {code}: {err.getvalue()}"
        return out.getvalue()

    def compare(self, block):
        """Commands behind `$`, each with its output; `...` stands for anything."""
        for part in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
            command, _, wanted = part.partition("\n")
            (words,) = commands(command)
            got = self.run(block, words)
            same = doctest.OutputChecker().check_output(wanted, got, doctest.ELLIPSIS)
            assert same, f"{block}: {command} printed\n{got}\nexpected\n{wanted}"


def expanded(word):
    """Files of a pattern, or the word."""
    return sorted(str(path) for path in Path().glob(word)) if "*" in word else [word]


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """reader(page, slow) -> a session in a folder like the checkout or a project."""
    for name in ("configs", "data"):
        shutil.copytree(ROOT / name, tmp_path / name)
    programs = tmp_path / ".bin"
    programs.mkdir()
    program = programs / "lithofrac"
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m lithofrac "$@"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")

    def start(page, slow):
        project = page.parent if (page.parent / "case.yaml").is_file() else ROOT
        folder = tmp_path / project.relative_to(ROOT)
        monkeypatch.chdir(folder)
        return Session(folder, monkeypatch, slow)

    return start


@pytest.mark.parametrize("page", [page for page in PAGES if any(blocks(page))], ids=name_of)
def test_a_page_does_what_it_says(page, reader):
    session = reader(page, slow=False)
    for block in blocks(page):
        session.take(block)
    assert not session.unread(), "saved and not read by any command of the page"


@pytest.mark.slow
@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if any("slow" in one.flags for one in blocks(page))],
    ids=name_of,
)
def test_the_long_commands_of_a_page_run(page, reader):
    session = reader(page, slow=True)
    for block in blocks(page):
        session.take(block)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_within_sentences_exist(page):
    for line, text in spans(page):
        for words in commands(text) if text.split(" ")[0] in CHECKS else ():
            try:
                if len(words) > 1 and words[0] in CHECKS:
                    CHECKS[words[0]](words[1:], whole=False)
            except AssertionError as error:
                pytest.fail(f"{page.name}:{line}: `{text}`: {error}")


PLACES = ("fortran/", "pywrap/", "configs/", "data/", "reports/", "tests/")
PLACEHOLDER = re.compile(r"[A-Z]{4,}|\{[a-z.]+\}")  # KIND, NAME; {suffix} of a file name


def alternatives(text):
    """`a/{b,c}.py` -> a/b.py, a/c.py."""
    found = re.search(r"\{([^{}]*)\}", text)
    if not found:
        return [text]
    parts = found[1].split(",")
    return [w for p in parts for w in alternatives(text[: found.start()] + p + text[found.end() :])]


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_places_that_are_named_are_there(page):
    """Files and folders of the checkout in inline code; with them the map of the house."""
    for line, text in spans(page):
        if not text.startswith(PLACES) or " " in text or PLACEHOLDER.search(text.split("/")[-1]):
            continue
        if PLACEHOLDER.search(text):
            continue
        for place in alternatives(text):
            assert list(ROOT.glob(place.rstrip("/"))), f"{page.name}:{line}: {place}"


def test_every_folder_of_the_code_is_on_the_map():
    text = (ROOT / "CONTRIBUTING.md").read_text()
    folders = [*(ROOT / "fortran").glob("*/"), *(ROOT / "pywrap" / "lithofrac").glob("*/")]
    for folder in folders:
        if folder.is_dir() and folder.name != "__pycache__":
            assert f"`{folder.relative_to(ROOT).as_posix()}/" in text, folder.name


def test_the_reader_refuses_what_nothing_runs(reader):
    page = PAGES[0]
    session = reader(page, slow=False)
    for block in (
        Block(page, 1, "yaml", "a: 1"),
        Block(page, 1, "sh", "rm -r out"),
        Block(page, 1, "sh", "lithofrac frobnicate", frozenset({"clone"})),
        Block(page, 1, "sh", "python3 tasks.py frobnicate", frozenset({"clone"})),
        Block(page, 1, "sh", "snakemake frobnicate", frozenset({"clone"})),
        Block(page, 1, "sh", "lithofrac plot x --out x.svg", frozenset({"exits"})),
        Block(page, 1, "console", "$ lithofrac --version\nno such line\n"),
    ):
        with pytest.raises((AssertionError, pytest.fail.Exception)):
            session.take(block)


def test_a_saved_file_that_nothing_reads_is_found(reader):
    page = PAGES[0]
    session = reader(page, slow=False)
    text = "confinement_MPa,strength_MPa\n0,50\n10,90\n"
    for name in ("read.csv", "forgotten.csv"):
        session.take(Block(page, 1, "csv", text, options={"file": name}))
    session.take(Block(page, 5, "python", 'lines = open("read.csv").readlines()'))
    (found,) = session.unread()
    assert found.endswith("forgotten.csv")
