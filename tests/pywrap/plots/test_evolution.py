"""Three moments of a fracture pattern (plots/evolution.py)."""

import shutil

import pytest

from lithofrac.analysis.runs import Run
from lithofrac.plots import evolution
from lithofrac.results.fields import write_series

pytestmark = pytest.mark.no_core


@pytest.fixture
def folder(make_cracked_run):
    """Three cracks of 1 mm at 0.4, 0.5 and 0.6 of the run; frames at each tenth of it."""
    folder = make_cracked_run("sandstone_plane_strain_p10", confinement=10.0)
    end = Run(folder).last_frame.time_s
    names = [f"fields/frame_{i:04d}.vtu" for i in range(11)]
    for name in names[1:]:
        shutil.copy(folder / names[0], folder / name)
    write_series(folder / "fields.pvd", [(0.1 * i * end, name) for i, name in enumerate(names)])
    return folder


def test_moments_are_those_of_a_tenth_and_half_of_the_cracks_and_the_end(folder):
    run = Run(folder)
    end = run.history["time_s"].iloc[-1]
    shares = [frame.time_s / end for frame in evolution.moments(run)]
    assert shares == pytest.approx([0.4, 0.5, 1.0])


def test_each_frame_is_drawn_once_when_all_cracks_open_in_one(make_cracked_run):
    run = Run(make_cracked_run("sandstone_plane_strain_p10"))
    assert len(evolution.moments(run)) == 1


def test_run_without_cracks_shows_its_end(make_cracked_run, data_folder):
    folder = make_cracked_run("sandstone_plane_strain_p10", cracks=1)
    run = Run(folder)
    run.cracks.iloc[:0].to_parquet(folder / "cracks.parquet")
    assert len(evolution.moments(Run(folder))) == 1
    evolution.figure([folder], data_folder)


def test_panels_say_when_they_are_and_how_much_has_cracked(folder, data_folder):
    curve, *panels, bar = evolution.figure([folder], data_folder).axes
    assert curve.get_xlabel() == "axial strain [%]"
    assert [panel.get_title(loc="left") for panel in panels] == [
        "1  0.80 %", "2  1.00 %", "3  2.00 %",
    ]  # fmt: skip
    assert [panel.get_xlabel().split("\n")[1] for panel in panels] == [
        "1 mm of cracks", "2 mm of cracks", "3 mm of cracks",
    ]  # fmt: skip
    assert bar.get_ylabel() == "effective plastic strain [-]"
