"""The mechanism beside its joint, the clearance magnified: Fig 16."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.mechanism import Mechanism, Trajectory
from cylcontact.plots.figure import new_figure, panel_title
from cylcontact.plots.style import small_text
from cylcontact.reports.mechanism.linkage import (
    CIRCLE,
    Pose,
    draw_linkage,
    driver_circle,
    joint_place,
    poses,
    span,
)
from cylcontact.reports.mechanism.magnified import (
    DRAWN,
    Magnified,
    draw_clearance_circle,
    draw_magnified,
)
from cylcontact.reports.sketch import POINTER, cross

# Beyond the points' span, along x and along y, in shares of that along x.
MARGINS = (0.12, 0.08)
# The clearance joint's panel against that of the mechanism.
WIDTHS = (2.45, 1.0)
CENTRE: dict[str, Any] = {
    "marker": ".",
    "color": "black",
    "markerfacecolor": "black",
    "zorder": 9,
}


def draw_overview(run: Trajectory, revolution: float) -> tuple[Figure, Pose, Magnified]:
    """Draw a mechanism at the first step of a run from some time on, its joint beside it.

    Parameters
    ----------
    run : Trajectory
        The run.
    revolution : float
        The time in revolutions of the driver.

    Returns
    -------
    figure : matplotlib.figure.Figure
    pose : Pose
        What is drawn.
    joint : Magnified
        How the joint is drawn.
    """
    one = run.mechanism
    row = int(np.searchsorted(run.revolution, revolution))
    (pose,) = poses(run, run.time[row : row + 1])
    joint = Magnified.of(one)
    figure = new_figure("full", 62.0, wide=True)
    left, right = figure.subplots(1, 2, width_ratios=WIDTHS)
    view = frame(one, [pose])
    set_view(left, view)
    draw_linkage(left, one, pose, view[1] - view[0])
    draw_circle(left, one, pose)
    _name_points(left, one, pose)
    panel_title(left, 0, one.name)
    centre = draw_magnified(right, joint, pose.eccentricity)
    draw_clearance_circle(right, DRAWN, zorder=5)
    for at in ((0.0, 0.0), centre):
        cross(right, at, zorder=6)
    panel_title(right, 1, f"its joint, clearance × {joint.factor:g}")
    return figure, pose, joint


def frame(one: Mechanism, path: list[Pose]) -> tuple[float, float, float, float]:
    """Return a view of the mechanism in some poses, in mm: left, right, bottom, top."""
    left, right, low, high = span(path)
    for pose in path[:1]:
        circle = driver_circle(one, pose)
        if circle is not None:
            (x, y), radius = circle
            left, right = min(left, x - radius), max(right, x + radius)
            low, high = min(low, y - radius), max(high, y + radius)
    across, along = (share * (right - left) for share in MARGINS)
    return left - across, right + across, low - along, high + along


def set_view(axes: Axes, view: tuple[float, float, float, float]) -> None:
    """Show a view to scale, without axes."""
    axes.set(xlim=view[:2], ylim=view[2:], aspect="equal")
    axes.set_axis_off()


def point_table(pose: Pose) -> pd.DataFrame:
    """Return all named points of a pose.

    Returns
    -------
    pandas.DataFrame
        Columns body, point, x_mm, y_mm; the ground comes first.
    """
    rows = [
        {"body": body, "point": point, "x_mm": x, "y_mm": y}
        for body, points in pose.points.items()
        for point, (x, y) in points.items()
    ]
    return pd.DataFrame(rows)


def draw_circle(axes: Axes, one: Mechanism, pose: Pose) -> None:
    """Draw the driver's circle and which way it turns."""
    from matplotlib.patches import Circle

    found = driver_circle(one, pose)
    if found is None:
        return
    (x, y), radius = found
    axes.add_patch(Circle((x, y), radius, zorder=0.5, **CIRCLE))
    turn = np.radians(np.array([118.0, 142.0])[:: int(np.sign(one.driver.speed)) or 1])
    start, end = (
        (float(x + radius * np.cos(angle)), float(y + radius * np.sin(angle))) for angle in turn
    )
    bend = 0.2 * np.sign(one.driver.speed)
    arrow = POINTER | {"connectionstyle": f"arc3,rad={bend:g}", "zorder": 1, "linewidth": 0.9}
    axes.annotate("", xy=end, xytext=start, arrowprops=arrow)


def _name_points(axes: Axes, one: Mechanism, pose: Pose) -> None:
    """Name bodies and revolute joints, and mark the centres of mass."""
    for body in one.bodies:
        places = np.array(list(pose.points[body.name].values()))
        middle = complex(*pose.centres[body.name])
        axes.plot(middle.real, middle.imag, **CENTRE)
        along = complex(*(places[-1] - places[0])) if len(places) > 1 else 1.0
        up = 1j * along / abs(along)
        _name(axes, body.name, middle, up if up.imag >= 0 else -up, 19 if len(places) > 1 else 22)
    for joint in one.joints:
        if joint.kind == "revolute":
            at = complex(*joint_place(one, pose, joint))
            way = 1j if -1 in (joint.i, joint.j) else -1j
            _name(axes, joint.name, at, way, 19, fontsize=small_text(), color="0.3")


def _name(axes: Axes, text: str, at: complex, way: complex, distance: float, **style: Any) -> None:
    """Write a name so many points away from what it names."""
    axes.annotate(
        text,
        xy=(at.real, at.imag),
        xytext=(distance * way.real, distance * way.imag),
        textcoords="offset points",
        ha="center",
        va="center",
        zorder=10,
        **style,
    )
