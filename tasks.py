#!/usr/bin/env python3
"""One front for everything. Standard library only: a machine with python3 and git can run it.

python3 tasks.py reproduce [--suite FILE] [...]  run the suite, write out/report.html and .md;
                                                 further arguments go to snakemake
python3 tasks.py test [--all]                    linters, tests on three builds, line coverage;
                                                 --all adds the tests marked slow, and on the
                                                 special builds those marked one_build
python3 tasks.py mutants [NAME ...]              break the code on purpose, see which test notices;
                                                 writes reports/mutants.md
python3 tasks.py setup                           only install what is missing and build
python3 tasks.py benchmark                       speed of the core, kept in out/benchmark.json
python3 tasks.py portable                        a second build beside the installed one, for
                                                 references: bits of any x86-64 since 2013

Each task sets up what it needs first; once that is done, a second call goes straight to work.
One file on purpose: it has to run before anything of this project is installed.
"""

import contextlib
import ctypes
import hashlib
import os
import shutil
import subprocess
import sys
import sysconfig
import time
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
BIN = VENV / "bin"
BUILD = ROOT / "build"
LOG = BUILD / "log"
PIP = "pip>=23.1"  # the first that takes several settings of a build; Debian 12 has 23.0
COVERAGE_ASKED = 90  # percent of the lines below fortran/

# What `build` hands to meson beyond pyproject.toml. Coverage and run-time checks share a build:
# one more run of all tests would cost more than it could tell.
BUILDS = {
    "release": "",
    "checked": "-Dbuildtype=debug -Doptimization=1 -Db_lto=false -Dchecked=true -Db_coverage=true",
    "sanitize": "-Dbuildtype=debug -Doptimization=1 -Db_lto=false -Db_sanitize=address,undefined"
    " -Db_lundef=false",
    "portable": "-Dnative=false",
}

# What gmsh's library is linked to, and the Debian package that has it.
GMSH_LIBRARIES = {
    "libGLU.so.1": "libglu1-mesa",
    "libGL.so.1": "libgl1",
    "libXrender.so.1": "libxrender1",
    "libXcursor.so.1": "libxcursor1",
    "libXfixes.so.3": "libxfixes3",
    "libXext.so.6": "libxext6",
    "libXft.so.2": "libxft2",
    "libfontconfig.so.1": "libfontconfig1",
    "libXinerama.so.1": "libxinerama1",
    "libX11.so.6": "libx11-6",
    "libgomp.so.1": "libgomp1",
}
APT = ["gfortran", "gcc", "libc6-dev", "python3-venv", "python3-dev", *GMSH_LIBRARIES.values()]
DNF = (
    "gcc gcc-gfortran python3-devel mesa-libGLU mesa-libGL libXrender libXcursor libXfixes "
    "libXext libXft fontconfig libXinerama libX11 libgomp libasan libubsan"
)
CONDA = (
    "python gfortran gcc libglu libgl xorg-libxrender xorg-libxcursor xorg-libxfixes "
    "xorg-libxext xorg-libxft fontconfig xorg-libxinerama xorg-libx11"
)


# ---------------------------------------------------------------- running things


def say(text):
    print(text, flush=True)  # in order with what the children print


@contextlib.contextmanager
def stage(title):
    """One line when a stage is over, with its seconds."""
    start = time.monotonic()
    yield
    say(f"{title} {'.' * max(3, 60 - len(title))} {time.monotonic() - start:6.1f} s")


def environment(**more):
    """Variables of every child: the venv first, threads that sleep while they wait, no window."""
    env = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONHOME")}
    env["PATH"] = f"{BIN}{os.pathsep}{env['PATH']}"
    env["VIRTUAL_ENV"] = str(VENV)
    env["MPLBACKEND"] = "Agg"
    env.setdefault("OMP_WAIT_POLICY", "passive")  # spinning threads cost a busy machine a factor
    env.update(more)
    return env


def call(*command, env=None, log=None):
    """Run a command in the root; its exit code. With `log`, its words go to that file."""
    command = [str(word) for word in command]
    if log is None:
        return subprocess.run(command, cwd=ROOT, env=env or environment()).returncode
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("w") as file:
        return subprocess.run(
            command, cwd=ROOT, env=env or environment(), stdout=file, stderr=subprocess.STDOUT
        ).returncode


def need(*command, env=None):
    """Run a command that has to succeed."""
    code = call(*command, env=env)
    if code:
        sys.exit(f"tasks.py: exit code {code} from: {' '.join(map(str, command))}")


# ---------------------------------------------------------------- what the system has to offer


def refuse_old_python(version):
    """Stop with a sentence if this Python is too old; `version` as sys.version_info."""
    if tuple(version[:2]) < (3, 11):
        sys.exit(
            f"lithofrac needs Python 3.11 or newer; this is {version[0]}.{version[1]}. "
            "Call tasks.py with a newer one, for example: python3.11 tasks.py setup"
        )


def compiles_c(compiler):
    """True if the C compiler finds the headers of the C library (gcc alone lacks them)."""
    done = subprocess.run(
        [compiler, "-x", "c", "-E", "-"], input=b"#include <stdio.h>\n", capture_output=True
    )
    return done.returncode == 0


def loads(library):
    """True if the dynamic linker finds this library."""
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def missing_from_system():
    """Name of what is missing -> Debian packages that bring it."""
    missing = {}
    if not shutil.which(os.environ.get("FC", "gfortran")):
        missing["a Fortran compiler"] = ["gfortran"]
    compiler = shutil.which(os.environ.get("CC", "cc")) or shutil.which("gcc")
    if not compiler or not compiles_c(compiler):
        missing["a C compiler with its headers"] = ["gcc", "libc6-dev"]
    probe = [sys.executable, "-c", "import ensurepip, venv"]
    if subprocess.run(probe, capture_output=True).returncode:
        missing["Python's venv"] = ["python3-venv"]
    if not Path(sysconfig.get_path("include"), "Python.h").exists():
        missing["Python's headers"] = ["python3-dev"]
    if sys.platform.startswith("linux"):  # elsewhere the gmsh wheel brings or finds its own
        lost = [name for name in GMSH_LIBRARIES if not loads(name)]
        if lost:
            missing["libraries of gmsh (" + ", ".join(lost) + ")"] = [
                GMSH_LIBRARIES[name] for name in lost
            ]
    return missing


def how_to_install(missing):
    """The one message for a machine on which we may not, or cannot, install."""
    return (
        "lithofrac needs what this machine lacks: " + "; ".join(missing) + ".\n"
        "Install it by one of these, then call tasks.py again:\n"
        f"  Debian, Ubuntu: sudo apt-get install {' '.join(APT)}\n"
        f"  Fedora, RHEL:   sudo dnf install {DNF}\n"
        "  macOS:          brew install gcc python\n"
        "  cluster:        module load gcc python   (then: export FC=gfortran)\n"
        f"  without root:   conda create -n lithofrac -c conda-forge {CONDA}\n"
        "                  conda activate lithofrac   (then: export FC=gfortran CC=gcc)"
    )


def may_use_apt():
    return os.name == "posix" and os.geteuid() == 0 and shutil.which("apt-get") is not None


def install_system():
    """Install compilers and libraries that are missing, or say how to and stop."""
    missing = missing_from_system()
    if missing and may_use_apt():
        packages = [package for group in missing.values() for package in group]
        env = dict(os.environ, DEBIAN_FRONTEND="noninteractive")
        with stage(f"system packages ({len(packages)} by apt-get)"):
            need("apt-get", "-qq", "update", env=env)
            options = ["-qq", "-y", "-o=Dpkg::Use-Pty=0", "--no-install-recommends"]
            code = call("apt-get", "install", *options, *packages, env=env, log=LOG / "apt.txt")
        if code:
            say((LOG / "apt.txt").read_text()[-3000:])
        missing = missing_from_system()
    if missing:
        sys.exit(how_to_install(missing))


# ---------------------------------------------------------------- set-up


def fingerprint(*paths, extra=""):
    """Hash of the names and contents of files and of all files below folders."""
    digest = hashlib.sha256(extra.encode())
    for path in paths:
        files = sorted(path.rglob("*")) if path.is_dir() else [path]
        for file in files:
            if file.is_file() and "__pycache__" not in file.parts:
                digest.update(f"{file.relative_to(ROOT)}\0".encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()


def processor():
    """Instruction sets of this machine: a build tuned for another one must not be reused."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    flags = [line for line in lines if line.lower().startswith(("flags", "features"))]
    return flags[0] if flags else os.uname().machine


def fresh(stamp, want):
    """True if a stamp says that the work it stands for is done for just this."""
    return stamp.exists() and stamp.read_text() == want


def configuration(kind):
    """What meson fixes when it first sees a build folder; another one needs a new folder."""
    chosen = [os.environ.get(name, "") for name in ("FC", "CC", "FFLAGS", "LITHOFRAC_MESON")]
    return "\n".join([sys.version, str(ROOT), processor(), *chosen, BUILDS[kind]])


def build_key(kind):
    """What a build depends on; equal keys, equal binaries."""
    files = [ROOT / name for name in ("requirements.txt", "pyproject.toml", "meson.build")]
    folders = [ROOT / name for name in ("fortran", "pywrap", "configs")]
    return fingerprint(*files, ROOT / "meson.options", *folders, extra=configuration(kind))


def make_environment():
    """The virtual environment with the pinned requirements."""
    python, interpreter = sys.version + str(ROOT), VENV / "interpreter.stamp"
    wanted, requirements = fingerprint(ROOT / "requirements.txt"), VENV / "requirements.stamp"
    if fresh(interpreter, python) and fresh(requirements, wanted):
        return
    install_system()
    with stage("virtual environment and requirements"):
        if not fresh(interpreter, python):
            need(sys.executable, "-m", "venv", "--clear", VENV, env=dict(os.environ))
            interpreter.write_text(python)
        pip = [BIN / "python", "-m", "pip", "install", "-q", "--disable-pip-version-check"]
        need(*pip, PIP)
        need(*pip, "-r", ROOT / "requirements.txt")
    requirements.write_text(wanted)


def site(kind):
    """Folder that a special build is installed to; it goes first in PYTHONPATH."""
    return BUILD / f"{kind}-site"


def build(kind):
    """Compile and install one build if its sources have changed; its exit code.

    Not an editable install: that one runs ninja at import, and parallel jobs then race.
    """
    folder, home = BUILD / kind, VENV if kind == "release" else site(kind)
    stamp, owner = home / "build.stamp", BUILD / f"{kind}.configuration"
    want = build_key(kind)
    if fresh(stamp, want):
        return 0
    if not fresh(owner, configuration(kind)):
        shutil.rmtree(folder, ignore_errors=True)
    for path in (folder, home):
        path.mkdir(parents=True, exist_ok=True)
    owner.write_text(configuration(kind))
    stamp.unlink(missing_ok=True)
    options = [*BUILDS[kind].split(), *os.environ.get("LITHOFRAC_MESON", "").split()]
    where = ["--force-reinstall"] if kind == "release" else ["--target", home, "--upgrade"]
    log = LOG / f"build-{kind}.txt"
    with stage(f"build {kind}"):
        code = call(
            BIN / "python", "-m", "pip", "install", "-q", "--disable-pip-version-check",
            "--no-build-isolation", "--no-deps", *where, f"-Cbuild-dir={folder}",
            *(f"-Csetup-args={option}" for option in options), ROOT, log=log,
        )  # fmt: skip
    if code:
        say(f"the {kind} build failed; its words ({log.relative_to(ROOT)}):")
        say(log.read_text()[-8000:])
        return code
    stamp.write_text(want)
    return 0


def setup():
    """All that a run needs; the release build is installed in the virtual environment."""
    make_environment()
    if build("release"):
        sys.exit(1)


# ---------------------------------------------------------------- reproduce, benchmark


def forget_killed_pipeline():
    """Take away the lock that a killed snakemake left here; one that is alive keeps its own."""
    locks = ROOT / ".snakemake" / "locks"
    if not any(locks.glob("*.lock")) or not Path("/proc/self/cwd").exists():
        return
    for process in Path("/proc").glob("[0-9]*"):
        try:
            name = (process / "cmdline").read_bytes()
            if b"snakemake" in name and Path(os.readlink(str(process / "cwd"))) == ROOT:
                return
        except PermissionError:  # of another user: perhaps here
            return
        except OSError:  # it has just ended
            continue
    shutil.rmtree(locks)
    say("the last pipeline here was killed: going on where it was")


def reproduce(extra):
    """A suite on all cores, then its report; `extra` goes to snakemake, but for --suite FILE."""
    if extra[:1] == ["--suite"]:
        extra = ["--config", f"suite={' '.join(extra[1:2])}", *extra[2:]]
    setup()
    forget_killed_pipeline()
    snakemake = [BIN / "python", "-m", "snakemake"]
    with stage("suite"):
        need(
            *snakemake,
            "--cores",
            "all",
            "--keep-going",
            "--rerun-incomplete",
            "--show-failed-logs",
            "--scheduler",
            "greedy",  # the default one solves a linear programme for each job: minutes of a core
            *extra,
        )
    if {"-n", "--dry-run", "--dryrun"} & set(extra):
        return
    with stage("report"):
        need(*snakemake, "--report", "out/report.html", *extra)
    say("read out/report.html or out/report.md")


def portable():
    """The build that makes references; the one that is installed stays as it is."""
    if not VENV.exists():
        make_environment()
    sys.exit(build("portable"))


def benchmark(extra):
    """Speed of the core, one thread unless OMP_NUM_THREADS says otherwise."""
    setup()
    (ROOT / "out").mkdir(exist_ok=True)
    env = environment(OMP_NUM_THREADS=os.environ.get("OMP_NUM_THREADS", "1"))
    with stage("benchmark"):
        need(
            BIN / "python", "-m", "lithofrac.benchmark", "--out", "out/benchmark.json", *extra,
            env=env,
        )  # fmt: skip


# ---------------------------------------------------------------- test


def lint():
    """Names of the linters that found something."""
    linters = {
        "ruff check": ["ruff", "check", "--quiet"],
        "ruff format": ["ruff", "format", "--check", "--quiet"],
        "snakefmt": ["snakefmt", "--check", "Snakefile", "pywrap/rules"],
        "fortitude": ["fortitude", "check", "--output-format=concise", "fortran", "pywrap"],
    }
    failed = []
    for name, command in linters.items():
        with stage(name):
            code = call(BIN / command[0], *command[1:], log=LOG / "lint.txt")
        if code:
            say((LOG / "lint.txt").read_text())
            failed.append(name)
    return failed, len(linters)


def sanitizer_libraries():
    """Run-time libraries that have to be in the process before Python starts."""
    ask = [os.environ.get("CC", "gcc")]
    paths = [
        subprocess.check_output([*ask, f"-print-file-name={name}"], text=True).strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    return " ".join(paths)


def test_environment(kind):
    """Variables under which the tests of one build run."""
    env = environment(
        LITHOFRAC_BUILD=kind,
        OMP_NUM_THREADS="1",
        HYPOTHESIS_STORAGE_DIRECTORY=str(BUILD / f"{kind}-hypothesis"),
    )
    if kind != "release":
        env["PYTHONPATH"] = str(site(kind))
    if kind == "sanitize":
        env["LD_PRELOAD"] = sanitizer_libraries()
        env["PYTHONMALLOC"] = "malloc"
        env["ASAN_OPTIONS"] = "detect_leaks=0"  # Python itself never frees all
        env["UBSAN_OPTIONS"] = "halt_on_error=1:print_stacktrace=1"
    return env


def markers_of(kind, everything):
    """Which tests a build runs, as pytest's -m: all on the release build, on the special builds
    those that reach the core, and with `everything` those marked one_build too."""
    left_out = [] if everything and kind == "release" else ["slow"]
    if kind != "release":
        left_out += ["no_core"] if everything else ["no_core", "one_build"]
    return " and ".join(f"not {mark}" for mark in left_out)


def run_tests(kind, markers):
    """Build, then pytest; exit code. Words and counts go to build/log/."""
    counts, log = LOG / f"{kind}.xml", LOG / f"{kind}.txt"
    for old in (counts, log, *(BUILD / kind).rglob("*.gcda")):  # counts of lines add up otherwise
        old.unlink(missing_ok=True)
    if build(kind):
        return 1
    with stage(f"tests, {kind} build"):
        return call(
            BIN / "python", "-m", "pytest", "-m", markers, "-rP", "--durations=8",
            "-p", "no:cacheprovider", f"--junitxml={counts}",
            env=test_environment(kind), log=log,
        )  # fmt: skip


def counted(kind):
    """(passed, failed, skipped) of the tests of one build; a run without counts has failed."""
    try:
        suite = ElementTree.parse(LOG / f"{kind}.xml").getroot().find("testsuite")
    except (OSError, ElementTree.ParseError):
        return 0, 1, 0
    total, skipped = int(suite.get("tests")), int(suite.get("skipped"))
    failed = int(suite.get("failures")) + int(suite.get("errors"))
    return total - failed - skipped, failed, skipped


def coverage():
    """Print the covered lines of every Fortran file; exit code."""
    with stage("coverage"):
        return call(
            BIN / "gcovr", "--root", ROOT, "--filter", "fortran/", "--sort", "uncovered-percent",
            "--gcov-ignore-parse-errors=all", "--fail-under-line", COVERAGE_ASKED,
            BUILD / "checked",
        )  # fmt: skip


def test(everything):
    """Linters, the tests on three builds side by side, coverage; exits non-zero on any failure."""
    setup()
    failed, checks = lint()
    # Longest first, one lane a core: the last one to start is then the shortest.
    order = ["sanitize", "checked", "release"]
    markers = [markers_of(kind, everything) for kind in order]
    with ThreadPoolExecutor(max_workers=min(3, os.cpu_count() or 1)) as lanes:
        codes = dict(zip(order, lanes.map(run_tests, order, markers), strict=True))
    checks += 1
    if coverage():
        failed.append(f"coverage below {COVERAGE_ASKED} %")
    for kind in order:
        log = LOG / f"{kind}.txt"
        if (codes[kind] or kind == "release") and log.exists():
            say(f"---- tests, {kind} build ----\n{log.read_text()[-20000:]}")
    counts = {kind: counted(kind) for kind in order}
    for kind, (passed, wrong, skipped) in counts.items():
        say(f"tests of the {kind} build: {passed} passed, {wrong} failed, {skipped} skipped")
        if codes[kind] and not wrong:
            failed.append(f"tests of the {kind} build ended with exit code {codes[kind]}")
    for name in failed:
        say(f"failed: {name}")
    passed, wrong, skipped = (sum(column) for column in zip(*counts.values(), strict=True))
    wrong += len(failed)
    say(f"{passed + checks - len(failed)} passed, {wrong} failed, {skipped} skipped")
    sys.exit(1 if wrong else 0)


def mutants(extra):
    """Mistakes made on purpose in copies of the tree: does a test notice each of them?"""
    make_environment()
    with stage("mutants"):
        code = call(BIN / "python", "tests/reliability/mutation.py", *extra)
    sys.exit(code)


def main(arguments):
    refuse_old_python(sys.version_info)
    task, extra = (arguments or ["help"])[0], arguments[1:]
    if task == "setup" and not extra:
        setup()
    elif task == "reproduce":
        reproduce(extra)
    elif task == "test" and extra in ([], ["--all"]):
        test(everything=bool(extra))
    elif task == "portable" and not extra:
        portable()
    elif task == "mutants":
        mutants(extra)
    elif task == "benchmark":
        benchmark(extra)
    elif task in ("help", "-h", "--help"):
        say(__doc__.strip())
    else:
        sys.exit(f"tasks.py: no such task: {' '.join(arguments)}\n\n{__doc__.strip()}")


if __name__ == "__main__":
    main(sys.argv[1:])
