"""A second run into the folder of one that is at work is refused and changes nothing."""

import signal

import pytest
from fault_runs import assert_same, wait_for_checkpoints

from lithofrac.cli import main

pytestmark = pytest.mark.one_build  # as in test_disk.py; what is tested is the lock


@pytest.mark.parametrize("how", [[], ["--resume"], ["--resume-if-possible"]])
def test_second_run_is_refused(cracking, unbroken, tmp_path, capsys, how):
    out = tmp_path / "out"
    first = cracking.start(out)
    wait_for_checkpoints(out, 5, first)
    first.send_signal(signal.SIGSTOP)  # or it may end while the second makes its mesh
    assert main(cracking.words(out, *how)) == 2
    first.send_signal(signal.SIGCONT)
    said = capsys.readouterr().err
    assert first.communicate(timeout=300)[1] == ""
    assert first.returncode == 0
    assert said == (
        f"lithofrac: {out}: another run writes into it, process {first.pid}; wait for its end, "
        "or give this one a folder of its own\n"
    )
    assert_same(unbroken, out)
