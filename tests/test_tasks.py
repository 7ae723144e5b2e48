"""The front (tasks.py): what it says, what it refuses, and that a second call does nothing."""

import ast
import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture
def tasks(monkeypatch, tmp_path):
    """tasks.py as a module that works on an empty tree of its own."""
    spec = importlib.util.spec_from_file_location("tasks", ROOT / "tasks.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for name in ("pyproject.toml", "meson.build", "meson.options", "requirements.txt"):
        (tmp_path / name).write_text(name)
    (tmp_path / "fortran").mkdir()
    (tmp_path / "fortran" / "table.f90").write_text("module table")
    for name in ("pywrap", "configs", "build"):
        (tmp_path / name).mkdir()
    for name in ("ROOT", "VENV", "BIN", "BUILD", "LOG"):
        path = getattr(module, name)
        monkeypatch.setattr(module, name, tmp_path / path.relative_to(ROOT))
    monkeypatch.setattr(module, "say", lambda text: None)
    return module


@pytest.fixture
def calls(tasks, monkeypatch):
    """Commands that tasks.py would have run; all succeed."""
    made = []

    def record(*command, **_):
        made.append([str(word) for word in command])
        return 0

    monkeypatch.setattr(tasks, "call", record)
    return made


@pytest.mark.no_core
@pytest.mark.parametrize(
    ("kind", "everything", "markers"),
    [
        ("release", False, "not slow"),
        ("release", True, ""),
        ("checked", False, "not slow and not no_core and not one_build"),
        ("sanitize", False, "not slow and not no_core and not one_build"),
        ("checked", True, "not slow and not no_core"),
        ("sanitize", True, "not slow and not no_core"),
    ],
)
def test_each_build_runs_what_tells_something_about_it(tasks, kind, everything, markers):
    assert tasks.markers_of(kind, everything) == markers


def run_front(*arguments):
    return subprocess.run(
        [sys.executable, ROOT / "tasks.py", *arguments], capture_output=True, text=True
    )


def test_loaded_package_is_the_build_under_test(build):
    """Otherwise the checked and the sanitizer runs would silently test the release build."""
    import lithofrac._core

    inside = Path(lithofrac._core.__file__).is_relative_to(ROOT / "build" / f"{build}-site")
    assert inside == (build != "release")


@pytest.mark.no_core
def test_front_needs_only_the_standard_library():
    tree = ast.parse((ROOT / "tasks.py").read_text())
    names = {
        name.split(".")[0]
        for node in ast.walk(tree)
        for name in (
            [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else [node.module]
            if isinstance(node, ast.ImportFrom)
            else []
        )
    }
    assert names <= sys.stdlib_module_names


@pytest.mark.no_core
def test_old_python_can_read_the_front_and_is_refused_in_a_sentence(tasks):
    ast.parse((ROOT / "tasks.py").read_text(), feature_version=(3, 7))
    with pytest.raises(SystemExit, match=r"needs Python 3\.11 or newer; this is 3\.9\."):
        tasks.refuse_old_python((3, 9, 2))
    tasks.refuse_old_python((3, 11, 0))


@pytest.mark.no_core
def test_without_rights_one_message_says_what_to_install(tasks, calls, monkeypatch):
    monkeypatch.setenv("FC", "no-such-compiler")
    monkeypatch.setattr(tasks, "may_use_apt", lambda: False)
    with pytest.raises(SystemExit) as stopped:
        tasks.install_system()
    message = str(stopped.value)
    assert "lacks: a Fortran compiler" in message
    for way in ("sudo apt-get install gfortran", "sudo dnf install", "brew install gcc",
                "module load gcc", "conda create"):  # fmt: skip
        assert way in message
    assert calls == []


@pytest.mark.no_core
def test_what_root_lacks_is_installed_and_nothing_else(tasks, calls, monkeypatch):
    lacking = [{"a Fortran compiler": ["gfortran"]}, {}]
    monkeypatch.setattr(tasks, "missing_from_system", lambda: lacking.pop(0))
    monkeypatch.setattr(tasks, "may_use_apt", lambda: True)
    tasks.install_system()
    assert calls[-1][:2] == ["apt-get", "install"]
    assert [word for word in calls[-1][2:] if not word.startswith("-")] == ["gfortran"]


@pytest.mark.no_core
def test_second_set_up_runs_no_command(tasks, calls, monkeypatch):
    monkeypatch.setattr(tasks, "install_system", lambda: None)
    tasks.VENV.mkdir()
    tasks.setup()
    assert len(calls) == 4  # venv, pip, requirements, build
    tasks.setup()
    assert len(calls) == 4


@pytest.mark.no_core
@pytest.mark.parametrize(
    ("change", "commands"),
    [
        (lambda tasks: (tasks.ROOT / "fortran" / "table.f90").write_text("changed"), 1),
        (lambda tasks: (tasks.ROOT / "requirements.txt").write_text("changed"), 3),
        (lambda tasks: shutil.rmtree(tasks.VENV), 4),
    ],
    ids=["source: build", "requirements: pip, all, build", "no venv: everything"],
)
def test_change_repeats_only_what_depends_on_it(tasks, calls, monkeypatch, change, commands):
    monkeypatch.setattr(tasks, "install_system", lambda: None)
    tasks.VENV.mkdir()
    tasks.setup()
    calls.clear()
    change(tasks)
    tasks.VENV.mkdir(exist_ok=True)
    tasks.setup()
    assert len(calls) == commands


@pytest.mark.no_core
def test_other_processor_or_flags_start_from_an_empty_build_folder(tasks, calls, monkeypatch):
    """Meson keeps its first options, and ninja does not see that `native` means another one."""
    old = tasks.BUILD / "release" / "old.o"
    tasks.VENV.mkdir()
    tasks.build("release")
    old.write_text("")
    (tasks.ROOT / "fortran" / "table.f90").write_text("changed")
    tasks.build("release")
    assert old.exists()
    monkeypatch.setattr(tasks, "processor", lambda: "another")
    tasks.build("release")
    assert not old.exists()
    assert len(calls) == 3


@pytest.mark.no_core
def test_failed_build_is_not_taken_for_a_finished_one(tasks, monkeypatch):
    tasks.LOG.mkdir()
    (tasks.LOG / "build-release.txt").write_text("Error: something")
    monkeypatch.setattr(tasks, "call", lambda *_, **__: 1)
    assert tasks.build("release") == 1
    assert tasks.build("release") == 1


@pytest.mark.no_core
def test_suite_and_further_arguments_reach_snakemake(tasks, calls, monkeypatch):
    monkeypatch.setattr(tasks, "setup", lambda: None)
    tasks.main(["reproduce", "--suite", "configs/suite_quick.yaml", "--quiet"])
    suite, report = calls
    for command in (suite, report):
        assert command[-3:] == ["--config", "suite=configs/suite_quick.yaml", "--quiet"]
    assert suite[3:5] == ["--cores", "all"]
    assert report[3:5] == ["--report", "out/report.html"]


@pytest.mark.no_core
def test_dry_run_writes_no_report(tasks, calls, monkeypatch):
    monkeypatch.setattr(tasks, "setup", lambda: None)
    tasks.main(["reproduce", "-n"])
    assert len(calls) == 1


@pytest.fixture
def locks(tasks, monkeypatch):
    """Folder of the lock of snakemake, as one that was killed leaves it."""
    folder = tasks.ROOT / ".snakemake" / "locks"
    folder.mkdir(parents=True)
    (folder / "0.output.lock").write_text("out/report.md")
    return folder


@pytest.mark.no_core
@pytest.mark.skipif(not Path("/proc/self/cwd").exists(), reason="no /proc here")
def test_lock_of_a_killed_pipeline_is_taken_away(tasks, locks):
    tasks.forget_killed_pipeline()
    assert not locks.exists()
    tasks.forget_killed_pipeline()


@pytest.mark.no_core
@pytest.mark.skipif(not Path("/proc/self/cwd").exists(), reason="no /proc here")
def test_lock_of_a_pipeline_that_is_alive_stays(tasks, locks):
    wait = "import sys; print(1, flush=True); sys.stdin.read()"
    words = [sys.executable, "-c", wait, "snakemake"]
    pipe = subprocess.PIPE
    with subprocess.Popen(words, cwd=tasks.ROOT, stdin=pipe, stdout=pipe) as alive:
        alive.stdout.readline()
        tasks.forget_killed_pipeline()
        assert locks.exists()
        alive.communicate()
    tasks.forget_killed_pipeline()
    assert not locks.exists()


@pytest.mark.no_core
def test_portable_build_stands_beside_the_installed_one(tasks, calls):
    tasks.VENV.mkdir()
    with pytest.raises(SystemExit) as left:
        tasks.main(["portable"])
    assert left.value.code == 0
    [command] = calls
    assert "-Csetup-args=-Dnative=false" in command
    assert command[command.index("--target") + 1] == str(tasks.BUILD / "portable-site")
    assert "--force-reinstall" not in command


@pytest.mark.no_core
def test_names_of_mutants_reach_their_script(tasks, calls, monkeypatch):
    monkeypatch.setattr(tasks, "make_environment", lambda: None)
    with pytest.raises(SystemExit) as left:
        tasks.main(["mutants", "friction-sign"])
    assert left.value.code == 0
    [[_, *words]] = calls
    assert words == ["tests/reliability/mutation.py", "friction-sign"]


@pytest.mark.no_core
def test_run_of_tests_without_counts_has_failed(tasks):
    assert tasks.counted("release") == (0, 1, 0)


@pytest.mark.no_core
@pytest.mark.parametrize("arguments", [["tset"], ["setup", "--fast"], ["test", "--al"]])
def test_unknown_task_or_option_is_refused_before_anything_is_done(arguments):
    done = run_front(*arguments)
    assert done.returncode == 1
    assert done.stderr.startswith(f"tasks.py: no such task: {' '.join(arguments)}\n")


@pytest.mark.no_core
def test_help_names_every_task():
    done = run_front("help")
    assert done.returncode == 0
    for task in ("reproduce", "test", "mutants", "setup", "benchmark", "portable"):
        assert f"tasks.py {task}" in done.stdout
