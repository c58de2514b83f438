"""Fig 16: the slider-crank, drawn from its spec in a configuration that a simulation gives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.mechanism import ClearanceJoint, Mechanism, simulate
from cylcontact.mechanism.drawing import (
    DRAWN,
    Pose,
    draw_circle,
    draw_clearance_circle,
    draw_linkage,
    draw_magnified,
    frame,
    joint_place,
    magnification,
    poses,
    set_view,
)
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.sketch import cross
from cylcontact.plots.style import small_text
from cylcontact.reports.bench import Bench

from .slider_crank import assumed, mechanism

REVOLUTION = 1.15
CAPTION = (
    "(a) The slider-crank to scale, {revolution:g} revolutions after the start, with the names of "
    "its input file (grey: joints); dots: centres of mass; dashed: circle of the crank pin; "
    "orange: the joint with clearance. (b) This joint, its clearance of {c:g} mm magnified "
    "{scale:g} times against the bearing's radius of {R_i:g} mm; dashed: clearance circle. "
    "Lengths and masses are assumed."
)
METHOD = (
    "The mechanism is that of datasets/slider_crank.toml: {bodies}; the crank turns at "
    "{speed:.0f} rpm, {sense}. All joints are ideal but the one between {bearing} (with the "
    "bearing) and {journal} (with the journal). Crosses mark the centres of both. {assumed}"
)
CENTRE: dict[str, Any] = {
    "marker": ".",
    "color": "black",
    "markerfacecolor": "black",
    "zorder": 9,
}


def draw(bench: Bench) -> Drawing:
    slider_crank = mechanism(bench)
    run = simulate(slider_crank, revolutions=2)
    row = int(np.searchsorted(run.revolution, REVOLUTION))
    (pose,) = poses(run, run.time[row : row + 1])
    joint = slider_crank.clearance.contact
    crank_pin = pose.points["crank"]["pin"]
    (eccentricity,) = pose.eccentricity.values()
    headline = {
        "radius of the crank circle, mm": float(np.hypot(*crank_pin)),
        "eccentricity, mm": float(np.hypot(*eccentricity)),
        "magnification of the clearance, -": magnification(joint),
    }
    bodies, clearance = slider_crank.bodies, slider_crank.clearance
    caption = CAPTION.format(
        revolution=REVOLUTION,
        c=joint.radial,
        scale=magnification(joint),
        R_i=float(np.asarray(joint.pair.R_i)),
    )
    method = METHOD.format(
        bodies=", ".join(body.name for body in bodies),
        speed=60 / slider_crank.period,
        sense="clockwise" if slider_crank.driver.speed < 0 else "anticlockwise",
        bearing=bodies[clearance.i].name,
        journal=bodies[clearance.j].name,
        assumed=assumed(slider_crank),
    )
    figure = _draw_panels(slider_crank, pose, joint)
    return Drawing(figure, _points(pose), headline, caption, method)


def _points(pose: Pose) -> pd.DataFrame:
    """Return all named points of a pose; the ground comes first."""
    rows = [
        {"body": body, "point": point, "x_mm": x, "y_mm": y}
        for body, points in pose.points.items()
        for point, (x, y) in points.items()
    ]
    return pd.DataFrame(rows)


def _draw_panels(slider_crank: Mechanism, pose: Pose, joint: ClearanceJoint) -> Figure:
    """Draw the mechanism, and beside it its joint, equally high."""
    view = frame(slider_crank, [pose])
    figure = new_figure("full", 56.0)
    ratio = (view[1] - view[0]) / (view[3] - view[2])
    left, right = figure.subplots(1, 2, width_ratios=(ratio, 1.0))
    set_view(left, view)
    draw_linkage(left, slider_crank, pose, view[1] - view[0])
    draw_circle(left, slider_crank, pose)
    _name_points(left, slider_crank, pose)
    panel_title(left, 0, slider_crank.name)
    (eccentricity,) = pose.eccentricity.values()
    centre = draw_magnified(right, joint, eccentricity)
    draw_clearance_circle(right, DRAWN, zorder=5)
    for at in ((0.0, 0.0), centre):
        cross(right, at, zorder=6)
    clearance, names = slider_crank.clearance, [body.name for body in slider_crank.bodies]
    way = np.array(centre) / np.hypot(*centre)
    for place, name in (
        (centre + 0.38 * way, f"journal\n({names[clearance.j]})"),
        (-0.7 * way, f"bearing\n({names[clearance.i]})"),
    ):
        x, y = place
        right.text(x, y, name, ha="center", va="center", zorder=9, fontsize=small_text())
    panel_title(right, 1, f"joint with clearance, × {magnification(joint):g}")
    for axes in (left, right):
        axes.set_anchor("W")
    return figure


def _name_points(axes: Axes, slider_crank: Mechanism, pose: Pose) -> None:
    """Name bodies and revolute joints, and mark the centres of mass."""
    for body in slider_crank.bodies:
        places = np.array(list(pose.points[body.name].values()))
        middle = complex(*pose.centres[body.name])
        axes.plot(middle.real, middle.imag, **CENTRE)
        along = complex(*(places[-1] - places[0])) if len(places) > 1 else 1.0
        up = 1j * along / abs(along)
        _name(axes, body.name, middle, up if up.imag >= 0 else -up, 19 if len(places) > 1 else 22)
    for joint in slider_crank.joints:
        if joint.kind == "revolute":
            at = complex(*joint_place(slider_crank, pose, joint))
            way = 1j if -1 in (joint.i, joint.j) else -1j
            _name(axes, joint.name, at, way, 19, fontsize=small_text(), color="0.3")


def _name(axes: Axes, text: str, at: complex, way: complex, distance: float, **style: Any) -> None:
    """Write a name at a distance from what it names, in points at the journal's font size."""
    distance *= rcParams["font.size"] / 8
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
