"""Many mutants in worker processes that are replaced after some hundred, and when one is lost.

python tests/fuzz/fuzz_campaign.py --count 10000        all seeds from 0
python tests/fuzz/fuzz_campaign.py --first 4711 --keep  one seed alone, its files in fuzz-4711/
"""

import argparse
import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fuzz_mutants import mutant

HERE = Path(__file__).parent
WORKER = HERE / "fuzz_worker.py"
GOOD = ("result", "large", "refused", "stopped")
EACH = 400  # mutants of one process
TIME_LIMIT = 120.0  # seconds for one mutant; the machine may be busy
MAKE_MESHES = "import fuzz_worker, sys; fuzz_worker.write_meshes(sys.argv[1])"


def campaign(first: int, count: int, processes: int = 2, show=None) -> list[dict]:
    """Verdicts on the seeds from `first` on, in order; `show` is called with each."""
    with tempfile.TemporaryDirectory(prefix="lithofrac-meshes-") as meshes:
        subprocess.run([sys.executable, "-c", MAKE_MESHES, meshes], env=_environment(), check=True)
        seeds = range(first, first + count)
        size = min(EACH, -(-count // processes))
        batches = [seeds[i : i + size] for i in range(0, count, size)]
        with ThreadPoolExecutor(processes) as lanes:
            found = lanes.map(lambda batch: _batch(list(batch), meshes, show), batches)
            return [verdict for batch in found for verdict in batch]


def failures(verdicts: list[dict]) -> str:
    """One paragraph a failure, with the way to repeat it alone."""
    return "\n\n".join(
        f"seed {found['seed']}: {found['kind']}, {found['target']}\n{found['detail']}\n"
        f"alone: python {HERE.name}/{Path(__file__).name} --first {found['seed']}"
        for found in verdicts
        if found["kind"] not in GOOD
    )


def _batch(seeds: list[int], meshes: str, show) -> list[dict]:
    found = []
    while seeds:
        with _worker(meshes) as ask:
            while seeds:
                seed = seeds.pop(0)
                verdict = ask(seed)
                found.append(verdict)
                if show is not None:
                    show(verdict)
                if verdict["kind"] in ("hang", "crash"):
                    break
    return found


@contextlib.contextmanager
def _worker(meshes: str):
    """A process and the way to ask it; it and what it has started end with the block."""
    errors = tempfile.TemporaryFile("w+")
    process = subprocess.Popen(
        [sys.executable, WORKER, meshes], env=_environment(), text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors,
        start_new_session=True,
    )  # fmt: skip
    ready = selectors.DefaultSelector()
    ready.register(process.stdout, selectors.EVENT_READ)

    def ask(seed: int) -> dict:
        with contextlib.suppress(BrokenPipeError):
            process.stdin.write(f"{seed}\n")
            process.stdin.flush()
        if not ready.select(TIME_LIMIT):
            return _lost(seed, "hang", f"no answer after {TIME_LIMIT:g} s")
        line = process.stdout.readline()
        if line:
            return json.loads(line)
        code = process.wait()
        errors.seek(0)
        return _lost(seed, "crash", f"exit code {code}: {errors.read()[-2000:]}")

    try:
        yield ask
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        ready.close()
        errors.close()


def _lost(seed: int, kind: str, detail: str) -> dict:
    return {"seed": seed, "kind": kind, "target": "unknown", "detail": detail}


def _environment() -> dict:
    paths = [str(HERE), *filter(None, [os.environ.get("PYTHONPATH")])]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OMP_NUM_THREADS": "1"}
    if "ASAN_OPTIONS" in env:  # numpy may ask for more than there is, which it then says
        env["ASAN_OPTIONS"] += ":allocator_may_return_null=1"
    return env


def _keep(seed: int) -> None:
    """Write the files of a mutant, to look at."""
    from fuzz_worker import read_meshes

    with tempfile.TemporaryDirectory() as meshes:
        subprocess.run([sys.executable, "-c", MAKE_MESHES, meshes], env=_environment(), check=True)
        found = mutant(seed, read_meshes(Path(meshes)))
    for name, content in found.files.items():
        path = Path(f"fuzz-{seed}") / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    print(f"fuzz-{seed}/: {found.target}; lithofrac {' '.join(found.words)}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--count", type=int, default=1)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--keep", action="store_true", help="write the files of the first seed")
    parser.add_argument("--out", type=Path, help="file for all verdicts, one JSON a line")
    options = parser.parse_args()
    if options.keep:
        _keep(options.first)
    start, counts = time.perf_counter(), Counter()

    def show(verdict: dict) -> None:
        counts[verdict["kind"]] += 1
        if options.out:
            with open(options.out, "a") as file:
                file.write(json.dumps(verdict) + "\n")
        if verdict["kind"] not in GOOD or options.count == 1:
            print(json.dumps(verdict), flush=True)

    found = campaign(options.first, options.count, options.processes, show)
    print(dict(counts), f"{time.perf_counter() - start:.0f} s")
    print(failures(found))
    return 1 if failures(found) else 0


if __name__ == "__main__":
    sys.exit(main())
