"""The clearance joint, drawn with its clearance magnified."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from cylcontact.arrays import FloatArray
from cylcontact.mechanism import Mechanism
from cylcontact.reports.sketch import OUTLINE, Point

# The clearance as drawn, in radii of the bearing.
DRAWN = 0.3
BEARING, JOURNAL = "0.80", "0.93"
RIM = 1.22


@dataclass(frozen=True)
class Magnified:
    """A joint as drawn, its centre in the bearing's and its unit the bearing's radius.

    Attributes
    ----------
    radial : float
        The radial clearance in mm.
    R_bearing : float
        In mm.
    """

    radial: float
    R_bearing: float

    @classmethod
    def of(cls, one: Mechanism) -> Magnified:
        """Return that of a mechanism's clearance joint."""
        return cls(one.clearance.radial * 1e3, one.clearance.R_bearing * 1e3)

    @property
    def factor(self) -> float:
        """How many times the clearance is magnified against the radius.

        Examples
        --------
        >>> print(Magnified(radial=0.5, R_bearing=10.0).factor)
        6.0
        """
        return DRAWN * self.R_bearing / self.radial

    def journal_centre(self, eccentricity: Point | FloatArray) -> Point:
        """Return where the journal's centre is drawn: at −e, magnified."""
        scale = -DRAWN / self.radial
        return (float(scale * eccentricity[0]), float(scale * eccentricity[1]))


def draw_magnified(axes: Axes, joint: Magnified, eccentricity: Point) -> Point:
    """Draw bearing and journal, and return where the journal's centre is.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Its unit is the bearing's radius.
    joint : Magnified
        What to draw.
    eccentricity : pair of float
        e in mm.
    """
    centre = joint.journal_centre(eccentricity)
    axes.add_patch(Circle((0, 0), RIM, facecolor=BEARING, zorder=1, **OUTLINE))
    axes.add_patch(Circle((0, 0), 1.0, facecolor="white", zorder=2, **OUTLINE))
    axes.add_patch(Circle(centre, 1.0 - DRAWN, facecolor=JOURNAL, alpha=0.85, zorder=3, **OUTLINE))
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
    axes.set_axis_off()
    return centre


def draw_clearance_circle(axes: Axes, radius: float, **style: Any) -> None:
    """Draw the circle that the journal's centre leaves when it touches the bearing."""
    turn = np.linspace(0, 2 * np.pi, 181)
    look: dict[str, Any] = {
        "color": "black",
        "linewidth": 0.7,
        "linestyle": (0, (5, 3)),
        "marker": "",
    }
    axes.plot(radius * np.cos(turn), radius * np.sin(turn), **look | style)
