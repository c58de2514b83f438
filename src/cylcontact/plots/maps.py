"""Signed contour maps in percent, with common levels and legible in grey."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.contour import QuadContourSet
from matplotlib.figure import FigureBase
from matplotlib.patheffects import withStroke

from cylcontact.support.arrays import FloatArray

__all__ = ["RIM", "add_scale", "draw_contours", "label_contours", "signed"]

# One set of levels (percent), in even steps, and colours for every map. Blue is below zero, orange
# above; each side darkens outwards, so in grey dashes and the contours' labels show the sign.
LEVELS = tuple(range(-20, 21, 4))
COLOURS = (
    *("#2f7fb8", "#5b9dcb", "#82b6da", "#a8cee7", "#cae1f1", "#e9f3fa"),
    *("#fdf1e3", "#fbd9b5", "#f6bb84", "#ee9b55", "#df7b30", "#c45f17"),
)
COLOUR_MAP = ListedColormap(COLOURS)
NORM = BoundaryNorm(LEVELS, len(COLOURS), extend="both")

# A light rim that keeps text legible on every colour.
RIM = withStroke(linewidth=1.8, foreground="white")
LABEL_ROOM = 19.0  # pixels at 100 dpi that a contour's label needs on every side


def add_scale(figure: FigureBase, axes: Axes | Sequence[Axes], label: str) -> None:
    """Add the colour scale of one or several maps; its arrows are for what lies beyond."""
    bar = figure.colorbar(
        ScalarMappable(NORM, COLOUR_MAP),
        ax=axes,
        ticks=LEVELS,
        format=lambda level, _: signed(level),
        fraction=0.05,
        pad=0.02,
    )
    bar.ax.tick_params(length=0)
    bar.set_label(label)


def draw_contours(axes: Axes, x: FloatArray, y: FloatArray, percent: FloatArray) -> QuadContourSet:
    """Fill a map and draw its contours, dashed below zero."""
    axes.contourf(x, y, percent, LEVELS, cmap=COLOUR_MAP, norm=NORM, extend="both")
    return axes.contour(
        x,
        y,
        percent,
        LEVELS,
        colors="black",
        linewidths=[1.2 if level == 0 else 0.6 for level in LEVELS],
        linestyles=["--" if level < 0 else "-" for level in LEVELS],
    )


def label_contours(axes: Axes, lines: QuadContourSet, keep_clear: FloatArray) -> None:
    """Label each contour where there is most room, if there is enough.

    The layout must be settled, because labels interrupt their lines by their printed length.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes = Figure().subplots()
    >>> x, y = np.meshgrid(np.geomspace(1, 10, 20), np.geomspace(1, 10, 20))
    >>> lines = draw_contours(axes, x, y, x - y)
    >>> label_contours(axes, lines, np.empty((0, 2)))
    >>> [text.get_text() for text in lines.labelTexts]
    ['−8', '−4', '0', '+4', '+8']
    """
    taken = list(axes.transData.transform(keep_clear))
    free = len(taken)
    least = LABEL_ROOM * axes.figure.dpi / 100
    for path in lines.get_paths():
        for polygon in axes.transData.transform_path(path).to_polygons(closed_only=False):
            line: FloatArray = np.asarray(polygon)
            room = _room(axes, line, taken)
            if room.max() > least:
                taken.append(line[np.argmax(room)])
    if len(taken) == free:
        return
    places = axes.transData.inverted().transform(taken[free:])
    size = rcParams["legend.fontsize"]
    for text in axes.clabel(lines, fmt=signed, fontsize=size, inline_spacing=2, manual=places):
        text.set_path_effects([RIM])


def _room(axes: Axes, points: FloatArray, taken: list[FloatArray]) -> FloatArray:
    """Return the distance in pixels of each point from the frame and the places taken."""
    frame = axes.bbox
    to_frame = np.minimum(points - frame.min, frame.max - points).min(axis=1)
    to_taken = [np.hypot(*(points - place).T) for place in taken]
    return np.asarray(np.min([to_frame, *to_taken], axis=0))


def signed(level: float) -> str:
    """Write a level with its sign, the minus as long as the plus.

    Examples
    --------
    >>> signed(4.0), signed(0.0), signed(-12.0)
    ('+4', '0', '−12')
    """
    return f"{level:+g}".replace("-", "\u2212") if level else "0"
