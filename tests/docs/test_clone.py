"""What the documentation says of a new machine and of clusters, done in a fresh clone.

Blocks marked `clone` (pages.py) are run by a shell in a clone of this checkout, as it is committed,
with an environment of its own that `tasks.py setup` makes there. What is submitted goes to a real
Slurm of one node, and to a stand-in for `qsub`, which does each job at once. Ten minutes or so.
"""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from one_node import INSTALL, missing, one_node
from pages import PAGES, ROOT, blocks, commands, name_of, spans

pytestmark = pytest.mark.no_core

OFFLINE = re.compile(r"connection broken by|Network is unreachable|failure in name resolution")
# What a site without accounting adds to its profile, and less patience than a cluster asks for.
SITE = {
    "slurm": "slurm-status-command: squeue\nslurm-no-account: true\n"
    "slurm-init-seconds-before-status-checks: 2\nseconds-between-status-checks: 2\n",
    "pbs": "seconds-between-status-checks: 2\n",
}
QSUB = """\
#!/bin/sh
# That of PBS, with -terse that of Grid Engine; the number of a job is that of this process.
echo "$@" >> "$(dirname "$0")/said"
variable=PBS_JOBID
for word; do
  if [ "$word" = -terse ]; then variable=JOB_ID; fi
done
env -u SLURM_JOB_ID "$variable=$$" sh "$word" > "$(dirname "$0")/$$.log" 2>&1
echo $$
"""
UNKNOWN_JOB = "#!/bin/sh\nexit 1\n"


class Clone:
    """A clone of the checkout, and a reader at work in it."""

    def __init__(self, folder):
        self.folder, self.programs = folder, folder.with_name("programs")
        self.programs.mkdir()
        for name, text in (("qsub", QSUB), ("qstat", UNKNOWN_JOB), ("qdel", UNKNOWN_JOB)):
            (self.programs / name).write_text(text)
            (self.programs / name).chmod(0o755)

    def shell(self, script, slurm=None, timeout=900):
        """Run a script as somebody who knows nothing of the environment of the tests."""
        here = Path(sys.prefix, "bin")
        path = [p for p in os.environ["PATH"].split(os.pathsep) if Path(p) != here]
        dropped = re.compile("PYTHON|VIRTUAL_ENV|LITHOFRAC_|PYTEST|LD_PRELOAD")
        env = {name: value for name, value in os.environ.items() if not dropped.match(name)}
        first = [self.folder / ".venv" / "bin", self.programs]
        if slurm is not None:
            env["SLURM_CONF"] = slurm["SLURM_CONF"]
            first.insert(1, slurm["PATH"].split(os.pathsep)[0])
        env["PATH"] = os.pathsep.join(map(str, [*first, *path]))
        return subprocess.run(
            ["sh", "-e", "-c", script],
            cwd=self.folder, env=env, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout,
        )  # fmt: skip


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """A clone in which nothing has been done yet but what `tasks.py setup` does."""
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("this is no checkout of git, so there is nothing to clone")
    folder = tmp_path_factory.mktemp("clone") / "lithofrac"
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
    for name, words in SITE.items():
        with open(folder / "configs" / "profiles" / name / "config.yaml", "a") as profile:
            profile.write(words)
    made = Clone(folder)
    done = made.shell("python3 tasks.py setup")
    if done.returncode and OFFLINE.search(done.stdout):
        pytest.skip("no package index is reached from here")
    assert done.returncode == 0, done.stdout
    return made


@pytest.fixture(scope="module")
def slurm():
    """Environment of a Slurm of one node, or None where there is none."""
    if missing():
        yield None
    else:
        with one_node() as environment:
            yield environment


def script(block):
    """The block as it is run: with what shall make it short behind each command."""
    more = block.options.get("add", "")
    lines = block.text.replace("\\\n", " ").splitlines()
    return "\n".join(f"{line.partition(' #')[0]} {more}" for line in lines if line.strip())


def marked(page, *flags):
    return [block for block in blocks(page) if set(flags) <= block.flags]


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if marked(page, "clone")], ids=name_of)
def test_a_clone_does_what_a_page_says(page, clone, slurm):
    lacking = False
    for block in blocks(page):
        if "file" in block.options:
            path = clone.folder / block.options["file"]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, encoding="utf-8")
        elif "slurm" in block.flags and slurm is None:
            lacking = True
        elif "clone" in block.flags:
            own = "one_node.py" in block.text
            done = clone.shell(script(block), slurm if "slurm" in block.flags and not own else None)
            assert done.returncode == 0, f"{block}: {done.stdout[-5000:]}"
    if lacking:
        pytest.skip(f"all but Slurm: no {', '.join(missing())}; on Debian: {INSTALL}")


@pytest.mark.slow
def test_what_is_submitted_by_qsub_names_time_and_memory(clone, slurm):
    """Words of the page on clusters, as the stand-in was given them by the test before."""
    page = ROOT / "reports" / "guide" / "cluster.md"
    if not said(clone):  # where this test runs alone
        test_a_clone_does_what_a_page_says(page, clone, slurm)
    words = said(clone)
    assert re.search(r"-l select=1:ncpus=\d+:mem=\d+mb,walltime=\d+:\d+:00 ", words)
    assert re.search(r"-terse .* -pe smp \d+ -l h_vmem=\d+M,h_rt=\d+ ", words)


def said(clone):
    """What the stand-in for qsub was given."""
    path = clone.programs / "said"
    return path.read_text() if path.exists() else ""


@pytest.mark.slow
def test_installers_within_sentences_would_install(clone):
    found = {text for page in PAGES for _, text in spans(page) if text.startswith("pip install ")}
    assert found
    for text in sorted(found):
        done = clone.shell(text.replace("pip install", "pip install --dry-run --no-deps"))
        assert done.returncode == 0, f"{text}: {done.stdout[-2000:]}"


def test_packages_of_the_system_exist():
    """By a simulation of apt, of the packages that pages and `setup` name."""
    if shutil.which("apt-get") is None:
        pytest.skip("no apt-get: this is no Debian")
    spec = importlib.util.spec_from_file_location("tasks", ROOT / "tasks.py")
    tasks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tasks)
    lists = [words for page in PAGES for _, text in spans(page)
             for words in commands(text) if words[:2] == ["apt-get", "install"]]  # fmt: skip
    assert lists
    if asked("apt-cache", "show", "slurmd").returncode:
        pytest.skip("apt knows nothing: apt-get update was never called here")
    for words in [*lists, ["apt-get", "install", *tasks.APT]]:
        done = asked("apt-get", "-s", *words[1:])
        assert done.returncode == 0, done.stderr


def asked(*words):
    """What a program that changes nothing says."""
    return subprocess.run(words, capture_output=True, text=True, timeout=60)


def test_only_what_runs_the_tests_is_left_to_itself():
    """CI calls `tasks.py test`; no other command may be marked so."""
    found = [words for page in PAGES for block in marked(page, "itself")
             for words in commands(block.text)]  # fmt: skip
    assert found and all(words[:3] == ["python3", "tasks.py", "test"] for words in found)
    assert "exec python3 tasks.py test" in (ROOT / ".ci" / "run").read_text()
