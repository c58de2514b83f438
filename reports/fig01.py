"""Fig 1: the geometry of internal and external contact and of the contact strip, drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from cylcontact.bodies.pair import Contact
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.sketch import (
    ARROW,
    OUTLINE,
    POINTER,
    THIN,
    Point,
    cross,
    dimension,
    polar,
    radius,
)
from cylcontact.plots.style import ACCENT
from cylcontact.reports.bench import Bench

BODY_I, BODY_J, STRIP = "0.80", "0.93", "#f6bb84"
FORCE = ARROW | {
    "arrowstyle": "-|>",
    "mutation_scale": 9,
    "linewidth": 1.6,
    "facecolor": ACCENT,
    "edgecolor": ACCENT,
}
# The limits of each panel in units of the radii: left, right, bottom and top.
VIEWS = ((-12.9, 13.3, -17.0, 13.6), (-10.0, 14.0, -11.0, 19.6), (-5.0, 18.5, -9.0, 21.6))
CAPTION = (
    "Symbols. (a) A pin of radius R_j in a hole of radius R_i, ΔR = R_i - R_j, under the load f "
    "per unit length; dashed: the pin concentric with the hole. (b) Two rollers, "
    "ΔR = R_i + R_j. (c) The contact strip of length L and width 2b under Hertz's "
    "pressure. The penetration δ is exaggerated."
)
METHOD = (
    "The centres are ΔR + δ apart in (a) and ΔR - δ apart in (b). The penetration is drawn as the "
    "overlap of the undeformed outlines. Both it and the strip's width are exaggerated. The "
    "table has the lengths as drawn, in mm."
)


def draw(_bench: Bench) -> Drawing:
    table = pd.concat([_lengths(INTERNAL), _lengths(EXTERNAL)], ignore_index=True)
    headline = {
        f"{pair.contact} {name}": value
        for pair in (INTERNAL, EXTERNAL)
        for name, value in (("dR, mm", pair.dR), ("centre distance, mm", pair.centre_distance))
    }
    return Drawing(_draw_panels(), table, headline, CAPTION, METHOD)


@dataclass(frozen=True)
class DrawnPair:
    """Two cylinders as drawn, in any unit of length, body *i* centred at the origin."""

    contact: Contact
    R_i: float
    R_j: float
    penetration: float

    @property
    def dR(self) -> float:
        """R_i − R_j for internal contact, R_i + R_j for external contact."""
        return self.R_i - self.R_j if self.contact == "internal" else self.R_i + self.R_j

    @property
    def centre_distance(self) -> float:
        """The distance of the axes: ΔR + δ for internal contact, ΔR − δ for external contact."""
        sign = 1.0 if self.contact == "internal" else -1.0
        return self.dR + sign * self.penetration

    @property
    def centre(self) -> Point:
        """The axis of body *j*: below that of the hole, above that of the other roller."""
        return (0.0, -self.centre_distance if self.contact == "internal" else self.centre_distance)

    @property
    def chord(self) -> float:
        """The height of the chord on which the undeformed outlines meet."""
        y = self.centre[1]
        return (y**2 + self.R_i**2 - self.R_j**2) / (2 * y)

    @property
    def half_width(self) -> float:
        """Half the length of that chord, drawn as half the width of the contact strip."""
        return float(np.sqrt(self.R_i**2 - self.chord**2))


INTERNAL = DrawnPair("internal", R_i=10.0, R_j=7.0, penetration=0.6)
EXTERNAL = DrawnPair("external", R_i=6.0, R_j=4.5, penetration=0.6)


def _lengths(pair: DrawnPair) -> pd.DataFrame:
    """Return the lengths of one panel."""
    lengths = {
        "R_i": pair.R_i,
        "R_j": pair.R_j,
        "dR": pair.dR,
        "delta": pair.penetration,
        "centre distance": pair.centre_distance,
        "2b": 2 * pair.half_width,
    }
    return pd.DataFrame(
        {"panel": pair.contact, "symbol": lengths.keys(), "value_mm": lengths.values()}
    )


def _draw_panels() -> Figure:
    """Draw both contacts and their contact strip."""
    figure = new_figure("full", 72.0)
    widths = [right - left for left, right, _, _ in VIEWS]
    panels = list(figure.subplots(1, 3, width_ratios=widths))
    titles = ("internal contact", "external contact", "contact strip")
    for number, (axes, view, title) in enumerate(zip(panels, VIEWS, titles, strict=True)):
        axes.set(xlim=view[:2], ylim=view[2:], aspect="equal")
        axes.set_axis_off()
        panel_title(axes, number, title)
    _draw_internal(panels[0], INTERNAL)
    _draw_external(panels[1], EXTERNAL)
    _draw_strip(panels[2], half_width=3.0, length=16.0)
    return figure


def _draw_internal(axes: Axes, pair: DrawnPair) -> None:
    """Draw a pin pressed down into its hole."""
    centre = pair.centre
    axes.add_patch(Circle((0, 0), pair.R_i + 2.5, facecolor=BODY_I, **OUTLINE))
    axes.add_patch(Circle((0, 0), pair.R_i, facecolor="white", **OUTLINE))
    axes.add_patch(Circle(centre, pair.R_j, facecolor=BODY_J, **OUTLINE))
    _draw_overlap(axes, pair)
    # The pin with its axis on the hole's.
    axes.add_patch(Circle((0, 0), pair.R_j, fill=False, linestyle=(0, (4, 3)), linewidth=0.6))
    cross(axes, (0.0, 0.0))
    cross(axes, centre)
    radius(axes, (0.0, 0.0), pair.R_i, 158, "$R_i$", (0.2, 1.5))
    radius(axes, centre, pair.R_j, 12, "$R_j$", (0.5, 1.0))
    dimension(axes, polar(pair.R_j, 62), polar(pair.R_i, 62), r"$\Delta R$", (-1.9, 0.3))
    bottom = -pair.R_i - pair.penetration
    _small_dimension(axes, -pair.R_i, bottom, x_from=0.0, x_to=9.0, label=r"$\delta$")
    ends = ((-pair.half_width, pair.chord), (pair.half_width, pair.chord))
    dimension(axes, *ends, "$2b$", (-2.2, 0.8))
    _force(axes, (0.0, centre[1] - 0.2), (0.0, centre[1] - 4.2))
    _force(axes, (0.0, -pair.R_i - 6.5), (0.0, -pair.R_i - 2.6))


def _draw_overlap(axes: Axes, pair: DrawnPair) -> None:
    """Fill the overlap of the undeformed outlines."""
    x = np.linspace(-pair.half_width, pair.half_width, 201)
    outline_i = np.copysign(np.sqrt(pair.R_i**2 - x**2), pair.chord)
    outline_j = pair.centre[1] - np.sqrt(pair.R_j**2 - x**2)
    axes.fill_between(x, outline_i, outline_j, color=STRIP, linewidth=0)


def _small_dimension(
    axes: Axes, upper: float, lower: float, x_from: float, x_to: float, label: str
) -> None:
    """Draw a vertical dimension too small for its arrows, which point at it from outside."""
    for y in (upper, lower):
        axes.plot([x_from, x_to], [y, y], **THIN)
    x = x_to - np.sign(x_to) * 0.5
    axes.annotate("", xy=(x, upper), xytext=(x, upper + 2.0), arrowprops=POINTER)
    axes.annotate("", xy=(x, lower), xytext=(x, lower - 2.0), arrowprops=POINTER)
    axes.text(x_to + np.sign(x_to) * 0.9, (upper + lower) / 2, label, ha="center", va="center")


def _force(axes: Axes, start: Point, end: Point) -> None:
    """Draw the load."""
    axes.annotate("", xy=end, xytext=start, arrowprops=FORCE)
    axes.text(end[0] + 1.0, (start[1] + end[1]) / 2, "$f$", ha="center", va="center")


def _draw_external(axes: Axes, pair: DrawnPair) -> None:
    """Draw a roller pressed down on another."""
    centre = pair.centre
    axes.add_patch(Circle((0, 0), pair.R_i, facecolor=BODY_I, **OUTLINE))
    axes.add_patch(Circle(centre, pair.R_j, facecolor=BODY_J, **OUTLINE))
    _draw_overlap(axes, pair)
    cross(axes, (0.0, 0.0))
    cross(axes, centre)
    radius(axes, (0.0, 0.0), pair.R_i, 215, "$R_i$", (-0.6, 1.3))
    radius(axes, centre, pair.R_j, 150, "$R_j$", (0.3, 1.1))
    for y in (0.0, pair.centre_distance):
        axes.plot([0.9, 8.6], [y, y], **THIN)
    label = r"$\Delta R - \delta$"
    dimension(axes, (8.0, 0.0), (8.0, pair.centre_distance), label, (2.6, -1.5))
    lowest = pair.centre_distance - pair.R_j
    _small_dimension(axes, pair.R_i, lowest, x_from=0.0, x_to=-8.0, label=r"$\delta$")
    _force(axes, (0.0, centre[1] + pair.R_j + 4.0), (0.0, centre[1] + pair.R_j))
    _force(axes, (0.0, -pair.R_i - 4.0), (0.0, -pair.R_i))
    axes.plot([-pair.half_width, pair.half_width], [pair.chord, pair.chord], **THIN)
    end = (pair.half_width, pair.chord)
    axes.annotate("$2b$", xy=end, xytext=(4.4, 7.2), va="center", arrowprops=POINTER)


def _draw_strip(axes: Axes, half_width: float, length: float) -> None:
    """Draw the strip of length L and width 2b in oblique view, the pressure arched over it."""
    depth = np.array(polar(length, 40))
    arch = np.linspace(np.pi, 0.0, 61)
    front = np.column_stack([half_width * np.cos(arch), 5.0 * np.sin(arch)])
    left, right = front[0], front[-1]
    axes.add_patch(Polygon([left, right, right + depth, left + depth], facecolor=STRIP, **OUTLINE))
    for face in (front + depth, front):
        axes.add_patch(Polygon(face, facecolor=BODY_J, alpha=0.8, linewidth=0))
        axes.plot(*face.T, **THIN)
    # The arch's silhouette touches both faces where its slope is that of the strip's edges.
    slope = depth[1] / depth[0]
    touch = front[np.argmax(front[:, 1] - slope * front[:, 0])]
    axes.plot(*np.array([touch, touch + depth]).T, **THIN)
    below, aside = np.array([0.0, -1.3]), np.array([1.2, -1.0])
    dimension(axes, tuple(left + below), tuple(right + below), "$2b$", (0.0, -1.3))
    dimension(axes, tuple(right + aside), tuple(right + aside + depth), "$L$", (1.0, -1.0))
    axes.text(left[0], 8.6, "pressure", ha="left", va="bottom")
    axes.annotate("", xy=tuple(front[20]), xytext=(left[0] + 1.2, 8.5), arrowprops=POINTER)
