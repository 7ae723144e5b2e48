"""Start a study: write its cases into the results folder, then Snakemake there as a process.

Snakemake runs what is missing or has changed (a case file is written only when its words differ)
and calls the command line again, run by run. Everything stands in the results folder: `study.yaml`,
`jobs.json`, `cases/`, `runs/`, `log/`, `table.parquet`, `figure.svg`.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

from lithofrac.analysis.reading import read_summary
from lithofrac.analysis.study import check_quantities
from lithofrac.config.case import Case
from lithofrac.config.cost import refuse_above_budget
from lithofrac.config.errors import ConfigError
from lithofrac.config.gmsh_file import GmshFile
from lithofrac.config.material import PACKAGED
from lithofrac.config.setting import text_of
from lithofrac.config.study import Study, load_study
from lithofrac.errors import CoreError
from lithofrac.results.files import write_whole

HERE = Path(__file__).parent
RULES = HERE / "_rules" / "study.smk"
JOB = re.compile(r" *Job \d+: (.*)")  # how Snakemake says that one starts
GRACE, CANCEL = 5.0, 60.0  # [s] for what is stopped to end by itself, here and on a cluster

DECIDING = (
    "_core*.so",
    *(f"{name}.py" for name in ("core", "guards", "plan", "problem", "run")),
    *(f"analysis/{name}.py" for name in ("crack_faces", "frames", "run_numbers", "strength")),
    *(f"{folder}/*.py" for folder in ("config", "results", "scenes")),
)  # as in the Snakefile of a suite


def checked(file: Path) -> tuple[Study, dict[str, str]]:
    """A study and the texts of its case files by name, once every one of them is right.

    Raises
    ------
    ConfigError, DataError
        With one sentence per mistake, one per line.
    """
    study = load_study(file)
    check_quantities(study, file)
    texts = {}
    wrong: dict[str, list[str]] = {}  # sentence -> runs
    for name in study.names:
        try:
            case = study.case(name)
            refuse_above_budget(case)
            texts[name] = text_of(_placed(case))
        except ConfigError as error:
            for line in str(error).splitlines():
                wrong.setdefault(line, []).append(name)
    if wrong:
        raise ConfigError("\n".join(f"{line} ({_runs(names)})" for line, names in wrong.items()))
    return study, texts


def _placed(case: Case) -> Case:
    """The case as it may stand in any folder."""
    if not isinstance(case.scene, GmshFile):
        return case
    return case.model_copy(update={"scene": case.scene.absolute})


def _runs(names: list[str]) -> str:
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return f"run {names[0]}{more}"


def start(
    file: Path,
    texts: dict[str, str],
    out: Path,
    cores: int | None,
    quiet: bool,
    profile: str | None = None,
) -> None:
    """Run what is missing or has changed, and write the table and the figure.

    Parameters
    ----------
    file : the study file
    texts : case files by name, of `checked`
    out : results folder; made if it is not there
    cores : runs at a time, as many as there are cores where it is None
    quiet : print nothing unless something fails
    profile : of Snakemake, for a cluster: its folder, or the name of one in `configs/profiles`

    Raises
    ------
    ConfigError
        When `out` holds the study file, or cannot be written, or there is no such profile.
    CoreError
        When a run failed; names each and says why. The others are kept.
    """
    if out.resolve() == file.resolve().parent:
        raise ConfigError(f"--out {out}: holds the study file itself, expected another folder")
    where = ["--cores", str(cores or "all")] if profile is None else _on_cluster(profile)
    try:
        for folder in (out, out / "cases", out / "log"):
            folder.mkdir(parents=True, exist_ok=True)
        with _alone_in(out):
            costs = own_costs(load_study(file)) if profile else {}
            _write_inputs(file, texts, out, costs)
            if _snakemake(out, where, quiet, CANCEL if profile else GRACE):
                raise CoreError(_failures(out, list(texts)))
    except OSError as error:
        raise ConfigError(f"--out {out}: cannot be written ({error.strerror})") from None


def own_costs(study: Study) -> dict[str, dict]:
    """What the runs of geometries from files will take, which a scheduler asks: name -> `Cost`.

    Each geometry is meshed once, for its elements and its time step.

    Raises
    ------
    ConfigError
        Where a mesh or its problem is refused, as the run would be.
    """
    from lithofrac.meshed_cost import meshed_cost

    meshes: dict = {}
    found = {}
    for name in study.names:
        case = study.case(name)
        if not isinstance(case.scene, GmshFile):
            continue
        try:
            found[name] = asdict(meshed_cost(case, meshes))
        except (ConfigError, CoreError) as error:
            raise ConfigError(f"{error} (run {name})") from None
    return found


def _write_inputs(file: Path, texts: dict[str, str], out: Path, costs: dict) -> None:
    """What the rules read: the study, its cases, and a list of them with what is known of some."""
    jobs = {"cases": list(texts), "core": _mark_of_core(), "costs": costs}
    for name, text in texts.items():
        _write_if_new(out / "cases" / f"{name}.yaml", text)
        _forget_unfinished(out / "runs" / name / "summary.json")
    _write_if_new(out / "study.yaml", file.read_text(encoding="utf-8"))
    _write_if_new(out / "jobs.json", json.dumps(jobs, indent=2) + "\n")


def _on_cluster(profile: str) -> list[str]:
    """Words for Snakemake that hand the runs to a cluster."""
    places = [Path(profile), Path("configs/profiles") / profile, PACKAGED / "profiles" / profile]
    for folder in places:
        if (folder / "config.yaml").is_file():
            return ["--profile", str(folder.resolve())]
    known = ", ".join(sorted(path.name for path in (PACKAGED / "profiles").glob("*")))
    raise ConfigError(
        f"--profile {profile}: no such profile, expected a folder that holds config.yaml, or one "
        f"of: {known}"
    )


def _snakemake(out: Path, where: list[str], quiet: bool, patience: float) -> int:
    """Exit code of the pipeline; its words go to log/snakemake.txt.

    Parameters
    ----------
    where : words that say where the runs are done
    patience : for what is stopped to end by itself [s]
    """
    command = [
        *(sys.executable, "-P", "-m", "snakemake", "--snakefile", str(RULES)),
        *("--directory", str(out), *where),
        *("--keep-going", "--rerun-incomplete", "--nocolor", "--nolock"),
    ]
    with (
        open(out / "log" / "snakemake.txt", "w", buffering=1) as log,
        subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,  # so that a signal reaches it and its runs once, from here
            preexec_fn=_hear_interrupts,
        ) as process,
    ):
        try:
            for line in process.stdout:
                log.write(line)
                started = JOB.match(line)
                if started and not quiet:
                    print(started[1], file=sys.stderr, flush=True)
            return process.wait()
        except KeyboardInterrupt:
            if patience == CANCEL:
                os.kill(process.pid, signal.SIGINT)  # asks the cluster to cancel its jobs
            else:
                os.killpg(process.pid, signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(patience)
            with contextlib.suppress(ProcessLookupError):  # Snakemake may wait for a dead helper
                os.killpg(process.pid, signal.SIGKILL)
            raise


def _hear_interrupts() -> None:
    """In the new process: what a shell starts in the background is deaf to SIGINT otherwise."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@contextlib.contextmanager
def _alone_in(out: Path) -> Iterator[None]:
    """Refuse to work in a folder where another study does; a killed one leaves no lock."""
    with open(out / "log" / "lock", "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise ConfigError(
                f"--out {out}: another study is at work there, expected a folder of its own"
            ) from None
        yield


def _forget_unfinished(summary: Path) -> None:
    """Remove the summary of a run that was stopped, which Snakemake would take for a result."""
    if summary.exists() and read_summary(summary)["status"] != "completed":
        summary.unlink()


def _failures(out: Path, names: list[str]) -> str:
    """One sentence for each job that failed, by the last line of its log."""
    made = {name: out / "runs" / name / "summary.json" for name in names}
    lacking = [name for name, summary in made.items() if not summary.exists()] or ["collect"]
    said = []
    for job in lacking:
        log = out / "log" / f"{job}.txt"
        lines = log.read_text().split("\n") if log.exists() else []
        words = [line.removeprefix("lithofrac: ") for line in lines if line.strip()]
        if words:
            said.append(f"{job}: {words[-1]} (all of it in {log})")
    return "\n".join(said or [f"the pipeline failed; its words are in {out}/log/snakemake.txt"])


def _write_if_new(path: Path, text: str) -> None:
    """Write a file unless it holds just that: the time of a file says when its words changed."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        write_whole(path, lambda part: part.write_text(text, encoding="utf-8"))


def _mark_of_core() -> str:
    """Mark of what decides a result beside its case: the compiled core, and what a run imports."""
    digest = hashlib.sha256()
    for file in sorted(file for words in DECIDING for file in HERE.glob(words)):
        digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:16]
