"""Drawings and films of a mechanism, its joints with clearance magnified."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.animation import FuncAnimation, writers
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyBboxPatch, Polygon, Rectangle
from matplotlib.transforms import Affine2D
from scipy.spatial import ConvexHull

from cylcontact.arrays import FloatArray, require
from cylcontact.errors import InputError
from cylcontact.files import replacing, require_suffix
from cylcontact.mechanism import ClearanceJoint, JointMotion, Mechanism, Trajectory
from cylcontact.mechanism.model import Joint
from cylcontact.plain_text import as_label, brief
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.sketch import OUTLINE, POINTER, THIN, Point
from cylcontact.plots.style import ACCENT, QUIET, figure_style
from cylcontact.progress import Progress, silent

# Margins along x and y around the points, as fractions of their span along x.
MARGINS = (0.12, 0.08)
# Sizes of the parts as fractions of the span of the mechanism.
LINK, PIN, BLOCK, SUPPORT = 0.028, 0.011, (0.15, 0.085), 0.045
# Length of a guide beyond the extreme positions of the slide.
GUIDE = 0.13
FILLS = ("0.72", "0.88", "0.80", "0.94")


@dataclass(frozen=True)
class Pose:
    """The positions of all bodies at a time in s, in mm and rad.

    Points go by body, the ground included, and name, e by joint, centres of mass and angles by
    body.
    """

    time: float
    points: dict[str, dict[str, Point]]
    eccentricity: dict[str, Point]
    centres: dict[str, Point]
    angles: dict[str, float]


def poses(run: Trajectory, times: FloatArray) -> list[Pose]:
    """Return the poses of a run at times in s, by linear interpolation between its steps."""
    data = run.mechanism.data
    flat = run.coordinates.reshape(run.time.size, -1)
    bodies = np.column_stack([np.interp(times, run.time, column) for column in flat.T])
    ways = {
        name: np.column_stack([np.interp(times, run.time, e) for e in joint.eccentricity.T])
        for name, joint in run.joints.items()
    }
    ground = {name: _mm(point) for name, point in data["ground"]["points"].items()}
    result = []
    for at, (time, row) in enumerate(zip(times, bodies.reshape(times.size, -1, 3), strict=True)):
        way = {name: _mm(e[at]) for name, e in ways.items()}
        points, centres, angles = {"ground": ground}, {}, {}
        for body, (x, y, angle) in zip(run.mechanism.bodies, row, strict=True):
            centres[body.name], angles[body.name] = _mm((x, y)), float(angle)
            points[body.name] = {
                name: _mm(_in_global_axes(x, y, angle, local))
                for name, local in data["bodies"][body.name]["points"].items()
            }
        result.append(Pose(float(time), points, way, centres, angles))
    return result


def _in_global_axes(x: float, y: float, angle: float, local: Point) -> Point:
    """Return a point given in the axes of a body in global axes."""
    at = complex(x, y) + np.exp(1j * angle) * complex(*local)
    return (float(at.real), float(at.imag))


def _mm(point: FloatArray | Point) -> Point:
    """Return a point given in m in mm."""
    return (float(point[0]) * 1e3, float(point[1]) * 1e3)


def draw_linkage(
    axes: Axes, mechanism: Mechanism, pose: Pose, size: float, path: Sequence[Pose] = ()
) -> None:
    """Draw a mechanism in a pose, its parts in proportion to its span `size`, all in mm.

    Guides are as long as all the poses of a path need.
    """
    for joint in mechanism.joints:
        if joint.kind == "prismatic":
            _draw_guide(axes, path or [pose], mechanism, joint, size)
    _draw_supports(axes, mechanism, size)
    for number, body in enumerate(mechanism.bodies):
        points = list(pose.points[body.name].values())
        fill = FILLS[number % len(FILLS)]
        if len(points) > 1:
            axes.add_patch(_link(points, LINK * size, fill, 2 + number))
        else:
            _draw_block(axes, points[0], pose.angles[body.name], size, fill)
    for joint in mechanism.joints:
        if joint.kind == "revolute":
            _draw_pin(axes, mechanism, pose, joint, size)


def driver_circle(mechanism: Mechanism, pose: Pose) -> tuple[Point, float] | None:
    """Return centre and radius in mm of the circle of the driven body's free end, if any."""
    drives = [joint for joint in mechanism.joints if joint.kind == "driver"]
    if not drives:
        return None
    driven = max(drives[0].i, drives[0].j)
    for joint in mechanism.joints:
        if joint.kind == "revolute" and {joint.i, joint.j} == {-1, driven}:
            ground = joint.point_i if joint.i == -1 else joint.point_j
            centre = _mm(ground)
            ends = pose.points[mechanism.bodies[driven].name].values()
            return centre, max(float(np.hypot(x - centre[0], y - centre[1])) for x, y in ends)
    return None


def _link(points: list[Point], radius: float, fill: str, order: int) -> Polygon:
    """Return a body as a bar, the hull of discs about its points."""
    turn = np.exp(1j * np.linspace(0, 2 * np.pi, 73))
    cloud = np.concatenate([complex(*point) + radius * turn for point in points])
    flat = np.column_stack((cloud.real, cloud.imag))
    corners = flat[ConvexHull(flat).vertices]
    return Polygon(corners, closed=True, facecolor=fill, zorder=order, **OUTLINE)


def _draw_block(axes: Axes, centre: Point, angle: float, size: float, fill: str) -> None:
    """Draw a block about a body's only point."""
    width, height = (share * size for share in BLOCK)
    block = FancyBboxPatch(
        (-width / 2, -height / 2),
        width,
        height,
        boxstyle=f"round,pad=0,rounding_size={0.1 * height}",
        facecolor=fill,
        zorder=1.5,
        **OUTLINE,
    )
    block.set_transform(Affine2D().rotate(angle).translate(*centre) + axes.transData)
    axes.add_patch(block)


def _draw_guide(
    axes: Axes, path: Sequence[Pose], mechanism: Mechanism, joint: Joint, size: float
) -> None:
    """Draw the two lines between which a body slides in some poses."""
    body = mechanism.bodies[max(joint.i, joint.j)].name
    along = complex(np.exp(1j * joint.direction))
    # The line goes through the point of the ground; that of the body moves along it.
    ground = complex(*_mm(joint.point_i if joint.i == -1 else joint.point_j))
    points = [complex(*next(iter(pose.points[body].values()))) for pose in path]
    travel = [((point - ground) * along.conjugate()).real for point in points]
    beyond = GUIDE * size
    for side in (1, -1):
        rail = ground + side * 0.5 * BLOCK[1] * size * 1j * along
        ends = [rail + at * along for at in (min(travel) - beyond, max(travel) + beyond)]
        axes.plot([z.real for z in ends], [z.imag for z in ends], **THIN | {"linewidth": 0.9})


def _draw_supports(axes: Axes, mechanism: Mechanism, size: float) -> None:
    """Draw a hatched triangle below every revolute joint with the ground."""
    half = SUPPORT * size
    for joint in mechanism.joints:
        if joint.kind == "revolute" and -1 in (joint.i, joint.j):
            x, y = _mm(joint.point_i if joint.i == -1 else joint.point_j)
            corners = [(x, y), (x - half, y - 1.5 * half), (x + half, y - 1.5 * half)]
            axes.add_patch(Polygon(corners, facecolor="white", zorder=1, **OUTLINE))
            left, below = x - 1.5 * half, y - 1.5 * half
            strip = Rectangle((left, below - 0.5 * half), 3 * half, 0.5 * half)
            strip.set(facecolor="none", edgecolor="black", hatch="/////", linewidth=0.0)
            axes.add_patch(strip)
            axes.plot([left, left + 3 * half], [below, below], **THIN | {"linewidth": 0.9})


def joint_place(mechanism: Mechanism, pose: Pose, joint: Joint) -> Point:
    """Return the position of a joint in mm, from the point of its first moving body."""
    body, local = (joint.j, joint.point_j) if joint.i == -1 else (joint.i, joint.point_i)
    name = mechanism.bodies[body].name
    x, y = pose.centres[name]
    return _in_global_axes(x, y, pose.angles[name], _mm(local))


def _draw_pin(axes: Axes, mechanism: Mechanism, pose: Pose, joint: Joint, size: float) -> None:
    """Draw a revolute joint, highlighted if it has the clearance."""
    centre = joint_place(mechanism, pose, joint)
    axes.add_patch(Circle(centre, PIN * size, facecolor="white", zorder=8, **OUTLINE))
    if joint.clearance is not None:
        ring = {"fill": False, "edgecolor": ACCENT, "linewidth": 1.4}
        axes.add_patch(Circle(centre, 2.1 * PIN * size, zorder=8, **ring))


def frame(mechanism: Mechanism, path: list[Pose]) -> tuple[float, float, float, float]:
    """Return a view of the mechanism in some poses, in mm: left, right, bottom, top."""
    points = [at for pose in path for body in pose.points.values() for at in body.values()]
    circle = driver_circle(mechanism, path[0])
    if circle is not None:
        (x, y), radius = circle
        points += [(x - radius, y - radius), (x + radius, y + radius)]
    (left, low), (right, high) = np.min(points, axis=0), np.max(points, axis=0)
    across, along = (share * (right - left) for share in MARGINS)
    return float(left - across), float(right + across), float(low - along), float(high + along)


def set_view(axes: Axes, view: tuple[float, float, float, float]) -> None:
    """Show a view to scale, without axes."""
    axes.set(xlim=view[:2], ylim=view[2:], aspect="equal")
    axes.set_axis_off()


def draw_circle(axes: Axes, mechanism: Mechanism, pose: Pose) -> None:
    """Draw the driver's circle with an arrow in the direction of rotation."""
    circle = driver_circle(mechanism, pose)
    if circle is None:
        return
    (x, y), radius = circle
    path = Circle((x, y), radius, zorder=0.5, fill=False, edgecolor="0.5")
    path.set(linewidth=0.6, linestyle=(0, (4, 3)))
    axes.add_patch(path)
    sense = next(j.speed or j.torque for j in mechanism.joints if j.kind == "driver")
    turn = np.radians(np.array([118.0, 142.0])[:: int(np.sign(sense))])
    start, end = (
        (float(x + radius * np.cos(angle)), float(y + radius * np.sin(angle))) for angle in turn
    )
    # The control point of an arc is half the tangent of half its angle away, in chords.
    bend = 0.5 * np.tan(0.5 * (turn[1] - turn[0]))
    arrow = POINTER | {"connectionstyle": f"arc3,rad={bend:g}", "zorder": 1, "linewidth": 0.9}
    axes.annotate("", xy=end, xytext=start, arrowprops=arrow)


# The clearance as drawn, in radii of the bearing.
DRAWN = 0.3
BEARING, JOURNAL = "0.80", "0.93"
RIM = 1.22


def magnification(contact: ClearanceJoint) -> float:
    """Return by how much the clearance of a joint is magnified against its radius."""
    return DRAWN * float(np.asarray(contact.pair.R_i)) / contact.radial


def draw_magnified(axes: Axes, contact: ClearanceJoint, eccentricity: Point) -> Point:
    """Draw bearing and pin, e in mm, in radii of the bearing; return the pin's centre as drawn."""
    scale = -DRAWN / contact.radial
    centre = (scale * eccentricity[0], scale * eccentricity[1])
    axes.add_patch(Circle((0, 0), RIM, facecolor=BEARING, zorder=1, **OUTLINE))
    axes.add_patch(Circle((0, 0), 1.0, facecolor="white", zorder=2, **OUTLINE))
    axes.add_patch(Circle(centre, 1.0 - DRAWN, facecolor=JOURNAL, alpha=0.85, zorder=3, **OUTLINE))
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
    axes.set_axis_off()
    return centre


def draw_clearance_circle(axes: Axes, radius: float, **style: Any) -> None:
    """Draw the circle that the journal's centre crosses when it touches the bearing."""
    turn = np.linspace(0, 2 * np.pi, 181)
    defaults: dict[str, Any] = {
        "color": "black",
        "linewidth": 0.7,
        "linestyle": (0, (5, 3)),
        "marker": "",
    }
    axes.plot(radius * np.cos(turn), radius * np.sin(turn), **defaults | style)


@figure_style()
def joint_drawing(joint: JointMotion, revolutions: float = 2.0) -> Drawing:
    """Draw the end of a run; see `Trajectory.plot`."""
    require(revolutions > 0, "plot", "revolutions", revolutions, "must be positive", "give e.g. 2")
    revolution = joint.run.revolution
    last = revolution >= revolution[-1] - revolutions
    centre = -1e3 * joint.eccentricity[last]
    table = pd.DataFrame(
        {
            "revolution": revolution[last],
            "x_mm": centre[:, 0],
            "y_mm": centre[:, 1],
            "normal_force_N": joint.normal_force[last],
        }
    )
    figure = new_figure("full", 70.0)
    path, force = figure.subplots(1, 2, width_ratios=(1, 2))
    plain: dict[str, Any] = {"color": "black", "linestyle": "-", "linewidth": 0.6, "marker": ""}
    draw_clearance_circle(path, joint.contact.radial, color=QUIET)
    path.plot(table["x_mm"], table["y_mm"], **plain | {"color": ACCENT})
    path.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
    force.plot(table["revolution"], table["normal_force_N"], **plain)
    force.set(xlabel="revolution (-)", ylabel="normal force (N)")
    caption = (
        f"{brief(joint.run.mechanism.name)}, the end of the run. Left: path of the pin's centre "
        "in the bearing, and dashed the circle on which it touches. Right: the normal force."
    )
    largest = {"largest normal force, N": float(table["normal_force_N"].max())}
    return Drawing(figure, table, largest, caption)


# --- films --------------------------------------------------------------------------------------

SIZE_INCHES, DPI = (7.2, 3.2), 90
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
    """Write a film of a run from the revolution `first` on, and return the number of frames.

    The path is that of a .gif file, or of a .mp4 file if ffmpeg is installed. The same run gives
    the same bytes.
    """
    require_film(path)
    count = (run.revolutions - first) * FRAMES_PER_REVOLUTION
    times = (first + np.arange(count) / FRAMES_PER_REVOLUTION) * run.mechanism.period
    path_of = poses(run, times)
    with figure_style(), replacing(path) as temporary:
        figure = Figure(figsize=SIZE_INCHES, layout="constrained")
        scene = _Scene(figure, run, path_of)
        try:
            FuncAnimation(
                figure, scene.draw, path_of, init_func=lambda: None, blit=False
            ).save(
                temporary, writer=writers[WRITERS[path.suffix]](fps=FRAMES_PER_SECOND), dpi=DPI,
                progress_callback=lambda number, _: progress("frames", number, count),
            )  # fmt: skip
        except CalledProcessError as error:
            rule = f"cannot be written (ffmpeg ended with code {error.returncode})"
            raise InputError(str(path), "", None, rule, "make room, or write a .gif") from error
        progress("frames", count, count)
    return count


def require_film(path: Path) -> None:
    """Raise `InputError` if no film can be written to `path`."""
    suffix = require_suffix(path, *WRITERS)
    if not writers.is_available(WRITERS[suffix]):
        raise InputError(
            str(path), "", None, "needs ffmpeg, which is not installed", "write a .gif instead"
        )


class _Scene:
    """The panels of a film, redrawn for every frame: the mechanism, and each clearance."""

    def __init__(self, figure: Figure, run: Trajectory, path: list[Pose]) -> None:
        self.run, self.path = run, path
        joints = list(run.joints.values())
        self.left, *panels = figure.subplots(
            1, 1 + len(joints), squeeze=False, width_ratios=(1.9, *len(joints) * [1.0])
        )[0]
        self.panels = list(zip(panels, joints, map(_scale, joints), strict=True))
        self.view = frame(run.mechanism, path)
        handles = [
            Line2D([], [], label="pin's centre", **CENTRE),
            Line2D([], [], label=f"its path over {TRAIL:g} revolutions", **TRAIL_LINE),
            Line2D([], [], label="force on the bearing", color=ACCENT, linewidth=2.0),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)

    def draw(self, pose: Pose) -> None:
        """Draw one frame."""
        mechanism = self.run.mechanism
        row = int(np.searchsorted(self.run.time, pose.time, side="right")) - 1
        self.left.clear()
        self.left.set_anchor("N")
        set_view(self.left, self.view)
        draw_circle(self.left, mechanism, pose)
        draw_linkage(self.left, mechanism, pose, self.view[1] - self.view[0], self.path)
        about = [
            f"{j.contact.radial:g} mm, {as_label(j.contact.data['law'])}" for _, j, _ in self.panels
        ]
        self.left.set_title(
            f"{', '.join([as_label(mechanism.name), *about[:1]])}: "
            f"revolution {pose.time / mechanism.period:.2f}"
        )
        for axes, joint, scale in self.panels:
            self._draw_joint(axes, joint, scale, pose, row)

    def _draw_joint(
        self, axes: Axes, joint: JointMotion, scale: float, pose: Pose, row: int
    ) -> None:
        """Draw a joint, the recent path of the pin's centre, and the force on the bearing."""
        axes.clear()
        axes.set_anchor("N")
        contact, name = joint.contact, joint.joint.name
        centre = draw_magnified(axes, contact, pose.eccentricity[name])
        draw_clearance_circle(axes, DRAWN, zorder=5)
        begin = pose.time - TRAIL * self.run.mechanism.period
        rows = slice(*np.searchsorted(self.run.time, [begin, pose.time]))
        trail = -DRAWN / contact.radial * 1e3 * joint.eccentricity[rows]
        axes.plot(*trail.T, **TRAIL_LINE, zorder=6)
        axes.plot(*centre, **CENTRE, zorder=7)
        mode = "contact" if joint.in_contact[row] else "flight"
        whose = f"{as_label(name)} " if len(self.panels) > 1 else "clearance "
        axes.set_title(f"{whose}× {magnification(contact):.3g}: {mode}")
        force, e = joint.force[row], joint.eccentricity[row]
        size = float(np.hypot(*force))
        if size == 0.0:
            return
        touch = -e / np.hypot(*e)
        # Very large forces are cut, so that the arrow stays in the panel.
        tip = touch + ARROW * min(size / scale, 1.5) * force / size
        axes.annotate(
            "", xy=tuple(tip), xytext=tuple(touch), zorder=9, annotation_clip=False,
            arrowprops=FORCE,
        )  # fmt: skip


def _scale(joint: JointMotion) -> float:
    """Return the force that an arrow of usual length is for."""
    touching = joint.normal_force[joint.in_contact]
    return float(np.percentile(touching, 99)) if touching.size else 1.0
