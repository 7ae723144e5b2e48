"""Frames read back and the cracks found in them (analysis/frames.py, analysis/crack_faces.py)."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from lithofrac.analysis.crack_faces import find_faces
from lithofrac.analysis.runs import Run

pytestmark = pytest.mark.no_core


@pytest.fixture
def run(make_cracked_run):
    return Run(make_cracked_run("sandstone_soft_p00", cracks=3))


def test_frame_comes_back_in_millimetres(run):
    frame = run.last_frame
    assert frame.time_s == pytest.approx(run.history["time_s"].iloc[-1])
    np.testing.assert_allclose(frame.nodes.max(axis=0), [4.0, 7.0])
    assert frame.areas() == pytest.approx(0.5)
    assert np.ptp(frame.displacement[:, 0]) == pytest.approx(0.2)
    np.testing.assert_allclose(frame.moved(2.0), frame.nodes + 2.0 * frame.displacement)


def test_rock_is_told_from_its_platen(run):
    rock = run.last_frame.part(run.is_rock(run.last_frame))
    assert rock.areas().sum() == pytest.approx(24.0)
    assert rock.nodes.max() == 6.0
    assert len(rock.displacement) == len(rock.nodes) == rock.triangles.max() + 1
    assert len(rock.body) == len(rock.plastic_strain) == len(rock.triangles)


def test_last_frame_is_that_of_the_latest_time_not_of_the_last_line(run):
    series = run.folder / "fields.pvd"
    line = next(line for line in series.read_text().splitlines() if "DataSet" in line)
    early = line.replace("timestep=", 'timestep="0" was=').replace("frame_0000", "frame_none")
    series.write_text(series.read_text().replace(line, f"{line}\n{early}"))
    assert run.last_frame.time_s > 0.0


def test_boundary_runs_round_both_bodies_and_down_and_up_the_crack(run):
    """Rock 20 mm, platen 10 mm, two faces of 3 mm; all with material on the left."""
    frame = run.last_frame
    ends = frame.nodes[frame.boundary()]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(36.0)
    area = 0.5 * (ends[:, 0, 0] * ends[:, 1, 1] - ends[:, 1, 0] * ends[:, 0, 1]).sum()
    assert area == pytest.approx(24.0 + 4.0)


def test_every_crack_has_two_faces_that_part(run):
    frame = run.last_frame
    faces = find_faces(frame, run.cracks)
    assert list(np.bincount(faces.crack)) == [2, 2, 2]
    assert len(faces.lost) == 0
    assert len(faces.other) + len(faces.edges) == len(frame.boundary())
    top = frame.moved()[faces.edges[faces.crack == 0]]
    assert np.ptp(top[..., 0]) == pytest.approx(0.2)


def test_crack_of_a_later_moment_is_not_looked_for(run):
    early = replace(run.last_frame, time_s=run.cracks["time_s"].iloc[1])
    faces = find_faces(early, run.cracks)
    assert set(faces.crack) == {0, 1}
    assert len(faces.lost) == 0
    assert len(find_faces(replace(early, time_s=0.0), run.cracks).edges) == 0


def test_crack_that_was_cut_after_it_opened_is_found_in_pieces(run):
    """One row of 3 mm instead of three of 1 mm."""
    whole = run.cracks.iloc[[0]].assign(y2_mm=3.0, length_mm=3.0)
    faces = find_faces(run.last_frame, whole)
    assert list(faces.crack) == 6 * [0]


def test_crack_that_stands_nowhere_in_the_mesh_is_reported_lost(run):
    """One inside an element, and one along an edge that two triangles still share."""
    rows = run.cracks.iloc[[0, 0, 0]].reset_index(drop=True)
    rows.loc[1, ["x1_mm", "x2_mm"]] = 2.3
    rows.loc[2, ["x1_mm", "x2_mm"]] = 1.0
    faces = find_faces(run.last_frame, rows)
    assert list(faces.lost) == [1, 2]
    assert list(faces.crack) == [0, 0]


def test_noise_of_a_change_of_units_is_forgiven(run):
    columns = ["x1_mm", "y1_mm", "x2_mm", "y2_mm"]
    noisy = run.cracks.copy()
    noisy[columns] += 1e-9 * np.random.default_rng(1).standard_normal((len(noisy), 4))
    assert len(find_faces(run.last_frame, noisy).lost) == 0


def test_run_without_any_crack_has_outer_boundary_alone(run):
    faces = find_faces(run.last_frame, run.cracks.iloc[:0])
    assert (len(faces.edges), len(faces.lost)) == (0, 0)
    assert len(faces.other) == len(run.last_frame.boundary())


def test_cracks_come_in_the_order_of_opening(run):
    pd.read_parquet(run.folder / "cracks.parquet").iloc[::-1].to_parquet(
        run.folder / "cracks.parquet"
    )
    assert Run(run.folder).cracks["time_s"].is_monotonic_increasing
