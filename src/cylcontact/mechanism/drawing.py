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
from matplotlib.patches import Circle, Polygon, Rectangle
from scipy.spatial import ConvexHull

from cylcontact.files.writing import replacing, require_suffix
from cylcontact.mechanism import ClearanceJoint, JointMotion, Mechanism, Trajectory
from cylcontact.mechanism.model import GROUND, Joint
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.sketch import OUTLINE, POINTER, THIN, Point, polar
from cylcontact.plots.style import ACCENT, QUIET, figure_style
from cylcontact.support.arrays import FloatArray, require
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import as_label, brief
from cylcontact.support.progress import Progress, silent

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

    def at_times(columns: FloatArray) -> FloatArray:
        return np.column_stack([np.interp(times, run.time, column) for column in columns.T])

    data, bodies = run.mechanism.data, run.mechanism.bodies
    places = at_times(run.coordinates.reshape(run.time.size, -1)).reshape(times.size, -1, 3)
    ways = {name: at_times(joint.eccentricity) for name, joint in run.joints.items()}
    ground = {name: _mm(point) for name, point in data["ground"]["points"].items()}
    result = []
    for at, time in enumerate(times):
        points, centres, angles = {"ground": ground}, {}, {}
        for body, (x, y, angle) in zip(bodies, places[at], strict=True):
            centres[body.name], angles[body.name] = _mm((x, y)), float(angle)
            points[body.name] = {
                name: _turned(centres[body.name], angle, _mm(local))
                for name, local in data["bodies"][body.name]["points"].items()
            }
        way = {name: _mm(e[at]) for name, e in ways.items()}
        result.append(Pose(float(time), points, way, centres, angles))
    return result


def _turned(centre: Point, angle: float, local: Point) -> Point:
    """Return a point given in the axes of a body in global axes."""
    at = complex(*centre) + np.exp(1j * angle) * complex(*local)
    return (float(at.real), float(at.imag))


def _mm(point: FloatArray | Point) -> Point:
    """Return a point given in m in mm."""
    return (float(point[0]) * 1e3, float(point[1]) * 1e3)


def _on_ground(joint: Joint) -> Point:
    """Return the place in mm of a joint with the ground."""
    return _mm(joint.point_i if joint.i == GROUND else joint.point_j)


def draw_linkage(
    axes: Axes, mechanism: Mechanism, pose: Pose, size: float, path: Sequence[Pose] = ()
) -> None:
    """Draw a mechanism in a pose, its parts in proportion to its span `size`, all in mm.

    Guides are as long as all the poses of a path need.
    """
    for number, body in enumerate(mechanism.bodies):
        points = list(pose.points[body.name].values())
        fill = FILLS[number % len(FILLS)]
        if len(points) > 1:
            axes.add_patch(_link(points, LINK * size, fill, 2 + number))
        else:
            (x, y), (width, height) = points[0], (share * size for share in BLOCK)
            corner, angle = (x - width / 2, y - height / 2), np.degrees(pose.angles[body.name])
            turned = {"angle": angle, "rotation_point": "center", "zorder": 1.5}
            axes.add_patch(Rectangle(corner, width, height, facecolor=fill, **turned, **OUTLINE))
    for joint in mechanism.joints:
        if joint.kind == "prismatic":
            name = mechanism.bodies[max(joint.i, joint.j)].name
            points = [next(iter(each.points[name].values())) for each in path or [pose]]
            _draw_guide(axes, points, joint, size)
        if joint.kind == "revolute" and GROUND in (joint.i, joint.j):
            _draw_support(axes, _on_ground(joint), SUPPORT * size)
        if joint.kind == "revolute":
            centre = joint_place(mechanism, pose, joint)
            axes.add_patch(Circle(centre, PIN * size, facecolor="white", zorder=8, **OUTLINE))
        if joint.clearance is not None:
            ring = {"fill": False, "edgecolor": ACCENT, "linewidth": 1.4}
            axes.add_patch(Circle(centre, 2.1 * PIN * size, zorder=8, **ring))


def driver_circle(mechanism: Mechanism, pose: Pose) -> tuple[Point, float] | None:
    """Return centre and radius in mm of the circle of the driven body's free end, if any."""
    for drive in [joint for joint in mechanism.joints if joint.kind == "driver"][:1]:
        driven = max(drive.i, drive.j)
        for joint in mechanism.joints:
            if joint.kind == "revolute" and {joint.i, joint.j} == {GROUND, driven}:
                x, y = _on_ground(joint)
                ends = pose.points[mechanism.bodies[driven].name].values()
                return (x, y), max(float(np.hypot(a - x, b - y)) for a, b in ends)
    return None


def _link(points: list[Point], radius: float, fill: str, order: int) -> Polygon:
    """Return a body as a bar, the hull of discs about its points."""
    turn = np.exp(1j * np.linspace(0, 2 * np.pi, 73))
    cloud = np.concatenate([complex(*point) + radius * turn for point in points])
    flat = np.column_stack((cloud.real, cloud.imag))
    corners = flat[ConvexHull(flat).vertices]
    return Polygon(corners, closed=True, facecolor=fill, zorder=order, **OUTLINE)


def _draw_guide(axes: Axes, points: list[Point], joint: Joint, size: float) -> None:
    """Draw the two lines between which a point slides from place to place."""
    # The line goes through the point of the ground; that of the body moves along it.
    along, ground = complex(np.exp(1j * joint.direction)), complex(*_on_ground(joint))
    travel = [((complex(*point) - ground) * along.conjugate()).real for point in points]
    ends = np.array([min(travel) - GUIDE * size, max(travel) + GUIDE * size])
    for side in (1, -1):
        rail = ground + side * 0.5 * BLOCK[1] * size * 1j * along + ends * along
        axes.plot(rail.real, rail.imag, **THIN | {"linewidth": 0.9})


def _draw_support(axes: Axes, at: Point, half: float) -> None:
    """Draw a hatched triangle below a point of the ground."""
    x, y = at
    below, left, right = y - 1.5 * half, x - 1.5 * half, x + 1.5 * half
    corners = [at, (x - half, below), (x + half, below)]
    axes.add_patch(Polygon(corners, facecolor="white", zorder=1, **OUTLINE))
    strip = Rectangle((left, below - 0.5 * half), 3 * half, 0.5 * half)
    strip.set(facecolor="none", edgecolor="black", hatch="/////", linewidth=0.0)
    axes.add_patch(strip)
    axes.plot([left, right], [below, below], **THIN | {"linewidth": 0.9})


def joint_place(mechanism: Mechanism, pose: Pose, joint: Joint) -> Point:
    """Return the position of a joint in mm, from the point of its first moving body."""
    body, local = (joint.j, joint.point_j) if joint.i == GROUND else (joint.i, joint.point_i)
    name = mechanism.bodies[body].name
    return _turned(pose.centres[name], pose.angles[name], _mm(local))


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
    centre, radius = circle
    dashed = {"fill": False, "edgecolor": "0.5", "linewidth": 0.6, "linestyle": (0, (4, 3))}
    axes.add_patch(Circle(centre, radius, zorder=0.5, **dashed))
    sense = next(j.speed or j.torque for j in mechanism.joints if j.kind == "driver")
    start, end = (polar(radius, degrees, centre) for degrees in (118, 142)[:: int(np.sign(sense))])
    # The control point of an arc is half the tangent of half its angle away, in chords.
    bend = 0.5 * np.tan(np.radians(12.0)) * np.sign(sense)
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
    dashed = {"fill": False, "edgecolor": "black", "linewidth": 0.7, "linestyle": (0, (5, 3))}
    axes.add_patch(Circle((0, 0), radius, **dashed | style))


@figure_style()
def joint_drawing(joint: JointMotion, revolutions: float = 2.0) -> Drawing:
    """Draw the end of a run; see `Trajectory.plot`."""
    require(revolutions > 0, "plot", "revolutions", revolutions, "must be positive", "give e.g. 2")
    revolution = joint.run.revolution
    last = revolution >= revolution[-1] - revolutions
    x, y = -1e3 * joint.eccentricity[last].T
    table = pd.DataFrame({"revolution": revolution[last], "x_mm": x, "y_mm": y})
    table["normal_force_N"] = joint.normal_force[last]
    figure = new_figure("page", 70.0)
    path, force = figure.subplots(1, 2, width_ratios=(1, 2))
    plain: dict[str, Any] = {"linestyle": "-", "linewidth": 0.6, "marker": ""}
    draw_clearance_circle(path, joint.contact.radial, edgecolor=QUIET)
    path.plot(x, y, color=ACCENT, **plain)
    path.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
    force.plot(table["revolution"], table["normal_force_N"], color="black", **plain)
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
    "mfc": "black",
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
    view = frame(run.mechanism, path_of)
    with figure_style(), replacing(path) as temporary:
        figure = Figure(figsize=SIZE_INCHES, layout="constrained")
        left, *panels = figure.subplots(
            1, 1 + len(run.joints), squeeze=False, width_ratios=(1.9, *len(run.joints) * [1.0])
        )[0]
        handles = [
            Line2D([], [], label="pin's centre", **CENTRE),
            Line2D([], [], label=f"its path over {TRAIL:g} revolutions", **TRAIL_LINE),
            Line2D([], [], label="force on the bearing", color=ACCENT, linewidth=2.0),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)

        def draw(pose: Pose) -> None:
            _draw_mechanism(left, run, pose, view, path_of)
            for axes, joint in zip(panels, run.joints.values(), strict=True):
                _draw_joint(axes, joint, pose)

        animation = FuncAnimation(figure, draw, path_of, init_func=lambda: None, blit=False)
        writer = writers[WRITERS[path.suffix]](fps=FRAMES_PER_SECOND)
        try:
            animation.save(
                temporary, writer, dpi=DPI,
                progress_callback=lambda number, _: progress("frames", number, count),
            )  # fmt: skip
        except CalledProcessError as error:
            rule = f"cannot be written (ffmpeg ended with code {error.returncode})"
            raise InputError(str(path), "", None, rule, "make room, or write a .gif") from error
        progress("frames", count, count)
    return count


def require_film(path: Path) -> None:
    """Raise `InputError` if no film can be written to `path`."""
    known = writers.is_available(WRITERS[require_suffix(path, *WRITERS)])
    rule = "needs ffmpeg, which is not installed"
    require(known, str(path), "", None, rule, "write a .gif instead")


def _draw_mechanism(
    axes: Axes,
    run: Trajectory,
    pose: Pose,
    view: tuple[float, float, float, float],
    path: list[Pose],
) -> None:
    """Draw the mechanism in a frame of a film, with what it is as the title."""
    axes.clear()
    axes.set_anchor("N")
    set_view(axes, view)
    draw_circle(axes, run.mechanism, pose)
    draw_linkage(axes, run.mechanism, pose, view[1] - view[0], path)
    about = [as_label(run.mechanism.name)]
    for joint in list(run.joints.values())[:1]:
        about.append(f"{joint.contact.radial:g} mm, {as_label(joint.contact.data['law'])}")
    revolution = pose.time / run.mechanism.period
    axes.set_title(f"{', '.join(about)}: revolution {revolution:.2f}")


def _draw_joint(axes: Axes, joint: JointMotion, pose: Pose) -> None:
    """Draw a joint, the recent path of the pin's centre, and the force on the bearing."""
    axes.clear()
    axes.set_anchor("N")
    contact, name, motion = joint.contact, joint.joint.name, joint.run
    centre = draw_magnified(axes, contact, pose.eccentricity[name])
    draw_clearance_circle(axes, DRAWN, zorder=5)
    begin = pose.time - TRAIL * motion.mechanism.period
    rows = slice(*np.searchsorted(motion.time, [begin, pose.time]))
    trail = -DRAWN / contact.radial * 1e3 * joint.eccentricity[rows]
    axes.plot(*trail.T, **TRAIL_LINE, zorder=6)
    axes.plot(*centre, **CENTRE, zorder=7)
    row = int(np.searchsorted(motion.time, pose.time, side="right")) - 1
    mode = "contact" if joint.in_contact[row] else "flight"
    whose = as_label(name) if len(motion.mechanism.clearances) > 1 else "clearance"
    axes.set_title(f"{whose} × {magnification(contact):.3g}: {mode}")
    force, e = joint.force[row], joint.eccentricity[row]
    size = float(np.hypot(*force))
    if size > 0.0:
        usual = np.percentile(joint.normal_force[joint.in_contact], 99)
        touch = -e / np.hypot(*e)
        # Very large forces are cut, so that the arrow stays in the panel.
        tip = touch + ARROW * min(size / usual, 1.5) * force / size
        ends = {"xy": tuple(tip), "xytext": tuple(touch)}
        axes.annotate("", **ends, zorder=9, annotation_clip=False, arrowprops=FORCE)
