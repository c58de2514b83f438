"""Films of a mechanism, with its clearance joint magnified."""

from __future__ import annotations

from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.files import replacing, require_suffix
from cylcontact.mechanism import Trajectory
from cylcontact.mechanism.drawing import (
    DRAWN,
    Magnified,
    Pose,
    draw_circle,
    draw_clearance_circle,
    draw_linkage,
    draw_magnified,
    frame,
    poses,
    set_view,
)
from cylcontact.plain_text import as_label
from cylcontact.plots.style import ACCENT, FigureStyle, figure_style
from cylcontact.progress import Progress, silent

__all__ = ["FRAMES_PER_REVOLUTION", "film", "require_film"]

SIZE_INCHES, DPI = (7.2, 3.2), 90
STYLE = FigureStyle("film", font_size=10.0)
# GIF counts time in hundredths of a second.
FRAMES_PER_REVOLUTION, FRAMES_PER_SECOND = 90, 20
# Length of the trail of the journal's centre, in revolutions.
TRAIL = 0.25
TRAIL_LINE: dict[str, Any] = {"color": ACCENT, "linewidth": 0.8, "linestyle": "-", "marker": ""}
CENTRE: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 4,
    "color": "black",
    "markerfacecolor": "black",
}
# Length of the 99th percentile of the force, in radii of the bearing.
ARROW = 0.55
FORCE = {"arrowstyle": "-|>", "color": ACCENT, "linewidth": 2, "shrinkA": 0, "shrinkB": 0}
WRITERS = {".gif": "pillow", ".mp4": "ffmpeg"}


def film(run: Trajectory, path: Path, first: int = 0, progress: Progress = silent) -> int:
    """Write a film of a run; the same run gives the same bytes.

    Parameters
    ----------
    run : Trajectory
        The run.
    path : Path
        A .gif file, or a .mp4 file if ffmpeg is installed.
    first : int, optional
        The first revolution shown, from 0.
    progress : callable, optional
        Called with the stage, the number of frames done and their total.

    Returns
    -------
    int
        The number of frames.

    Raises
    ------
    InputError
        If the suffix is another one, ffmpeg is missing, or the file cannot be written.
    """
    from matplotlib.animation import writers

    require_film(path)
    count = (run.revolutions - first) * FRAMES_PER_REVOLUTION
    times = (first + np.arange(count) / FRAMES_PER_REVOLUTION) * run.mechanism.period
    path_of = poses(run, times)
    with figure_style(STYLE), replacing(path) as temporary:
        figure = Figure(figsize=SIZE_INCHES, layout="constrained")
        scene = _Scene(figure, run, path_of)
        writer = writers[WRITERS[path.suffix]](fps=FRAMES_PER_SECOND)
        try:
            with writer.saving(figure, str(temporary), DPI):
                for number, pose in enumerate(path_of):
                    progress("frames", number, count)
                    scene.draw(pose)
                    writer.grab_frame()
        except CalledProcessError as error:
            rule = f"cannot be written (ffmpeg ended with code {error.returncode})"
            raise InputError(str(path), "", None, rule, "make room, or write a .gif") from error
        progress("frames", count, count)
    return count


def require_film(path: Path) -> None:
    """Raise `InputError` if no film can be written to `path`."""
    from matplotlib.animation import writers

    suffix = require_suffix(path, *WRITERS)
    if not writers.is_available(WRITERS[suffix]):
        raise InputError(
            str(path), "", None, "needs ffmpeg, which is not installed", "write a .gif instead"
        )


class _Scene:
    """The two panels of a film, redrawn for every frame."""

    def __init__(self, figure: Figure, run: Trajectory, path: list[Pose]) -> None:
        self.run, self.joint = run, Magnified.of(run.mechanism)
        self.left, self.right = figure.subplots(1, 2, width_ratios=(1.9, 1.0))
        self.view = frame(run.mechanism, path)
        self.path = path
        touching = run.normal_force[run.in_contact & (run.time >= path[0].time)]
        handles = [
            Line2D([], [], label="journal's centre", **CENTRE),
            Line2D([], [], label=f"its path over {TRAIL:g} revolutions", **TRAIL_LINE),
            Line2D([], [], label="force on the bearing", color=ACCENT, linewidth=2.0),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
        self.scale = float(np.percentile(touching, 99)) if touching.size else 1.0

    def draw(self, pose: Pose) -> None:
        """Draw one frame."""
        mechanism = self.run.mechanism
        row = int(np.searchsorted(self.run.time, pose.time, side="right")) - 1
        for axes in (self.left, self.right):
            axes.clear()
            axes.set_anchor("N")
        set_view(self.left, self.view)
        draw_circle(self.left, mechanism, pose)
        draw_linkage(self.left, mechanism, pose, self.view[1] - self.view[0], self.path)
        law = as_label(mechanism.data["clearance"]["law"])
        self.left.set_title(
            f"{as_label(mechanism.name)}, {self.joint.radial:g} mm, {law}: "
            f"revolution {pose.time / mechanism.period:.2f}"
        )
        centre = draw_magnified(self.right, self.joint, pose.eccentricity)
        draw_clearance_circle(self.right, DRAWN, zorder=5)
        self._draw_trail(self.right, pose.time)
        self.right.plot(*centre, **CENTRE, zorder=7)
        self._draw_force(self.right, row)
        mode = "contact" if self.run.in_contact[row] else "flight"
        self.right.set_title(f"clearance × {self.joint.factor:.3g}: {mode}")

    def _draw_trail(self, axes: Axes, time: float) -> None:
        """Draw the recent path of the journal's centre."""
        begin = time - TRAIL * self.run.mechanism.period
        rows = slice(*np.searchsorted(self.run.time, [begin, time]))
        trail = -DRAWN / self.joint.radial * 1e3 * self.run.eccentricity[rows]
        axes.plot(*trail.T, **TRAIL_LINE, zorder=6)

    def _draw_force(self, axes: Axes, row: int) -> None:
        """Draw the force on the bearing where the journal touches it."""
        force: FloatArray = self.run.force[row]
        size = float(np.hypot(*force))
        if not self.run.in_contact[row] or size == 0.0:
            return
        e = self.run.eccentricity[row]
        contact = -e / np.hypot(*e)
        # Very large forces are cut, so that the arrow stays in the panel.
        length = ARROW * min(size / self.scale, 1.5)
        tip = contact + length * force / size
        axes.annotate(
            "", xy=tuple(tip), xytext=tuple(contact), zorder=9, annotation_clip=False,
            arrowprops=FORCE,
        )  # fmt: skip
