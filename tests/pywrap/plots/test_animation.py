"""The animation of a run, read back by Pillow (plots/animation.py)."""

import shutil
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image, ImageSequence

from lithofrac.analysis.runs import Run
from lithofrac.cli import main
from lithofrac.plots import animation
from lithofrac.results.fields import write_series

pytestmark = pytest.mark.no_core


@pytest.fixture
def make_film_run(make_cracked_run):
    """make_film_run(frames) -> folder of a run with as many frames of the same mesh."""

    def made(frames):
        folder = make_cracked_run("sandstone_soft_p10")
        end = Run(folder).last_frame.time_s
        files = [f"fields/frame_{i:04d}.vtu" for i in range(frames)]
        for name in files[1:]:
            shutil.copy(folder / files[0], folder / name)
        moments = np.linspace(0.0, end, frames) if frames > 1 else [end]
        write_series(folder / "fields.pvd", list(zip(moments, files, strict=True)))
        return folder

    return made


def frames_of(path) -> list[np.ndarray]:
    with Image.open(path) as film:
        return [np.asarray(frame.convert("RGB"), float) for frame in ImageSequence.Iterator(film)]


def test_each_frame_of_the_series_is_one_of_the_film(make_film_run, tmp_path):
    out = tmp_path / "new" / "run.gif"
    assert main(["plot", "animation", str(make_film_run(5)), "--out", str(out)]) == 0
    frames = frames_of(out)
    assert len(frames) == 5  # the last one, held, is written once
    assert all(np.abs(one - two).max() > 100.0 for one, two in pairwise(frames))
    assert [path.name for path in out.parent.iterdir()] == ["run.gif"]
    with Image.open(out) as film:
        assert film.info["loop"] == 0
        film.seek(4)
        held = film.info["duration"]
    assert held >= 1000.0 * animation.HOLD


def test_long_series_are_thinned_to_their_bound(make_film_run, tmp_path, monkeypatch):
    monkeypatch.setattr(animation, "MOST_FRAMES", 4)
    out = tmp_path / "run.gif"
    animation.write([make_film_run(11)], tmp_path, out)
    frames = frames_of(out)
    assert len(frames) == 4
    height, width, _ = frames[0].shape
    assert width <= 720 and height <= 560
    assert out.stat().st_size < 1_000_000


def test_scene_keeps_its_place_from_frame_to_frame(make_film_run, data_folder):
    run = Run(make_film_run(3))
    film = animation.Film(run, run.last_frame)
    before = [panel.get_position().bounds for panel in film.drawn.axes]
    film.show(run.last_frame)
    film.drawn.canvas.draw()
    assert [panel.get_position().bounds for panel in film.drawn.axes] == before


def test_dot_stands_on_the_curve_at_the_moment_of_the_frame(make_film_run):
    run = Run(make_film_run(3))
    film = animation.Film(run, run.last_frame)
    film.show(run.last_frame)
    (x,), (y,) = film.dot.get_data()
    assert x == pytest.approx(100.0 * run.history["axial_strain"].iloc[-1])
    assert y == pytest.approx(run.history["axial_stress_MPa"].iloc[-1])


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        (1, "has fields at 1 moment, expected at least 2 (output.fields of the case)"),
        (0, "holds no fields.pvd, expected a run with output.fields above 0"),
    ],
)
def test_run_with_nothing_to_move_is_refused(make_film_run, tmp_path, capsys, frames, words):
    folder, out = make_film_run(max(frames, 1)), tmp_path / "run.gif"
    if frames == 0:
        (folder / "fields.pvd").unlink()
    assert main(["plot", "animation", str(folder), "--out", str(out)]) == 2
    assert capsys.readouterr().err == f"lithofrac: {folder}: {words}\n"
    assert not out.exists()


def test_animation_in_another_format_is_refused(make_film_run, tmp_path, capsys):
    out = tmp_path / "run.svg"
    assert main(["plot", "animation", str(make_film_run(2)), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.startswith("lithofrac: plot: no figure 'animation', expected one of ")
    assert "with --out *.gif: animation" in said
