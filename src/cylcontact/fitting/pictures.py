"""Pictures of a fit: the data with the law and its band, the residuals, and profiles."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.datasets.measurements import Indices, Measurements
from cylcontact.fitting.drawing import (
    MOST_SERIES,
    Curve,
    draw_curves,
    draw_readings,
    draw_residuals,
)
from cylcontact.fitting.readings import Optimum
from cylcontact.plots.arguments import axes_for
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import as_label, brief

if TYPE_CHECKING:
    import pandas as pd

# Points of a curve, and the most laws with curves of their own.
_POINTS, _LAWS = 121, 4
# The most lines of a legend within a panel; each below the panels makes the figure taller.
_LEGEND, _TALLER = 4, 0.04
# Curves closer than this share of the readings' range are drawn as one.
_APART = 0.005


def plot(optimum: Optimum, law: str, level: float, ax: Axes | None = None) -> Axes:
    """Draw the data, the fitted law and the band of a new reading."""
    data = optimum.fit.data
    # The curve and its band lack the fixed effects of series.
    fixed = None if optimum.fit.noise.is_random else optimum.series_in_mm
    with axes_for(ax, "plot", "column", 68.0) as axes:
        curves, series = _curves(optimum, law, level), _series(data)
        pairs = len(data.groups("pair")[0])
        of_pairs = 1 < pairs <= MOST_SERIES and "group" not in data.data.labels
        draw_curves(axes, curves, level, of_pairs)
        if len(curves) < pairs:
            axes.plot([], [], " ", label=f"{pairs - len(curves)} more pairs not drawn")
        reading = data.penetration if fixed is None else data.penetration - fixed
        draw_readings(axes, data.load, reading, series)
        if fixed is not None and fixed.any():
            axes.set_ylabel("penetration less series effects (µm)")
        axes.legend()
    return axes


def plot_residuals(
    data: Measurements,
    standardised: FloatArray,
    outliers: Collection[int | str],
    ax: Axes | None = None,
) -> Axes:
    """Draw residuals against the load, and name the lines of outliers."""
    lines = {k: data.line(k) for k in range(len(data))}
    words = {k: f"line {line}" for k, line in lines.items() if line in outliers}
    with axes_for(ax, "plot_residuals", "column", 45.0) as axes:
        draw_residuals(axes, data.load, standardised, "residual (std. dev.)", _series(data), words)
    return axes


def two_panels(
    height: float, upper_share: float, upper: Callable[[Axes], Axes], lower: Callable[[Axes], Axes]
) -> Figure:
    """Return a figure of two pictures over one load; a legend of many lines is moved below."""
    figure = new_figure("column", height)
    above, beneath = figure.subplots(2, 1, sharex=True, height_ratios=[upper_share, 1])
    upper(above)
    lower(beneath)
    above.set_xlabel("")
    legend, (handles, labels) = above.get_legend(), above.get_legend_handles_labels()
    if legend is not None and len(labels) > _LEGEND:
        legend.remove()
        figure.set_figheight(figure.get_figheight() * (1 + _TALLER * len(labels)))
        figure.legend(handles, labels, loc="outside lower center")
    return figure


def plot_choice(optima: Mapping[str, Optimum], ax: Axes | None = None) -> Axes:
    """Draw the data of the first pair with the best laws; a title names it if there are others."""
    data, name, rows = _first_pair(optima)
    with axes_for(ax, "plot", "column", 68.0) as axes:
        draw_curves(axes, list(_of_laws(optima).values()))
        draw_readings(axes, data.load[rows], data.penetration[rows])
        if len(rows) < len(data.load):
            axes.set_title(as_label(name))
        axes.legend()
    return axes


def choice_drawing(name: str, optima: Mapping[str, Optimum], table: pd.DataFrame) -> Drawing:
    """Draw the data with the best laws, and beneath both less the best; `optima` are best first."""
    figure = two_panels(
        *(104.0, 1.6), partial(plot_choice, optima), partial(_draw_differences, optima)
    )
    caption = (
        f"{brief(name)}: measurements of one pair, {brief(_first_pair(optima)[1])}, and the best "
        "laws by AICc, each with its offset and stiffness fitted to all pairs; beneath, all less "
        f"{brief(next(iter(optima)))}. Of laws that coincide within {100 * _APART:g} % of the "
        "range one is drawn."
    )
    return Drawing(figure, table.reset_index(), caption)


def _first_pair(optima: Mapping[str, Optimum]) -> tuple[Measurements, str, Indices]:
    data = next(iter(optima.values())).fit.data
    names, index = data.groups("pair")
    return data, names[0], np.flatnonzero(index == 0)


def _of_laws(optima: Mapping[str, Optimum]) -> dict[str, Curve]:
    data, _, rows = _first_pair(optima)
    loads, pair = data.load[rows], data.take(rows[:1]).pair
    at = np.geomspace(loads.min(), loads.max(), _POINTS)
    curves: dict[str, Curve] = {}
    for name, optimum in optima.items():
        reading = optimum.law.penetration(at, pair)
        apart = [np.abs(reading - c.reading).max() / np.ptp(c.reading) for c in curves.values()]
        if min(apart, default=np.inf) > _APART:
            curves[name] = Curve(at, reading, label=name)
    return dict(list(curves.items())[:_LAWS])


def _draw_differences(optima: Mapping[str, Optimum], axes: Axes) -> Axes:
    (data, _, rows), curves, first = _first_pair(optima), _of_laws(optima), next(iter(optima))
    best, load = curves[first], data.load[rows]
    less = [
        Curve(curve.load, curve.reading - best.reading, label=name)
        for name, curve in curves.items()
    ]
    draw_curves(axes, less)
    draw_readings(axes, load, data.penetration[rows] - np.interp(load, best.load, best.reading))
    axes.set_ylabel(f"less {as_label(first)} (µm)")
    return axes


def _series(data: Measurements) -> list[str] | None:
    names, index = data.groups("group" if "group" in data.data.labels else "pair")
    return [names[k] for k in index] if len(names) > 1 else None


def _curves(optimum: Optimum, law: str, level: float) -> list[Curve]:
    data = optimum.fit.data
    names, index = data.groups("pair")
    curves = []
    for number, name in enumerate(names[:MOST_SERIES]):
        rows: Indices = np.flatnonzero(index == number)
        loads, pair = data.load[rows], data.take(rows[:1]).pair
        at: FloatArray = np.geomspace(loads.min(), loads.max(), _POINTS)
        label = name if len(names) > 1 else law
        try:
            band = optimum.band(pair, level, load=at)
        except InputError:  # the readings do not determine the curve of this pair
            curves.append(Curve(at, optimum.law.penetration(at, pair), label=label))
            continue
        curves.append(Curve(at, band.value, band.new_low, band.new_high, label))
    return curves
