"""Measurements with the curve of a law: the readings against the load, and their residuals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from cylcontact.plots.figure import plain_number
from cylcontact.plots.style import COLOURS, MARKERS, QUIET
from cylcontact.support.arrays import FloatArray
from cylcontact.support.plain_text import as_label

__all__ = ["Curve", "draw_curves", "draw_readings", "draw_residuals"]

# More series than this are drawn alike, and no more pairs have curves of their own.
MOST_SERIES = 2 * len(COLOURS)
_MICROMETRES = 1e3
# Axes are logarithmic if loads span more than this ratio and all readings are positive.
_WIDE = 30.0
# 0.1, 1 and 10 rather than powers of ten.
_PLAIN = FuncFormatter(lambda value, _: plain_number(value))


@dataclass(frozen=True, eq=False)
class Curve:
    """The readings that a law predicts over loads, with the ends of their band."""

    load: FloatArray
    reading: FloatArray
    low: FloatArray | None = None
    high: FloatArray | None = None
    label: str = "fitted law"


def draw_readings(
    axes: Axes, load: FloatArray, reading: FloatArray, series: Sequence[str] | None = None
) -> None:
    """Draw readings against the load, logarithmic if they span decades."""
    for label, rows, style in _styles(load.size, series, "measured"):
        axes.plot(load[rows], _MICROMETRES * reading[rows], linestyle="", label=label, **style)
    if reading.min() > 0 and load.max() > _WIDE * load.min():
        axes.set(xscale="log", yscale="log")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter(_PLAIN)
    axes.set(xlabel="load (N/mm)", ylabel="penetration (µm)")


def draw_curves(
    axes: Axes, curves: Sequence[Curve], level: float = 0.95, of_pairs: bool = False
) -> None:
    """Draw the curves of laws with their bands, or of the pairs of a table."""
    for number, curve in enumerate(curves):
        # The readings of a pair have the colour of its curve, and its name in the legend.
        first = 0 if of_pairs else 1
        colour = COLOURS[2] if len(curves) == 1 else COLOURS[(number + first) % len(COLOURS)]
        if curve.low is not None and curve.high is not None:
            axes.fill_between(
                curve.load,
                _MICROMETRES * curve.low,
                _MICROMETRES * curve.high,
                color=colour,
                alpha=0.18,
                linewidth=0,
                label=f"{100 * level:g} % of new readings" if number == 0 else None,
            )
        axes.plot(
            curve.load,
            _MICROMETRES * curve.reading,
            linestyle="-" if len(curves) == 1 or of_pairs else None,
            marker="",
            color=colour,
            label=None if of_pairs else as_label(curve.label),
        )


def draw_residuals(
    axes: Axes,
    load: FloatArray,
    residual: FloatArray,
    label: str,
    series: Sequence[str] | None = None,
    outliers: Mapping[int, str] | None = None,
) -> None:
    """Draw residuals against the load."""
    axes.axhline(0.0, color=QUIET, linewidth=0.6, linestyle="-", marker="")
    for name, rows, style in _styles(load.size, series, "measured"):
        axes.plot(load[rows], residual[rows], linestyle="", label=name, **style)
    axes.margins(y=0.12 if outliers else None)  # room for their words
    middle = np.sqrt(load.min() * load.max())
    for row, words in (outliers or {}).items():
        right = load[row] > middle
        axes.annotate(
            words,
            (load[row], residual[row]),
            xytext=(-4 if right else 4, 0),
            textcoords="offset points",
            horizontalalignment="right" if right else "left",
            verticalalignment="center",
            fontsize=rcParams["legend.fontsize"],
        )
    if load.max() > _WIDE * load.min():
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(_PLAIN)
    axes.set(xlabel="load (N/mm)", ylabel=label)


def _styles(
    size: int, series: Sequence[str] | None, label: str
) -> list[tuple[str, Any, dict[str, Any]]]:
    """Return the name, the rows and the markers of each series."""
    hollow: dict[str, Any] = {"markerfacecolor": "white"}
    names = list(dict.fromkeys(series or ()))
    if series is None or not 1 < len(names) <= MOST_SERIES:
        count = f"{label} ({len(names)} series)" if len(names) > 1 else label
        return [(count, slice(size), {"marker": "o", "color": COLOURS[0], **hollow})]
    member, number = np.asarray(series), len(COLOURS)
    return [
        (
            as_label(name),
            np.flatnonzero(member == name),
            # From the sixth on the colours begin anew, with other markers.
            {"color": COLOURS[k % number], "marker": MARKERS[(k + k // number) % number], **hollow},
        )
        for k, name in enumerate(names)
    ]
