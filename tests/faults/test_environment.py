"""Same bits whatever surrounds a run: threads, locale, hashes of Python, time zone, memory."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml
from fault_runs import LITHOFRAC, assert_same

from lithofrac.cli import main
from lithofrac.config import load_suite

SOURCES = Path("/usr/share/i18n/locales/de_DE")


@pytest.fixture(scope="session")
def german(tmp_path_factory) -> dict[str, str]:
    """Variables of a locale that writes 0,5 for a half; made here where the system has none."""
    if not (shutil.which("localedef") and SOURCES.exists()):
        pytest.skip("no German locale here and no sources to make one from")
    folder = tmp_path_factory.mktemp("locales")
    made = ["localedef", "-i", "de_DE", "-f", "ISO-8859-1", str(folder / "de_DE.ISO-8859-1")]
    subprocess.run(made, check=True, capture_output=True)
    return {"LOCPATH": str(folder), "LC_ALL": "de_DE.ISO-8859-1", "LANG": "de_DE.ISO-8859-1"}


ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.mark.restart
@pytest.mark.parametrize(
    ("threads", "variables"),
    [
        ("1", {"PYTHONHASHSEED": "1", "TZ": "Asia/Kathmandu", "OMP_NUM_THREADS": "4"}),
        ("2", {"PYTHONHASHSEED": "2", "MALLOC_PERTURB_": "165"}),
        ("3", ASCII | {"PYTHONHASHSEED": "3", "OMP_SCHEDULE": "dynamic"}),
        ("8", {"PYTHONHASHSEED": "4", "OMP_DYNAMIC": "true"}),
    ],
    ids=["1 thread", "2 threads, dirty memory", "3 threads, no locale", "8 threads"],
)
def test_surroundings_change_no_bit(cracking, unbroken, tmp_path, threads, variables):
    out = tmp_path / "out"
    environment = {**os.environ, **variables}
    assert cracking.run(out, "--threads", threads, env=environment, cwd=tmp_path) == (0, "")
    assert_same(unbroken, out)


@pytest.mark.restart
def test_locale_changes_no_bit(cracking, unbroken, german, tmp_path):
    out = tmp_path / "out"
    assert cracking.run(out, env={**os.environ, **german}) == (0, "")
    assert_same(unbroken, out)


@pytest.mark.no_core
@pytest.mark.parametrize("name", ["kirsch", "bar_wave"])
def test_locale_changes_no_mesh(german, tmp_path, name):
    """gmsh is a program of its own, with its own way to read and write numbers."""
    for number, variables in enumerate(({}, german)):
        done = subprocess.run(
            [*LITHOFRAC, "mesh", name, "--out", str(tmp_path / f"{number}.npz")],
            env={**os.environ, **variables}, capture_output=True, text=True,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "0.npz").read_bytes() == (tmp_path / "1.npz").read_bytes()


@pytest.mark.restart
def test_order_of_cases_changes_no_bit(cracking, unbroken, tmp_path):
    """Two cases in one process, in both orders: nothing is left of the one before."""
    bar = ["run", "bar_wave", "--set", "scene.element_size_mm=2.5", "--quiet", "--out"]
    for first, second in (("bar", "cracking"), ("cracking", "bar")):
        for name in (first, second):
            out = tmp_path / first / name
            assert main(cracking.words(out) if name == "cracking" else [*bar, str(out)]) == 0
    assert_same(tmp_path / "bar" / "bar", tmp_path / "cracking" / "bar")
    for first in ("bar", "cracking"):
        assert_same(unbroken, tmp_path / first / "cracking")


@pytest.mark.no_core
def test_order_in_a_suite_changes_no_case(tmp_path):
    values = yaml.safe_load(Path("configs/suite_quick.yaml").read_text())
    for entry in values["cases"].values():
        entry["extends"] = str(Path("configs", entry["extends"]).resolve())
    values["cases"] = dict(reversed(values["cases"].items()))
    turned = tmp_path / "turned.yaml"
    turned.write_text(yaml.safe_dump(values, sort_keys=False))
    one, other = load_suite("configs/suite_quick.yaml"), load_suite(turned)
    assert other.names == one.names[::-1]
    for name in one.names:
        assert other.case(name) == one.case(name)


def test_letters_that_the_locale_lacks_are_printed_somehow(cracking):
    done = subprocess.run(
        [*LITHOFRAC, "check", str(cracking.file)],
        env={**os.environ, **ASCII}, capture_output=True, text=True,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert r"0\xb0 to 90\xb0" in done.stdout
