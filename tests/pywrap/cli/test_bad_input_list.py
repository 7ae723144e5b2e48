"""The list of bad input, row by row: exact sentence, exit code 2, nothing half-written.

Rows on meshes are in `test_bad_meshes.py`; more of what a case may hold in `test_bad_input.py`.
"""

import json
import os
import re
from pathlib import Path

import pytest

from lithofrac.cli import main

ROCK = Path("configs/materials/sandstone.yaml").read_text()
CASE = """\
title: A bar
material: ./rock.yaml
scene: {kind: bar, height_mm: 20.0, width_mm: 5.0, element_size_mm: 2.5}
loading: {kind: traction, stress_MPa: 1.0, ramp_transits: 1.0, hold_transits: 1.0}
output: {records: 5, fields: 0}
"""
FOUR = "expected a number not below 0 and below 90"


@pytest.fixture
def files(tmp_path):
    """files(case=..., rock=...) -> path of the case; both texts stand beside each other."""

    def made(case=CASE, rock=ROCK, encoding="utf-8"):
        (tmp_path / "rock.yaml").write_bytes(rock.encode(encoding))
        path = tmp_path / "case.yaml"
        path.write_bytes(case.encode(encoding))
        return path

    return made


def changed(text: str, old: str, new: str) -> str:
    assert text.count(old) == 1
    return text.replace(old, new)


NUMBERS = {
    "young_modulus_GPa: 28.0": "expected a number from 1e-06 to 1e+07",
    "density_kg_m3: 2800.0": "expected a number from 0.001 to 1e+06",
    "tensile_strength_MPa: 4.0": "expected a number from 1e-06 to 1e+06",
    "fracture_energy_J_m2: 100.0": "expected a number from 1e-06 to 1e+09",
    "poisson_ratio: 0.25": "expected a number not below 0 and below 0.5",
}


@pytest.mark.parametrize("line", NUMBERS)
@pytest.mark.parametrize(
    ("value", "shown"), [(".nan", "nan"), (".inf", "inf"), ("-.inf", "-inf"), ("1e400", "inf")]
)
def test_what_is_not_finite_in_a_material(files, refused, tmp_path, line, value, shown):
    key = line.split(":")[0]
    path = files(rock=changed(ROCK, line, f"{key}: {value}"))
    assert refused(path) == (
        f"lithofrac: {tmp_path / 'rock.yaml'}: material.{key} = {shown}: expected a finite number\n"
    )


@pytest.mark.parametrize("line", NUMBERS)
def test_constants_below_zero(files, refused, tmp_path, line):
    key = line.split(":")[0]
    path = files(rock=changed(ROCK, line, f"{key}: -1.0"))
    assert refused(path) == (
        f"lithofrac: {tmp_path / 'rock.yaml'}: material.{key} = -1.0: {NUMBERS[line]}\n"
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "poisson_ratio: 0.25",
            "poisson_ratio: 0.5",
            "poisson_ratio = 0.5: expected a number not below 0 and below 0.5",
        ),
        (
            "poisson_ratio: 0.25",
            "poisson_ratio: -1",
            "poisson_ratio = -1: expected a number not below 0 and below 0.5",
        ),
        (
            "friction_angle_deg: [17.0",
            "friction_angle_deg: [90",
            f"friction_angle_deg.0 = 90: {FOUR}",
        ),
        (
            "friction_angle_deg: [17.0",
            "friction_angle_deg: [.nan",
            "friction_angle_deg.0 = nan: expected a finite number",
        ),
        (
            "plastic_strain: [0.0, 0.0005",
            "plastic_strain: [0.0, 0.0",
            "plastic_strain: expected values that increase strictly, got "
            "0, 0, 0.001, 0.0015, 0.002, 0.008, 0.01, 0.03",
        ),
        (
            "plastic_strain: [0.0, 0.0005",
            "plastic_strain: [0.001, 0.0005",
            "plastic_strain: expected values that increase strictly, got "
            "0.001, 0.0005, 0.001, 0.0015, 0.002, 0.008, 0.01, 0.03",
        ),
        (
            "dilation_angle_deg: [0.0, ",
            "dilation_angle_deg: [",
            "dilation_angle_deg: has 7 values, expected 8, as many as in plastic_strain",
        ),
        ("density_kg_m3: 2800.0\n", "", "density_kg_m3: missing key, expected a number"),
        (
            "density_kg_m3: 2800.0",
            "density_kg_m3: 2800.0\ndensty: 1",
            "densty: unknown key, did you mean 'density_kg_m3'?",
        ),
        (
            "density_kg_m3: 2800.0",
            "density_kg_m3: heavy",
            "density_kg_m3 = heavy: expected a number",
        ),
        ("density_kg_m3: 2800.0", "density_kg_m3: [1]", "density_kg_m3: expected a number"),
    ],
    ids=["nu_high", "nu_low", "phi", "phi_nan", "equal", "falling", "short", "missing", "unknown",
         "word", "list"],
)  # fmt: skip
def test_a_wrong_material(files, refused, tmp_path, old, new, message):
    path = files(rock=changed(ROCK, old, new))
    said = refused(path).replace("expected a number below 90", FOUR)  # pydantic names one bound
    assert said == f"lithofrac: {tmp_path / 'rock.yaml'}: material.{message}\n"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("title: A bar\n", "", "title: missing key, expected a text"),
        ("5.0, element", "5.0, elment_size: 1, element", "scene.elment_size: unknown key, did you "
         "mean 'element_size_mm'?"),
        ("stress_MPa: 1.0", "stress_MPa: much", "loading.stress_MPa = much: expected a number"),
        ("stress_MPa: 1.0", "stress_MPa: true", "loading.stress_MPa = True: expected a number"),
        ("stress_MPa: 1.0", "stress_MPa: 1e400", "loading.stress_MPa = inf: expected a finite "
         "number"),
        ("stress_MPa: 1.0", "stress_MPa: .nan", "loading.stress_MPa = nan: expected a finite "
         "number"),
        ("title: A bar", "title: A bar\ntitle: B", "line 2, column 1: key 'title' stands twice in "
         "one mapping"),
        ("title: A bar", "\ttitle: A bar", "line 1, column 1: found character '\\t' that cannot "
         "start any token"),
        ("title: A bar", "title: &a A bar\nother: *a", "line 2, column 8: aliases are not taken"),
        ("title: A bar", "title: !!bool maybe", "not valid YAML ('maybe')"),
        ("title: A bar", "title: !!python/name:os.system x", "line 1, column 8: could not "
         "determine a constructor for the tag 'tag:yaml.org,2002:python/name:os.system'"),
        ("kind: bar", "kind: [a]", "scene.kind = ['a']: unknown kind, expected one of: bar, "
         "brazilian, gmsh_file, hole, hole_quarter, plane_strain, punch, single_element, "
         "triaxial"),
        ("kind: bar", 'kind: "b\\na\\x1br"', "scene.kind = b a\\x1br: unknown kind, did you mean "
         "'bar'?"),
        ("./rock.yaml", '"a\\0/b"', "{folder}/a\\x00/b: no such file"),
        ("./rock.yaml", "/dev/zero", "/dev/zero: is no regular file, expected a YAML file"),
    ],
    ids=["missing", "unknown", "type", "bool", "1e400", "nan", "twice", "tab", "alias", "tag",
         "python", "kind", "control", "nul", "device"],
)  # fmt: skip
def test_a_wrong_case(files, refused, old, new, message):
    path = files(changed(CASE, old, new))
    message = message.replace("{folder}", str(path.parent))
    named = "" if message.startswith(("/", str(path.parent))) else f"{path}: "
    assert refused(path) == f"lithofrac: {named}{message}\n"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "file is empty, expected a YAML mapping"),
        (b"\n\n", "file is empty, expected a YAML mapping"),
        (b"title: \xff\n", "byte 7 is not UTF-8, expected a YAML file in UTF-8"),
        (b"\xff\xfet\0i\0", "byte 0 is not UTF-8, expected a YAML file in UTF-8"),
        (
            b"title: " + b"x" * 1_000_000,
            "is larger than 1000000 bytes, expected a YAML file",
        ),
    ],
    ids=["empty", "blank", "encoding", "utf16", "large"],
)
def test_a_file_that_is_no_case(refused, tmp_path, content, message):
    path = tmp_path / "case.yaml"
    path.write_bytes(content)
    assert refused(path) == f"lithofrac: {path}: {message}\n"


def test_a_line_of_a_megabyte_is_named_in_a_short_sentence(files, refused):
    path = files(CASE + "x" * 990_000 + ": 1\n")
    said = refused(path)
    assert said.startswith(f"lithofrac: {path}: ")
    assert len(said) < 600
    path = files(changed(CASE, "stress_MPa: 1.0", f"stress_MPa: {'x' * 990_000}"))
    shown = "x" * 57 + "..."
    assert refused(path) == f"lithofrac: {path}: loading.stress_MPa = {shown}: expected a number\n"


def test_thousands_of_mistakes_are_not_all_told(files, refused):
    path = files(CASE + "".join(f"key{i}: 1\n" for i in range(5000)))
    lines = refused(path).splitlines()
    assert len(lines) == 51
    assert lines[-1] == f"lithofrac: {path}: and 4950 more mistakes"


def test_a_deep_text_is_refused(files, refused):
    path = files(CASE + "more: " + "[" * 20_000 + "\n")
    said = refused(path)
    assert said.startswith(f"lithofrac: {path}: ")
    assert said.count("\n") == 1


def test_a_folder_or_a_missing_or_unreadable_file(files, refused, tmp_path, monkeypatch):
    path = tmp_path / "case.yaml"
    assert refused(path) == f"lithofrac: {path}: no such file\n"
    path.mkdir()
    assert refused(path) == f"lithofrac: {path}: is a directory, expected a YAML file\n"
    path.rmdir()
    os.mkfifo(path)  # reading it would wait for ever
    assert refused(path) == f"lithofrac: {path}: is no regular file, expected a YAML file\n"
    path.unlink()
    files()

    def denied(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("lithofrac.config.yaml_file.open", denied, raising=False)
    assert refused(path) == f"lithofrac: {path}: cannot be read (Permission denied)\n"


def test_a_link_that_leads_round_in_a_circle(files, refused, tmp_path):
    path = tmp_path / "case.yaml"
    path.symlink_to(path)
    said = f"lithofrac: {path}: is a link that leads to no file\n"
    assert refused(path) == said
    other = tmp_path / "other.yaml"
    other.write_text(changed(CASE, "./rock.yaml", str(path)))
    assert refused(other) == said


def test_keys_of_the_command_line_without_end(files, refused):
    shown = f"{'a.' * 28}a..."
    assert refused(files(), "--set", f"{'a.' * 2999}a=1") == (
        f"lithofrac: --set {shown}: 2999 dots, expected at most 20\n"
    )


def test_whole_numbers_without_end(files, refused):
    path = files(changed(CASE, "records: 5", f"records: {'1' * 5000}"))
    assert refused(path) == (
        f"lithofrac: {path}: line 5, column 19: a whole number of 5000 digits, expected at most "
        "1000\n"
    )
    path = files(changed(CASE, "stress_MPa: 1.0", f"stress_MPa: {'1' * 399}"))  # above any float
    assert refused(path) == (
        f"lithofrac: {path}: loading.stress_MPa = {'1' * 57}...: expected a number\n"
    )


def test_names_that_are_too_long_for_any_system(files, refused):
    path = files(f"extends: {'x' * 5000}\n")
    said = refused(path)
    assert said.startswith(f"lithofrac: {path}: extends = xxx")
    assert "...: no such file, looked for " in said
    path = files(changed(CASE, "./rock.yaml", "x" * 5000))
    assert refused(path).startswith(f"lithofrac: {path}: material 'xxx")
    assert refused(path.parent / ("x" * 5000 + ".yaml")).endswith(
        ".yaml: cannot be read (File name too long)\n"
    )


@pytest.mark.parametrize("way", ["plain", "crlf", "bom", "latin name"])
def test_line_ends_marks_and_names_that_are_good_input(files, tmp_path, capsys, way):
    case = CASE.replace("\n", "\r\n") if way == "crlf" else CASE
    path = files(case, ROCK.replace("\n", "\r\n") if way == "crlf" else ROCK,
                 "utf-8-sig" if way == "bom" else "utf-8")  # fmt: skip
    out = tmp_path / "out"
    if way == "latin name":
        folder = tmp_path / "Gr\u00f6\u00dfe \u5ca9\u77f3"
        folder.mkdir()
        for name in ("case.yaml", "rock.yaml"):
            (tmp_path / name).rename(folder / name)
        path, out = folder / "case.yaml", folder / "out"
    assert main(["run", str(path), "--out", str(out), "--quiet"]) == 0
    assert json.loads((out / "summary.json").read_text())["status"] == "completed"
    assert capsys.readouterr().err == ""


def test_a_name_that_the_terminal_cannot_show_stops_nothing(files, tmp_path, monkeypatch):
    import io
    import sys

    path = files(changed(CASE, "A bar", "\u5ca9\u77f3"))
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    assert main(["check", str(path)]) == 0
    sys.stdout.flush()
    assert b"\\u5ca9" in sys.stdout.buffer.getvalue()


# ---------------------------------------------------------------- warnings


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "dilation_angle_deg: [0.0",
            "dilation_angle_deg: [18.0",
            "material.dilation_angle_deg.0 = 18: above friction_angle_deg.0 = 17, where flow under "
            "a high pressure gives off energy",
        ),
        (
            "density_kg_m3: 2800.0",
            "density_kg_m3: 2.8",
            "material: pressure waves run at 1.1e+05 m/s, usual are 10 to 20000; are "
            "young_modulus_GPa = 28 and density_kg_m3 = 2.8 in these units?",
        ),
        (
            "young_modulus_GPa: 28.0",
            "elastic: true\nyoung_modulus_GPa: 2.8e-5",
            "material: pressure waves run at 3.46 m/s, usual are 10 to 20000; are "
            "young_modulus_GPa = 2.8e-05 and density_kg_m3 = 2800 in these units?",
        ),
    ],
    ids=["dilation", "fast", "slow"],
)
def test_what_is_seldom_meant_is_a_warning(files, tmp_path, capsys, old, new, message):
    path = files(changed(CASE, "stress_MPa: 1.0", "stress_MPa: 0.001"), changed(ROCK, old, new))
    assert main(["check", str(path)]) == 0
    assert capsys.readouterr().err == f"lithofrac: warning: {path}: {message}\n"
    out = tmp_path / "out"
    assert main(["run", str(path), "--out", str(out), "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    assert json.loads((out / "summary.json").read_text())["input_warnings"] == [message]


# ---------------------------------------------------------------- budget


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_case_above_its_budget_is_refused(files, tmp_path, capsys, command):
    path = files(CASE + "budget_element_steps: 100\n")
    before = sorted(tmp_path.rglob("*"))
    out = ["--out", str(tmp_path / "out")] if command == "run" else []
    assert main([command, str(path), *out]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith(
        f"lithofrac: {path}: budget_element_steps = 100: the run takes 32 elements times "
    )
    assert said.err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before
    assert main([command, str(path), *out, "--set", "budget_element_steps=1e6"]) == 0


def test_of_several_cases_one_above_its_budget_is_refused_by_prediction(files, capsys):
    path = files(CASE + "budget_element_steps: 100\n")
    assert main(["check", "bar_wave", str(path)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert re.fullmatch(
        rf"lithofrac: {re.escape(str(path))}: budget_element_steps = 100: the run takes about "
        r"\d+ elements times \d+ steps\n",
        said.err,
    )
    assert main(["check", str(path), str(path), "--set", "budget_element_steps=1e6"]) == 0


# ---------------------------------------------------------------- paths


@pytest.mark.parametrize("name", ["../up", "/tmp/up", "a/b", "..", ".hidden", "a\\nb"])
def test_a_suite_names_no_folder_outside(tmp_path, capsys, name):
    path = tmp_path / "suite.yaml"
    path.write_text(f'title: A suite\ncases: {{"{name}": {{extends: case}}}}\n')
    assert main(["check", "--suite", str(path)]) == 2
    assert capsys.readouterr().err.startswith(f"lithofrac: {path}: cases.")


def test_no_text_of_a_config_becomes_a_path_that_is_written(files, tmp_path):
    """All texts that a config may choose freely point out of the folder of the results."""
    folder = tmp_path / "in"
    folder.mkdir()
    text = changed(CASE, "title: A bar", 'title: "../title"')
    path = files(text + 'probes: {"../probe": {x_mm: 1, y_mm: 1}, "/tmp/x": {x_mm: 1, y_mm: 2}}\n')
    before = sorted(tmp_path.rglob("*"))
    out = folder / "results"
    assert main(["run", str(path), "--out", str(out), "--quiet"]) == 0
    after = [p for p in tmp_path.rglob("*") if out != p and out not in p.parents]
    assert sorted(after) == before


def test_a_mesh_replaces_no_device_and_leaves_no_half_file(files, tmp_path, capsys, monkeypatch):
    path = files()
    pipe = tmp_path / "pipe"  # as /dev/null is
    os.mkfifo(pipe)
    assert main(["mesh", str(path), "--out", str(pipe)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: --out {pipe}: is no regular file, expected a file to write\n"
    )
    assert pipe.is_fifo()

    def full(self, part):
        part.write_bytes(b"half")
        raise OSError(28, "No space left on device")

    before = sorted(tmp_path.rglob("*"))
    monkeypatch.setattr("lithofrac.problem.Mesh.save", full)
    assert main(["mesh", str(path), "--out", str(tmp_path / "mesh.npz")]) == 2
    assert capsys.readouterr().err == "lithofrac: [Errno 28] No space left on device\n"
    assert sorted(tmp_path.rglob("*")) == before
