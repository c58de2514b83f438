"""Pictures of a fit: the data with the law and its band, the residuals, and profiles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.arrays import FloatArray
from cylcontact.datasets.measurements import Indices, Measurements
from cylcontact.fitting.optimum import Optimum
from cylcontact.fitting.records import Interval
from cylcontact.fitting.words import axis_label
from cylcontact.plain_text import as_label, brief
from cylcontact.plots.arguments import axes_for
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.measured import Curve, draw_curves, draw_readings, draw_residuals
from cylcontact.plots.style import ACCENT, QUIET

if TYPE_CHECKING:
    from cylcontact.fitting.results import DataFit, LawFit

# Points of a curve, and the most pairs and laws with curves of their own.
_POINTS, _PAIRS, _LAWS = 121, 5, 4
# The most lines of a legend within a panel; each below the panels makes the figure taller.
_LEGEND, _TALLER = 4, 0.04
# Curves closer than this share of the readings' range are drawn as one.
_APART = 0.005


def plot(result: DataFit, ax: Axes | None = None) -> Axes:
    """Draw the data, the fitted law and the band of a new reading."""
    optimum = result.optimum
    data, noise = optimum.fit.data, optimum.fit.noise
    # The curve and its band lack the fixed effects of series.
    fixed = None if noise is None or noise.covariance.is_random else optimum.series_in_mm
    with axes_for(ax, "plot", "column", 68.0) as axes:
        draw_curves(axes, _curves(optimum, result.law, result.level))
        reading = data.penetration if fixed is None else data.penetration - fixed
        draw_readings(axes, data.load, reading, _series(data))
        if fixed is not None and fixed.any():
            axes.set_ylabel("penetration less series effects (µm)")
        axes.legend()
    return axes


def plot_residuals(result: DataFit, ax: Axes | None = None) -> Axes:
    """Draw the residuals over the load."""
    table = result.residuals
    load, standardised = table["load_N_per_mm"].to_numpy(), table["standardised"].to_numpy()
    lines = {outlier.line for outlier in result.uncertainty.outliers}
    words = {k: f"line {line}" for k, line in enumerate(table["line"]) if line in lines}
    series = _series(result.optimum.fit.data)
    with axes_for(ax, "plot_residuals", "column", 45.0) as axes:
        draw_residuals(axes, load, standardised, "residual (std. dev.)", series, words)
    return axes


def plot_profile_of_law(result: LawFit, name: str, ax: Axes | None = None) -> Axes:
    """Draw the best objective over a coefficient of a fit to a law."""
    curve, optimum = result.profiles[name], result.objective
    with axes_for(ax, "plot_profile", "column", 60.0) as axes:
        axes.plot(curve.values, curve.objective, marker="", linestyle="-")
        axes.axhline(1.01 * optimum.value, color=QUIET, linestyle=":", marker="")
        axes.axvline(result.coefficients[name], color=ACCENT, linestyle="--", marker="")
        label = axis_label(name, result.units)
        axes.set(xlabel=label, ylabel=f"best {as_label(optimum.name)}")
    return axes


def plot_profile_of_data(
    result: DataFit, name: str, ends: Interval, ax: Axes | None = None
) -> Axes:
    """Draw the likelihood ratio over a coefficient of a fit to readings."""
    values, root, threshold = result.optimum.profile(name, ends, result.level)
    with axes_for(ax, "plot_profile", "column", 60.0) as axes:
        axes.plot(values, root, marker="", linestyle="-")
        axes.axhline(threshold, color=QUIET, linestyle=":", marker="")
        for end in (ends.low, ends.high):
            axes.axvline(end, color=QUIET, linestyle="--", marker="", linewidth=0.8)
        axes.axvline(result.coefficients[name], color=ACCENT, linestyle="--", marker="")
        label = axis_label(name, result.units)
        axes.set(xlabel=label, ylabel="rise of the objective (std. dev.)")
    return axes


def fit_drawing(result: DataFit) -> Drawing:
    """Draw a fit to readings: the data with the law and its band, the residuals beneath.

    The drawing's table is that of the residuals, its headline the free coefficients.
    """
    figure = new_figure("column", 96.0)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1])
    plot(result, upper)
    plot_residuals(result, lower)
    upper.set_xlabel("")
    _move_long_legend(figure, upper)
    values = ", ".join(f"{name} = {value:.4g}" for name, value in result.free.items())
    residuals = result.residuals
    caption = (
        f"{brief(result.name)}: {len(residuals)} measurements, the {brief(result.law)} law fitted "
        f"to them ({values}), and the band of {100 * result.level:g} % of new readings; beneath, "
        "measured less fitted in standard deviations."
    )
    return Drawing(figure, residuals, result.free, caption)


def _move_long_legend(figure: Figure, axes: Axes) -> None:
    """Move a legend of many lines, which would cover the data, below the panels."""
    legend, (handles, labels) = axes.get_legend(), axes.get_legend_handles_labels()
    if legend is not None and len(labels) > _LEGEND:
        legend.remove()
        figure.set_figheight(figure.get_figheight() * (1 + _TALLER * len(labels)))
        figure.legend(handles, labels, loc="outside lower center")


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
    """Draw the data with the best laws, and beneath both less the best law.

    `optima` are by law, best first. The headline is the AICc of each law.
    """
    figure = new_figure("column", 104.0)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[1.6, 1])
    plot_choice(optima, upper)
    _draw_differences(optima, lower)
    upper.set_xlabel("")
    caption = (
        f"{brief(name)}: measurements of one pair, {brief(_first_pair(optima)[1])}, and the best "
        "laws by AICc, each with its offset and stiffness fitted to all pairs; beneath, all less "
        f"{brief(next(iter(optima)))}. Of laws that coincide within {100 * _APART:g} % of the "
        "range one is drawn."
    )
    return Drawing(figure, table.reset_index(), dict(table["aicc"]), caption)


def _first_pair(optima: Mapping[str, Optimum]) -> tuple[Measurements, str, Indices]:
    """Return the data of a choice, and the name and the rows of their first pair."""
    data = next(iter(optima.values())).fit.data
    names, index = data.groups("pair")
    return data, names[0], np.flatnonzero(index == 0)


def _of_laws(optima: Mapping[str, Optimum]) -> dict[str, Curve]:
    """Return the curves of the best laws for the first pair, of those that coincide only one."""
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


def _draw_differences(optima: Mapping[str, Optimum], axes: Axes) -> None:
    """Draw the readings of the first pair and the other laws, less the best law."""
    (data, _, rows), curves, first = _first_pair(optima), _of_laws(optima), next(iter(optima))
    best, load = curves[first], data.load[rows]
    less = [
        Curve(curve.load, curve.reading - best.reading, label=name)
        for name, curve in curves.items()
    ]
    draw_curves(axes, less)
    draw_readings(axes, load, data.penetration[rows] - np.interp(load, best.load, best.reading))
    axes.set_ylabel(f"less {as_label(first)} (µm)")


def _series(data: Measurements) -> list[str] | None:
    """Return the series of each row: the groups, or the pairs if there are several."""
    names, index = data.groups("group" if "group" in data.data.labels else "pair")
    return [names[k] for k in index] if len(names) > 1 else None


def _curves(optimum: Optimum, law: str, level: float) -> list[Curve]:
    """Return the predicted curve of each pair in the data, over its loads."""
    data = optimum.fit.data
    names, index = data.groups("pair")
    curves = []
    for number, name in enumerate(names[:_PAIRS]):
        rows: Indices = np.flatnonzero(index == number)
        loads, pair = data.load[rows], data.take(rows[:1]).pair
        at: FloatArray = np.geomspace(loads.min(), loads.max(), _POINTS)
        label = name if len(names) > 1 else law
        if optimum.covariance is None:
            curves.append(Curve(at, optimum.law.penetration(at, pair), label=label))
            continue
        band = optimum.band(pair, level, load=at)
        low, high = np.array(band.new_low), np.array(band.new_high)
        curves.append(Curve(at, np.array(band.value), low, high, label))
    return curves
