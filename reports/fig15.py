"""Fig 15: the joint with clearance, drawn to its definition from a step of a simulation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from cylcontact.mechanism import Trajectory, simulate
from cylcontact.mechanism.drawing import (
    BEARING,
    DRAWN,
    JOURNAL,
    RIM,
    draw_clearance_circle,
)
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.sketch import ARROW, OUTLINE, POINTER, THIN, Point, cross
from cylcontact.plots.style import ACCENT, small_text
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

from .slider_crank import assumed, mechanism

REVOLUTION = 1.1
CAPTION = (
    "Joint with clearance: bearing of body i (centre P_i, radius R_i = {R_i:g} mm), journal of "
    "body j (P_j, R_j), eccentricity e, clearance c = R_i - R_j (dashed circle), penetration δ = "
    "|e| - c, normal n, tangent t; orange: forces on the bearing. Not to scale: c is magnified "
    "{scale:g} times against the radii, δ {depth:.0f} times."
)
METHOD = (
    "Eqs 11 to 14: e = r_i - r_j points from the journal's centre to the bearing's; contact begins "
    "where it leaves the dashed circle. At the contact n = e/|e| and t = [n_y, -n_x]; the bearing "
    "takes f_i = -f_n n + f_t t, the journal the opposite. Directions are those of the "
    "slider-crank (enhanced law) {revolution:.2f} revolutions after the start, with R_i = {R_i:g} "
    "mm, R_j = {R_j:g} mm, c = {c:g} mm, δ = {delta:.3g} µm, f_n = {f_n:.0f} N and f_t = {f_t:.0f} "
    "N. {assumed}"
)
# The penetration as drawn and the global origin, in radii of the bearing.
DRAWN_PENETRATION = 0.07
ORIGIN = (-1.75, -1.3)
FORCE = ARROW | {
    "arrowstyle": "-|>",
    "mutation_scale": 8,
    "linewidth": 1.5,
    "facecolor": ACCENT,
    "edgecolor": ACCENT,
    "zorder": 9,
}
UNIT = POINTER | {"mutation_scale": 7, "linewidth": 1.0, "zorder": 9}


def draw(bench: Bench) -> Drawing:
    slider_crank = mechanism(bench)
    joint = _joint_at(simulate(slider_crank, revolutions=2), REVOLUTION)
    table = _table(joint)
    lengths = table.set_index("symbol")
    scale = lengths["drawn_mm"] / lengths["value_mm"]
    headline = {
        "eccentricity, mm": joint.eccentricity,
        "penetration, um": 1e3 * joint.penetration,
        "normal force, N": joint.normal_force,
        "friction force, N": joint.friction_force,
        "tangential velocity, m/s": joint.tangential_velocity,
    }
    caption = CAPTION.format(R_i=joint.R_i, scale=scale["c"], depth=scale["delta"])
    method = METHOD.format(
        R_i=joint.R_i,
        R_j=joint.R_j,
        c=joint.clearance,
        delta=1e3 * joint.penetration,
        f_n=joint.normal_force,
        f_t=joint.friction_force,
        revolution=joint.revolution,
        assumed=assumed(slider_crank),
    )
    return Drawing(_draw_joint(joint), table, headline, caption, method)


@dataclass(frozen=True)
class JointState:
    """The joint at one step of a run in contact: lengths in mm, forces in N, angles in rad."""

    R_i: float
    R_j: float
    clearance: float
    penetration: float
    normal: FloatArray
    normal_force: float
    friction_force: float
    tangential_velocity: float
    arm: float  # the direction of the bearing's body
    revolution: float

    @property
    def eccentricity(self) -> float:
        """|e| = c + δ in mm (Eq 12)."""
        return self.clearance + self.penetration


def _joint_at(run: Trajectory, revolution: float) -> JointState:
    """Return the joint at the first step in contact after a revolution of the driver."""
    joint, contact = run.mechanism.clearance, run.joint.contact
    sliding = run.in_contact & (run.penetration > 0)
    row = int(np.flatnonzero(sliding & (run.revolution >= revolution))[0])
    e = run.eccentricity[row] * 1e3
    other = run.coordinates[row, joint.i, :2] - run.point(joint.i, joint.point_i)[0][row]
    return JointState(
        R_i=float(np.asarray(contact.pair.R_i)),
        R_j=float(np.asarray(contact.pair.R_j)),
        clearance=contact.radial,
        penetration=float(run.penetration[row]) * 1e3,
        normal=e / np.hypot(*e),
        normal_force=float(run.normal_force[row]),
        friction_force=float(run.friction_force[row]),
        tangential_velocity=float(run.tangential_velocity[row]),
        arm=float(np.arctan2(other[1], other[0])),
        revolution=float(run.revolution[row]),
    )


def _table(joint: JointState) -> pd.DataFrame:
    """Return the lengths as they are and as drawn."""
    scale = joint.R_i
    rows = {
        "R_i": (joint.R_i, scale),
        "R_j": (joint.R_j, (1 - DRAWN) * scale),
        "c": (joint.clearance, DRAWN * scale),
        "delta": (joint.penetration, DRAWN_PENETRATION * scale),
        "|e|": (joint.eccentricity, (DRAWN + DRAWN_PENETRATION) * scale),
    }
    values, drawn = zip(*rows.values(), strict=True)
    return pd.DataFrame({"symbol": list(rows), "value_mm": values, "drawn_mm": drawn})


def _draw_joint(joint: JointState) -> Figure:
    """Draw bearing, journal, eccentricity, penetration, and the contact's directions and forces."""
    figure = new_figure("column", 64.0)
    axes = figure.subplots()
    n, distance = joint.normal, DRAWN + DRAWN_PENETRATION
    journal = _point(-distance * n)
    _draw_bodies(axes, joint, journal)
    draw_clearance_circle(axes, DRAWN, zorder=6)
    _draw_vectors(axes, n, journal)
    _draw_contact(axes, joint, n)
    _draw_origin(axes, journal)
    axes.set(xlim=(-1.95, 1.75), ylim=(-1.42, 1.38), aspect="equal")
    axes.set_axis_off()
    return figure


def _point(place: FloatArray) -> Point:
    return (float(place[0]), float(place[1]))


def _draw_bodies(axes: Axes, joint: JointState, journal: Point) -> None:
    """Draw the bearing's ring with the start of its arm, and the journal."""
    along = np.exp(1j * joint.arm)
    sides = [
        complex(*pair) * along for pair in ((1.0, 0.45), (1.75, 0.4), (1.75, -0.4), (1.0, -0.45))
    ]
    corners = [(z.real, z.imag) for z in sides]
    axes.add_patch(Polygon(corners, closed=False, facecolor=BEARING, zorder=1, **OUTLINE))
    axes.add_patch(Circle((0, 0), RIM, facecolor=BEARING, zorder=0.9, **OUTLINE))
    axes.add_patch(Circle((0, 0), RIM - 0.01, facecolor=BEARING, linewidth=0, zorder=1))
    axes.add_patch(Circle((0, 0), 1.0, facecolor="white", zorder=2, **OUTLINE))
    axes.add_patch(Circle(journal, 1 - DRAWN, facecolor=JOURNAL, zorder=3, **OUTLINE))
    # The bearing's surface through the overlap.
    axes.add_patch(
        Circle((0, 0), 1.0, fill=False, linestyle=(0, (2, 1.5)), linewidth=0.6, zorder=4)
    )
    axes.text(
        journal[0], journal[1] - 0.55, "body $j$", ha="center", zorder=9, fontsize=small_text()
    )
    body = _point(1.45 * np.array([along.real, along.imag]))
    axes.text(*body, "body $i$", ha="center", va="center", zorder=9, fontsize=small_text())


def _draw_vectors(axes: Axes, n: FloatArray, journal: Point) -> None:
    """Draw e from the journal's centre to the bearing's, the clearance and both radii."""
    cross(axes, (0.0, 0.0), zorder=8)
    cross(axes, journal, zorder=8)
    side = np.array([-n[1], n[0]])
    axes.annotate("", xy=(0, 0), xytext=journal, arrowprops=UNIT)
    _label(axes, 0.45 * np.array(journal) - 0.11 * side, r"$\vec{e}$")
    _label(axes, 0.13 * n - 0.15 * side, "$P_i$")
    _label(axes, np.array(journal) - 0.12 * n - 0.1 * side, "$P_j$")
    _radius(axes, np.zeros(2), n, 15.0, DRAWN, "$c$", 0.6)
    _radius(axes, np.zeros(2), n, -112.0, 1.0, "$R_i$", 0.78)
    _radius(axes, np.array(journal), n, 100.0, 1 - DRAWN, "$R_j$", 0.62)


def _label(axes: Axes, at: FloatArray, text: str) -> None:
    axes.text(*_point(at), text, ha="center", va="center", zorder=10)


def _radius(
    axes: Axes, centre: FloatArray, n: FloatArray, turn: float, length: float, text: str, at: float
) -> None:
    """Draw a radius, its direction turned from n by so many degrees."""
    angle = np.radians(turn)
    way = np.array(
        [n[0] * np.cos(angle) - n[1] * np.sin(angle), n[0] * np.sin(angle) + n[1] * np.cos(angle)]
    )
    axes.annotate(
        "",
        xy=_point(centre + length * way),
        xytext=_point(centre),
        arrowprops=POINTER | {"zorder": 8},
    )
    _label(axes, centre + at * length * way + 0.1 * np.array([-way[1], way[0]]), text)


def _draw_contact(axes: Axes, joint: JointState, n: FloatArray) -> None:
    """Draw n and t at the contact, the forces on the bearing, and the penetration."""
    t, contact = np.array([n[1], -n[0]]), -n
    for way, text, aside in ((n, r"$\vec{n}$", 0.1 * t), (t, r"$\vec{t}$", 0.15 * n)):
        axes.annotate("", xy=_point(contact + 0.34 * way), xytext=_point(contact), arrowprops=UNIT)
        _label(axes, contact + 0.3 * way + aside, text)
    sign = float(np.sign(joint.friction_force))
    ends = (
        (-n, 0.5, r"$-f_n\,\vec{n}$", -0.14 * t),
        (sign * t, 0.42, r"$f_t\,\vec{t}$", 0.19 * n),
    )
    for way, length, text, aside in ends:
        axes.annotate(
            "", xy=_point(contact + length * way), xytext=_point(contact), arrowprops=FORCE
        )
        _label(axes, contact + 0.9 * length * way + aside, text)
    _draw_penetration(axes, n, t)


def _draw_penetration(axes: Axes, n: FloatArray, t: FloatArray) -> None:
    """Measure the overlap beside the contact; it is too narrow for arrows inside."""
    for depth, outward in ((1.0, 1.0), (1.0 + DRAWN_PENETRATION, -1.0)):
        foot = -depth * n
        ends = np.array([foot, foot + 0.72 * t])
        axes.plot(*ends.T, **THIN, zorder=9)
        tip = foot + 0.66 * t
        tail = _point(tip + outward * 0.17 * n)
        axes.annotate("", xy=_point(tip), xytext=tail, arrowprops=POINTER | {"zorder": 9})
    _label(axes, -(1.0 + 0.5 * DRAWN_PENETRATION) * n + 0.81 * t, r"$\delta$")


def _draw_origin(axes: Axes, journal: Point) -> None:
    """Draw the global axes and both position vectors of Eq 11."""
    x, y = ORIGIN
    for dx, dy, text in ((0.3, 0.0, "$x$"), (0.0, 0.3, "$y$")):
        axes.annotate("", xy=(x + dx, y + dy), xytext=ORIGIN, arrowprops=POINTER)
        axes.text(x + 1.3 * dx, y + 1.3 * dy, text, ha="center", va="center")
    thin = POINTER | {"linewidth": 0.5, "linestyle": (0, (4, 2)), "zorder": 7}
    ends = (((0.0, 0.0), r"$\vec{r}_i$", 0.12), (journal, r"$\vec{r}_j$", -0.12))
    for end, text, aside in ends:
        axes.annotate("", xy=end, xytext=ORIGIN, arrowprops=thin)
        way = np.subtract(end, ORIGIN)
        normal = np.array([-way[1], way[0]]) / np.hypot(*way)
        _label(axes, np.array(ORIGIN) + 0.2 * way + aside * normal, text)
