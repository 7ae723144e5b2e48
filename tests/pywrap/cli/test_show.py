"""`lithofrac show` (pywrap/lithofrac/analysis/overview.py)."""

import json

import pytest

from lithofrac.cli import main

pytestmark = pytest.mark.no_core


@pytest.fixture
def shown(capsys):
    """shown(*folders) -> lines of the table, checked for what every terminal can show."""

    def attempt(*folders):
        assert main(["show", *map(str, folders)]) == 0
        said = capsys.readouterr()
        assert said.err == ""
        assert "\x1b" not in said.out
        lines = said.out.splitlines()
        assert max(map(len, lines)) <= 80
        assert all(line == line.rstrip() for line in lines)
        return lines

    return attempt


def change(folder, **values):
    path = folder / "summary.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | values))


def row(lines, label):
    return next(line for line in lines if line.startswith(label))[len(label) :].split()


def test_one_run_is_a_column_with_units(make_cracked_run, shown):
    folder = make_cracked_run("sandstone_soft_p10")
    energy = {"external_J": 200.0, "elastic_J": 50.0, "friction_J": -30.0, "time_s": 2e-3}
    change(folder, peak_stress_MPa=187.04, peak_strain=0.00702, energy=energy)
    lines = shown(folder)
    assert lines[0].split() == ["sandstone_soft_p10"]
    assert row(lines, "status") == ["completed"]
    assert row(lines, "time step [ns]") == ["9"]
    assert row(lines, "simulated time [ms]") == ["2"]
    assert row(lines, "peak axial stress [MPa]") == ["187"]
    assert row(lines, "axial strain there [%]") == ["0.702"]
    assert row(lines, "elastic [% of work]") == ["25"]
    assert row(lines, "friction [% of work]") == ["15"]
    assert row(lines, "crack length [mm]") == ["3"]


def test_runs_stand_side_by_side_three_at_a_time(make_run, shown):
    names = ["a", "sandstone_plane_strain_k02_p10_with_a_long_name", "c", "d"]
    folders = [make_run(name) for name in names]
    change(folders[2], elements=77)
    lines = shown(*folders)
    assert [line.split()[1:] for line in lines if line.startswith("elements")] == [
        ["1200", "1200", "77"],
        ["1200"],
    ]
    column = slice(47, 63)
    assert "".join(line[column].strip() for line in lines[: lines.index("")][:4]).startswith(
        names[1]
    )


def test_what_no_run_knows_or_has_is_left_out(make_run, shown):
    lines = shown(make_run("a"))
    assert not [line for line in lines if line.startswith(("fragments", "peak", "contact"))]


def test_a_value_that_one_run_lacks_is_a_dash(make_run, make_cracked_run, shown):
    lines = shown(make_run("a"), make_cracked_run("b"))
    assert row(lines, "crack events (failed nodes)") == ["-", "3"]


def test_notes_and_the_reason_of_a_failure_stand_below(make_run, shown):
    good, bad = make_run("good"), make_run("bad")
    change(good, notes=["contact did not converge in 900 of 1000 steps; " + "try less " * 9])
    change(bad, status="failed", message="step 7, element 3: it has turned inside out")
    lines = shown(good, bad)
    below = lines[lines.index("notes") + 1 :]
    assert below[0].startswith("  good: contact did not converge")
    assert below[1].startswith("    ")
    assert below[-1] == "  bad: step 7, element 3: it has turned inside out"


def test_a_file_in_the_folder_and_the_folder_itself_are_one_run(make_run, shown, monkeypatch):
    folder = make_run("a")
    monkeypatch.chdir(folder)
    assert shown(".", "summary.json")[0].split() == ["a"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "{folder}: holds no summary.json, expected a folder of `lithofrac run`"),
        ("[1]", "{folder}/summary.json: expected a JSON object, the summary of a run"),
        ("{", "{folder}/summary.json: expected the summary of a run in JSON (Expecting property "),
    ],
)
def test_a_folder_without_a_summary_is_named(tmp_path, capsys, text, message):
    if text is not None:
        (tmp_path / "summary.json").write_text(text)
    assert main(["show", str(tmp_path)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("lithofrac: " + message.format(folder=tmp_path))
    assert said.err.count("\n") == 1


def test_a_folder_that_is_not_there_is_named(tmp_path, capsys):
    assert main(["show", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: {tmp_path}/none: no such file or folder, expected a results folder\n"
    )


def test_the_folder_of_a_study_says_what_to_show_instead(tmp_path, capsys):
    (tmp_path / "study.yaml").write_text("title: T\n")
    assert main(["show", str(tmp_path)]) == 2
    assert capsys.readouterr().err == (
        f"lithofrac: {tmp_path}: is the folder of a study, expected its runs, as {tmp_path}/runs/*,"
        f" or read {tmp_path}/table.parquet\n"
    )
