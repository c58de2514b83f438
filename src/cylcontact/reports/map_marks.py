"""What is drawn on the maps of difference besides contours: limits, yield, the fitted range."""

from __future__ import annotations

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.patheffects import TickedStroke, withStroke

from cylcontact.arrays import FloatArray
from cylcontact.plots.figure import plain_number
from cylcontact.plots.maps import RIM, Frame
from cylcontact.reports.claims.domain import PRACTICAL

FRAME = Frame(
    x=PRACTICAL.clearances,
    y=PRACTICAL.loads,
    x_ticks=(0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2),
    y_ticks=(10, 20, 50, 100, 200, 500, 1000),
    x_label=r"radial clearance $\Delta R$ (mm)",
    y_label="load (N/mm)",
)
NOTE_HEIGHT = 1.025  # of the notes above the frame, in heights of it
NOTE_LINE = 1.45  # from one line of notes to the next, in sizes of the font
BEYOND_GREY = "0.72"


def stack_notes(axes: Axes, ends: FloatArray, yields: FloatArray, narrow: bool) -> bool:
    """Make room for a second line of notes where two do not fit side by side, and tell so.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        A map with its title.
    ends, yields : array of float
        The largest load of Johnson's law and the load at yield in N/mm, along the clearances.
    narrow : bool
        Whether the map is a column wide.
    """
    ceiling = FRAME.y[1]
    stacked = bool(ends[0] < ceiling and (narrow or not (yields < ceiling).any()))
    if stacked:
        room = (2 + NOTE_LINE) * rcParams["font.size"]
        axes.set_title(axes.get_title(loc="left"), pad=room)
    return stacked


def shade_beyond_johnson(axes: Axes, dR: FloatArray, limit: FloatArray) -> None:
    """Shade and label the region in which Johnson's law gives no penetration (Eq 8)."""
    ceiling = FRAME.y[1]
    if limit[0] >= ceiling:
        return
    axes.fill_between(
        dR,
        np.minimum(limit, ceiling),
        ceiling,
        facecolor=BEYOND_GREY,
        edgecolor="0.4",
        hatch="xxxxx",
        linewidth=0,
    )
    axes.plot(dR, limit, "-", color="black", linewidth=0.8, marker="")
    axes.annotate(
        "beyond Johnson's law",
        xy=(FRAME.x[0] * 1.04, ceiling * 0.96),
        xytext=(0.05, NOTE_HEIGHT),
        textcoords="axes fraction",
        arrowprops={
            "arrowstyle": "-|>",
            "facecolor": "black",
            "linewidth": 0.6,
            "mutation_scale": 5,
            "relpos": (0.0, 0.4),
            "shrinkB": 0,
        },
    )


def mark_fitted_range(axes: Axes, fitted_from: float) -> None:
    """Mark the clearance from which on the coefficients were fitted, unless all were."""
    if fitted_from <= FRAME.x[0]:
        return
    axes.axvline(fitted_from, color="0.25", linewidth=0.8, linestyle=":", marker="")
    axes.text(
        fitted_from * 1.03,
        FRAME.y[0] * 1.06,
        f"fitted from {plain_number(fitted_from)} mm on",
        rotation=90,
        path_effects=[RIM],
    )


def keep_clear(fitted_from: float) -> FloatArray:
    """Return points along the note on the fitted range, for contour labels to avoid."""
    loads = np.geomspace(FRAME.y[0], 3.5 * FRAME.y[0], 6)
    return np.column_stack([np.full_like(loads, 1.06 * fitted_from), loads])


def draw_yield_line(axes: Axes, dR: FloatArray, limit: FloatArray) -> None:
    """Draw the load at which the contact yields, ticks on the side where it does."""
    comb = TickedStroke(spacing=6, angle=90, length=0.6, linewidth=0.8, foreground="black")
    rim = withStroke(linewidth=3.2, foreground="white")
    axes.plot(dR, limit, "-", color="black", linewidth=1.6, marker="", path_effects=[rim, comb])


def label_yield_line(
    axes: Axes, dR: FloatArray, limit: FloatArray, second_line: bool = False
) -> None:
    """Write along the yield line, on the side that yields, what it is; or that there is none."""
    shown = np.flatnonzero(limit < FRAME.y[1])
    words = "yield line" if shown.size else "no yield in this window"
    note = rf"{words} for $R_i$ = {PRACTICAL.R_i:g} mm, $\sigma_Y$ assumed"
    axes.annotate(
        note,
        xy=(1.0, NOTE_HEIGHT),
        xycoords="axes fraction",
        xytext=(0, NOTE_LINE * rcParams["font.size"] * second_line),
        textcoords="offset points",
        ha="right",
        annotation_clip=False,
    )
    if shown.size == 0:
        return
    ends, middle = shown[[0, -1]], shown[shown.size // 2]
    (x0, y0), (x1, y1) = axes.transData.transform(np.column_stack([dR[ends], limit[ends]]))
    axes.annotate(
        "yields",
        xy=(dR[middle], limit[middle]),
        xytext=(4, 4),
        textcoords="offset points",
        rotation=np.degrees(np.arctan2(y1 - y0, x1 - x0)),
        rotation_mode="anchor",
        ha="center",
        va="bottom",
        path_effects=[RIM],
    )
