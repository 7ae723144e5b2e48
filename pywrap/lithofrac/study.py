"""Start a study: write its cases into the results folder, then Snakemake there as a process.

Snakemake runs what is missing or has changed (a case file is written only when its words differ)
and calls the command line again, run by run. Everything stands in the results folder: `study.yaml`,
`jobs.json`, `cases/`, `runs/`, `log/`, `table.parquet`, `figure.svg`.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from pathlib import Path

from lithofrac.analysis.study import check_quantities
from lithofrac.config.errors import ConfigError
from lithofrac.config.setting import text_of
from lithofrac.config.study import Study, load_study
from lithofrac.errors import CoreError
from lithofrac.results.files import write_whole

HERE = Path(__file__).parent
RULES = HERE / "_rules" / "study.smk"


def checked(file: Path) -> tuple[Study, dict[str, str]]:
    """A study and the texts of its case files by name, once every one of them is right.

    Raises
    ------
    ConfigError, DataError
        With one sentence per mistake, one per line.
    """
    study = load_study(file)
    check_quantities(study, file)
    wrong: list[str] = []
    texts = {}
    for name in study.names:
        try:
            texts[name] = text_of(study.case(name))
        except ConfigError as error:
            wrong += str(error).splitlines()
    if wrong:
        raise ConfigError("\n".join(dict.fromkeys(wrong)))
    return study, texts


def start(file: Path, texts: dict[str, str], out: Path, cores: int, quiet: bool) -> None:
    """Run what is missing or has changed, and write the table and the figure.

    Parameters
    ----------
    file : the study file
    texts : case files by name, of `checked`
    out : results folder; made if it is not there
    cores : runs at a time
    quiet : print nothing unless something fails

    Raises
    ------
    ConfigError
        When `out` holds the study file, or cannot be written.
    CoreError
        When a run failed; names each and says why. The others are kept.
    """
    if out.resolve() == file.resolve().parent:
        raise ConfigError(f"--out {out}: holds the study file itself, expected another folder")
    jobs = {"cases": list(texts), "core": _mark_of_core()}
    try:
        for folder in (out, out / "cases", out / "log"):
            folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            _write_if_new(out / "cases" / f"{name}.yaml", text)
        _write_if_new(out / "study.yaml", file.read_text(encoding="utf-8"))
        _write_if_new(out / "jobs.json", json.dumps(jobs, indent=2) + "\n")
    except OSError as error:
        raise ConfigError(f"--out {out}: cannot be written ({error.strerror})") from None
    for log in (out / "log").glob("*.txt"):
        log.unlink()  # what stands there after this call was said during it
    if _snakemake(out, cores, quiet):
        raise CoreError(_failures(out, [*texts, "collect"]))


def _snakemake(out: Path, cores: int, quiet: bool) -> int:
    """Exit code of the pipeline; its words go to log/snakemake.txt."""
    command = [
        *(sys.executable, "-P", "-m", "snakemake", "--snakefile", str(RULES)),
        *("--directory", str(out), "--cores", str(cores)),
        *("--keep-going", "--rerun-incomplete", "--nocolor"),
    ]
    with (
        open(out / "log" / "snakemake.txt", "w") as log,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        ) as process,
    ):
        try:
            for line in process.stdout:
                log.write(line)
                if not quiet and line.startswith(("Job ", "[Errno")):
                    print(line.split(":", 1)[-1].strip(), file=sys.stderr, flush=True)
            return process.wait()
        except KeyboardInterrupt:  # Snakemake has it too, and stops its runs with checkpoints
            process.wait()
            raise


def _failures(out: Path, jobs: list[str]) -> str:
    """One sentence for each job that failed, by the last line of its log."""
    said = []
    for job in jobs:
        made = out / ("figure.svg" if job == "collect" else f"runs/{job}/summary.json")
        log = out / "log" / f"{job}.txt"
        if made.exists() or not log.exists():
            continue
        lines = [line for line in log.read_text().splitlines() if line.strip()]
        reason = lines[-1].removeprefix("lithofrac: ") if lines else "no word in its log"
        said.append(f"{job}: {reason} (all of it in {log})")
    return "\n".join(said or [f"the pipeline failed; its words are in {out}/log/snakemake.txt"])


def _write_if_new(path: Path, text: str) -> None:
    """Write a file unless it holds just that: the time of a file says when its words changed."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        write_whole(path, lambda part: part.write_text(text, encoding="utf-8"))


def _mark_of_core() -> str:
    """Mark of what decides a result beside its case: the compiled core, and the scenes."""
    files = [*HERE.glob("_core*.so"), *HERE.glob("scenes/*.py")]
    digest = hashlib.sha256()
    for file in sorted(files):
        digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:16]
