"""Parts of drawings of definitions: arrows, dimensions, crosses."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

__all__ = ["ARROW", "OUTLINE", "POINTER", "THIN", "Point", "cross", "dimension", "polar", "radius"]

Point = tuple[float, float]

OUTLINE: dict[str, Any] = {"edgecolor": "black", "linewidth": 0.9}
THIN: dict[str, Any] = {"color": "black", "linewidth": 0.5, "linestyle": "-", "marker": ""}
ARROW: dict[str, Any] = {"shrinkA": 0, "shrinkB": 0, "facecolor": "black"}
DIMENSION = ARROW | {"arrowstyle": "<|-|>", "mutation_scale": 5, "linewidth": 0.6}
POINTER = DIMENSION | {"arrowstyle": "-|>"}


def polar(radius: float, degrees: float, centre: Point = (0.0, 0.0)) -> Point:
    """Return the point at a distance and a direction from a centre."""
    angle = np.radians(degrees)
    return (
        float(centre[0] + radius * np.cos(angle)),
        float(centre[1] + radius * np.sin(angle)),
    )


def cross(axes: Axes, at: Point, zorder: float = 2.0) -> None:
    """Mark an axis with a cross."""
    axes.plot(*at, marker="+", color="black", markersize=6, markeredgewidth=0.7, zorder=zorder)


def dimension(axes: Axes, start: Point, end: Point, label: str, offset: Point) -> None:
    """Draw a dimension and write its symbol beside the middle."""
    axes.annotate("", xy=end, xytext=start, arrowprops=DIMENSION)
    x, y = (start[0] + end[0]) / 2 + offset[0], (start[1] + end[1]) / 2 + offset[1]
    axes.text(x, y, label, ha="center", va="center")


def radius(
    axes: Axes, centre: Point, radius: float, degrees: float, label: str, offset: Point
) -> None:
    """Draw a radius as an arrow from the centre."""
    end = polar(radius, degrees, centre)
    axes.annotate("", xy=end, xytext=centre, arrowprops=POINTER)
    x, y = (centre[0] + end[0]) / 2 + offset[0], (centre[1] + end[1]) / 2 + offset[1]
    axes.text(x, y, label, ha="center", va="center")
