"""A run as a moving picture: its pattern beside its curve, a GIF."""

from pathlib import Path

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.figure import Figure
from tqdm import tqdm

from lithofrac.analysis.frames import Frame
from lithofrac.analysis.runs import Run, only_run
from lithofrac.data import DataError
from lithofrac.plots import style
from lithofrac.plots.curves import Axis
from lithofrac.plots.energy import unit
from lithofrac.plots.events import stress_label
from lithofrac.plots.pattern import brightest, draw_pattern, moments, name_parts
from lithofrac.results.files import write_whole

MOST_FRAMES = 60  # of a longer series as many are taken, evenly apart
SECONDS = 6.0  # of the whole picture
SLOWEST, HOLD = 0.4, 1.5  # seconds of a frame at most, of the last one before it starts again
DOTS = 100  # an inch


def write(inputs: list[Path], data: Path, out: Path) -> None:
    """Write the animation of one run; pixels and frames are bounded whatever the run.

    Raises
    ------
    DataError
        When the run has fields at fewer than two moments.
    """
    run = only_run(inputs, "animation")
    listed = moments(run)
    if len(listed) < 2:
        raise DataError(
            f"{run.folder}: has fields at {len(listed)} moment, expected at least 2 "
            "(output.fields of the case)"
        )
    chosen = np.unique(np.linspace(0, len(listed) - 1, min(len(listed), MOST_FRAMES)).round())
    frames = [listed[int(row)] for row in chosen]
    film = Film(run, Frame.load(*reversed(frames[-1])))
    pause = min(SECONDS / len(frames), SLOWEST)
    writer = PillowWriter(fps=1.0 / pause)
    out.parent.mkdir(parents=True, exist_ok=True)

    def record(part: Path) -> None:
        with writer.saving(film.drawn, str(part), dpi=DOTS):
            for time_s, path in tqdm(frames, run.name, unit="frame", disable=None, leave=False):
                film.show(Frame.load(path, time_s))
                writer.grab_frame()
            for _ in range(round(HOLD / pause)):
                writer.grab_frame()

    write_whole(out, record)
    style.plt.close(film.drawn)


class Film:
    """A figure that shows one frame after the other; scales are those of the last frame."""

    drawn: Figure

    def __init__(self, run: Run, last: Frame) -> None:
        self.run, self.axis, self.top = run, Axis(run), brightest(run, last)
        wide, high = np.ptp(last.part(run.is_rock(last)).nodes, axis=0)
        self.drawn, axes = style.new_figure(
            1, 2, height=float(np.clip(3.4 * high / wide, 2.6, 4.6)) + 1.0
        )
        self.pattern, self.curve = axes[0]
        name_parts(self.drawn, self.pattern, run, self._draw(last))
        self._draw_curve()
        self.drawn.canvas.draw()
        self.drawn.set_layout_engine("none")  # settled once, so that nothing jumps

    def show(self, frame: Frame) -> None:
        """Draw one frame and move the dot to its moment."""
        self.pattern.clear()
        self._draw(frame)
        times, x = self.axis.history["time_s"], self.axis.x
        self.dot.set_data(
            [np.interp(frame.time_s, times, x)], [np.interp(frame.time_s, times, self.height)]
        )

    def _draw(self, frame: Frame):
        cracks = ""
        if self.run.discrete:
            opened = self.run.cracks["time_s"] <= frame.time_s * (1 + 1e-9)
            cracks = f", {self.run.cracks.loc[opened, 'length_mm'].sum():.0f} mm of cracks"
        shade = draw_pattern(self.pattern, self.run, frame, self.top)
        self.pattern.set_title(f"{1e3 * frame.time_s:.3f} ms{cracks}", fontweight="normal")
        return shade

    def _draw_curve(self) -> None:
        """Axial stress against strain, or energy against time where nothing is measured."""
        if self.axis.measured:
            self.height = self.axis.history["axial_stress_MPa"].to_numpy()
            label = stress_label(self.run)
        else:
            energy = self.run.energy
            self.height = np.interp(
                self.axis.history["time_s"], energy["time_s"], energy["elastic_J"]
            )
            label = f"elastic energy [{unit(self.run)}]"
        self.curve.plot(self.axis.x, self.height, color=style.BLACK)
        (self.dot,) = self.curve.plot([], [], "o", ms=6, color=style.RED)
        self.curve.set(xlabel=self.axis.label, ylabel=label)
        self.curve.set_title(self.run.name)
