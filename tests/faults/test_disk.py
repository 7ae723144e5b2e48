"""A disk that is full or read-only: one sentence, exit code 2, the last checkpoints stay good."""

import ctypes
import os
import resource
import shutil
import subprocess

import numpy as np
import pytest
from fault_runs import LITHOFRAC, MARK, assert_same, wait_for_checkpoints

# One small run again and again, what is tested is how files are written; for the core, the same
# run is stopped and resumed in test_signals.py and test_damage.py.
pytestmark = [pytest.mark.restart, pytest.mark.one_build]
DROP_FROM_BOUNDING_SET, DAC_OVERRIDE = 24, 1  # <linux/prctl.h>, <linux/capability.h>


def obey_permissions():
    """Before exec: root, too, may not write where the permissions say so."""
    if os.geteuid() == 0 and ctypes.CDLL(None).prctl(DROP_FROM_BOUNDING_SET, DAC_OVERRIDE, 0, 0, 0):
        os._exit(99)


@pytest.fixture
def read_only(tmp_path):
    """read_only(folder): nobody may write there until the test is over; skips where root may."""
    probe, changed = tmp_path / "probe", []
    probe.mkdir(mode=0o500)
    tried = subprocess.run(
        ["touch", str(probe / "a")], preexec_fn=obey_permissions, stderr=subprocess.DEVNULL
    )
    if tried.returncode in (0, 99):
        pytest.skip("this user may write into any folder, and cannot give that right up")

    def made(folder):
        changed.append(folder)
        folder.chmod(0o500)

    yield made
    for folder in changed:
        folder.chmod(0o700)


def sentence(out, why):
    """What a run says that had a checkpoint when it could write no more."""
    return (
        f"lithofrac: --out {out}: cannot be written ({why}); "
        f"the same command with --resume goes on from {out}\n"
    )


def assert_goes_on(cracking, unbroken, out):
    """Both checkpoints are whole, and the run ends as the one that nothing stopped."""
    for name in ("checkpoint.npz", "checkpoint_previous.npz"):
        with np.load(out / name) as file:
            assert len({key: file[key] for key in file}) > 5
    assert cracking.run(out, "--resume") == (0, "")
    assert_same(unbroken, out)


def test_file_that_may_not_grow(cracking, unbroken, tmp_path):
    """A quota: checkpoints grow with the cracks."""
    out, limit = tmp_path / "out", (unbroken / "checkpoint.npz").stat().st_size - 20_000
    code, said = cracking.run(
        out, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    )
    assert (code, said) == (2, sentence(out, "File too large"))
    assert [path.name for path in out.glob(".*")] == [MARK]
    assert_goes_on(cracking, unbroken, out)


def test_full_disk(cracking, unbroken, tmp_path):
    """A file system of its own that is too small; then its files move to a larger one."""
    disk, kept = tmp_path / "disk", tmp_path / "kept"
    disk.mkdir()
    own = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c"]
    mount = f"mount -t tmpfs -o size=$1 tmpfs {disk}"
    if (
        not shutil.which("unshare")
        or subprocess.run([*own, mount, "sh", "1m"], stderr=subprocess.DEVNULL).returncode
    ):
        pytest.skip("no right to make a file system of a given size")
    size = sum(file.stat().st_size for file in unbroken.rglob("*") if file.is_file())
    script = f'{mount} || exit 98; shift; "$@"; code=$?; cp -a {disk}/out {kept}; exit $code'
    words = [*LITHOFRAC, *cracking.words(disk / "out")]
    done = subprocess.run(
        [*own, script, "sh", f"{size * 7 // 10}", *words], stderr=subprocess.PIPE, text=True
    )
    assert (done.returncode, done.stderr) == (2, sentence(disk / "out", "No space left on device"))
    assert [path.name for path in kept.glob(".*")] == [MARK]
    assert_goes_on(cracking, unbroken, kept)


def test_full_disk_below_the_temporary_files(tmp_path):
    """gmsh says nothing of what it could not write."""
    disk = tmp_path / "disk"
    disk.mkdir()
    own = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c"]
    script = f'mount -t tmpfs -o size=$1 tmpfs {disk} || exit 98; shift; TMPDIR={disk} exec "$@"'
    if not shutil.which("unshare") or subprocess.run([*own, script, "sh", "1m", "true"]).returncode:
        pytest.skip("no right to make a file system of a given size")
    words = [*LITHOFRAC, "mesh", "hole_r25.0", "--out", str(tmp_path / "mesh.npz")]
    done = subprocess.run([*own, script, "sh", "40k", *words], stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr == f"lithofrac: [Errno 28] No space left on device: '{disk}'\n"
    assert not (tmp_path / "mesh.npz").exists()


def test_folder_that_may_not_be_made(cracking, tmp_path, read_only):
    home = tmp_path / "home"
    home.mkdir()
    read_only(home)
    out = home / "out"
    code, said = cracking.run(out, preexec_fn=obey_permissions)
    assert code == 2
    assert said == f"lithofrac: --out {out}: cannot be written (Permission denied)\n"


def test_folder_that_becomes_read_only(cracking, unbroken, tmp_path, read_only):
    out = tmp_path / "out"
    process = cracking.start(out, preexec_fn=obey_permissions)
    wait_for_checkpoints(out, 10, process)
    read_only(out)
    said = process.communicate(timeout=300)[1]
    assert (process.returncode, said) == (2, sentence(out, "Permission denied"))
    code, said = cracking.run(out, "--resume", preexec_fn=obey_permissions)
    assert (code, said) == (2, sentence(out, "Permission denied"))
    out.chmod(0o700)
    assert_goes_on(cracking, unbroken, out)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full here")
class TestOutputThatIsFull:
    """What is printed goes to a disk that is full."""

    def test_result_of_a_command(self):
        with open("/dev/full", "w") as full:
            done = subprocess.run(
                [*LITHOFRAC, "check", "bar_wave"], stdout=full, stderr=subprocess.PIPE, text=True
            )
        assert done.returncode == 2
        assert done.stderr == "lithofrac: [Errno 28] No space left on device\n"

    def test_log_of_a_run(self, cracking, unbroken, tmp_path):
        words = [word for word in cracking.words(tmp_path / "out") if word != "--quiet"]
        with open("/dev/full", "w") as full:
            done = subprocess.run(
                [*LITHOFRAC, *words], stdout=subprocess.PIPE, stderr=full, text=True
            )
        assert done.returncode == 0
        assert "completed" in done.stdout
        assert_same(unbroken, tmp_path / "out")


def test_reader_that_has_gone():
    """As in `lithofrac check | head`."""
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [*LITHOFRAC, "check", "bar_wave"], stdout=write, stderr=subprocess.PIPE, text=True
    )
    os.close(write)
    assert (done.returncode, done.stderr) == (0, "")
