#!/usr/bin/env python3
"""A Slurm of one node, for as long as a command runs: nothing is installed, nothing stays behind.

    python tests/slurm/one_node.py snakemake --profile configs/profiles/slurm --slurm-no-account

It needs the programs of Slurm and munge, but not as services, and no file below /etc: key, socket,
ports, state and logs are its own, in a folder that goes when it ends. Slurm starts jobs of other
users only as root; as anyone else it runs those of that user, which is all that is asked here.
Memory is handed out but not enforced, and there is no accounting (hence `squeue` for the status).
"""

import contextlib
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

SERVERS = ("munged", "slurmctld", "slurmd")
CLIENTS = ("sbatch", "srun", "squeue", "scancel", "scontrol", "sinfo")
PBS = ("qsub", "qstat", "qdel")  # Torque's words for the same, where they are installed
INSTALL = "apt-get install --no-install-recommends slurmctld slurmd slurm-client munge"
PATIENCE = 30.0  # [s] for the node to become idle
SHARE = 0.8  # of the memory of the machine

CONFIGURATION = """\
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge/socket
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerType=sched/backfill
ReturnToService=2
KillWait=5
MinJobAge=300
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory={memory} State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE DefMemPerCPU=500 State=UP
"""


def which(name: str) -> str | None:
    """A program; those of the servers stand where a plain user does not look."""
    return shutil.which(name, path=os.pathsep.join([os.environ["PATH"], "/usr/sbin", "/sbin"]))


def missing() -> list[str]:
    """Programs that this machine lacks."""
    return [name for name in (*SERVERS, *CLIENTS) if which(name) is None]


@contextlib.contextmanager
def one_node() -> Iterator[dict[str, str]]:
    """Start it, and stop it when the block ends.

    Yields
    ------
    dict
        Environment in which the clients find it.

    Raises
    ------
    RuntimeError
        When the node does not become idle; with what the servers said.
    """
    # A short path: that of a socket ends after 107 characters.
    with tempfile.TemporaryDirectory(prefix="slurm-", ignore_cleanup_errors=True) as text:
        folder = Path(text)
        folder.chmod(0o711)
        environment = _prepared(folder)
        servers: list[subprocess.Popen] = []
        try:
            for name, *arguments in _commands(folder):
                with open(folder / f"{name}.log", "w") as log:
                    servers.append(
                        subprocess.Popen(
                            [which(name), *arguments],
                            stdout=log,
                            stderr=subprocess.STDOUT,
                            env=environment,
                            start_new_session=True,  # a Ctrl-C is for the command, not for them
                        )
                    )
                if name == "munged":
                    _wait_for(lambda: (folder / "munge" / "socket").exists(), folder)
            _wait_for(lambda: _state(environment) == "idle", folder)
            yield environment
        finally:
            _cancel_all(environment)
            for server in reversed(servers):
                server.terminate()
            for server in reversed(servers):
                _end(server)


def _prepared(folder: Path) -> dict[str, str]:
    """Write key, configuration and wrappers; the environment of the clients."""
    for name in ("munge", "state", "spool", "bin"):
        (folder / name).mkdir()
    (folder / "munge").chmod(0o711)
    key = folder / "munge" / "key"
    key.touch(0o600)
    key.write_bytes(os.urandom(1024))
    configuration = folder / "slurm.conf"
    configuration.write_text(
        CONFIGURATION.format(
            host=socket.gethostname().split(".")[0],
            user=_user(),
            folder=folder,
            ports=_free_ports(2),
            cores=os.cpu_count(),
            memory=int(SHARE * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**20),
        )
    )
    # Inside a job Snakemake's plugin drops all variables of Slurm, this one too.
    for name in (*CLIENTS, *filter(which, PBS)):
        wrapper = folder / "bin" / name
        wrapper.write_text(f'#!/bin/sh\nSLURM_CONF="{configuration}" exec "{which(name)}" "$@"\n')
        wrapper.chmod(0o755)
    path = f"{folder / 'bin'}{os.pathsep}{os.environ['PATH']}"
    return dict(os.environ, PATH=path, SLURM_CONF=str(configuration))


def _commands(folder: Path) -> list[list[str]]:
    """The servers in the order in which they need each other, in the foreground."""
    munge, configuration = folder / "munge", str(folder / "slurm.conf")
    return [
        [
            "munged",
            "--foreground",
            "--force",  # /tmp is open to all
            f"--socket={munge}/socket",
            f"--key-file={munge}/key",
            f"--pid-file={munge}/pid",
            f"--log-file={munge}/log",
            f"--seed-file={munge}/seed",
        ],
        ["slurmctld", "-D", "-c", "-f", configuration],
        ["slurmd", "-D", "-c", "-f", configuration],
    ]


def _user() -> str:
    return subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()


def _free_ports(count: int) -> list[int]:
    """Ports that nobody listens on now."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]


def _state(environment: dict[str, str]) -> str:
    """Of the node: idle, unknown, down."""
    done = subprocess.run(
        [which("sinfo"), "-h", "-o", "%T"], env=environment, capture_output=True, text=True
    )
    return done.stdout.strip()


def _wait_for(condition, folder: Path) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            said = [f"{log.name}:\n{log.read_text()[-2000:]}" for log in folder.glob("*.log")]
            raise RuntimeError("\n".join(["Slurm did not start within 30 s", *said]))
        time.sleep(0.1)


def _cancel_all(environment: dict[str, str]) -> None:
    """Jobs that are still there would outlive the node."""
    scancel = [which("scancel"), "-u", _user()]
    with contextlib.suppress(subprocess.TimeoutExpired):
        subprocess.run(scancel, env=environment, capture_output=True, timeout=10)


def _end(server: subprocess.Popen) -> None:
    try:
        server.wait(10)
    except subprocess.TimeoutExpired:
        server.kill()
        server.wait()


if __name__ == "__main__":
    if not sys.argv[1:]:
        sys.exit(__doc__.strip())
    if missing():
        sys.exit(f"one_node.py: no {', '.join(missing())} on this machine; on Debian: {INSTALL}")
    with one_node() as found:
        code = subprocess.run(sys.argv[1:], env=found).returncode
    sys.exit(code)
