"""Pictures of a fit: the data with the law and its band, the residuals, and profiles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.measurements import Indices
from cylcontact.errors import InputError
from cylcontact.fitting.law_models import units_of
from cylcontact.fitting.measured_objective import laws_of, measured
from cylcontact.fitting.predictions import band_table
from cylcontact.fitting.uncertainty.profiles import likelihood_profile
from cylcontact.fitting.uncertainty.residual_model import residual_model_at
from cylcontact.plain_text import as_label, brief
from cylcontact.plots.arguments import axes_for
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.measured import Curve, draw_curves, draw_readings, draw_residuals
from cylcontact.plots.style import ACCENT, QUIET

if TYPE_CHECKING:
    from cylcontact.fitting.choice import Choice
    from cylcontact.fitting.result import FitResult

__all__ = [
    "choice_drawing",
    "fit_drawing",
    "plot",
    "plot_choice",
    "plot_profile",
    "plot_residuals",
]

# Points of a curve, and the most pairs and laws with curves of their own.
_POINTS, _PAIRS, _LAWS = 121, 5, 4
# The most lines of a legend within a panel; each below the panels makes the figure taller.
_LEGEND, _TALLER = 4, 0.04
# Curves closer than this share of the readings' range are drawn as one.
_APART = 0.005


def plot(result: FitResult, ax: Axes | None = None) -> Axes:
    """Draw the data, the fitted law and the band of a new reading."""
    data, fixed = measured(result.problem).data, _fixed(result)
    with axes_for(ax, "plot", "column", 68.0) as axes:
        draw_curves(axes, _curves(result))
        draw_readings(axes, data.load, data.penetration - fixed, _series(result))
        if fixed.any():
            axes.set_ylabel("penetration less series effects (µm)")
        axes.legend()
    return axes


def _fixed(result: FitResult) -> FloatArray:
    """Return the fixed effects of series in mm, shape (N,), which the curve and its band lack."""
    noise = result.uncertainty.noise if result.uncertainty else None
    if noise is None or noise.random or not noise.series:
        return np.zeros(result.counts.samples)
    return as_floats(result.residuals["series_mm"])


def plot_residuals(result: FitResult, ax: Axes | None = None) -> Axes:
    """Draw the residuals over the load."""
    table, uncertainty = result.residuals, result.uncertainty
    load, standardised = table["load_N_per_mm"].to_numpy(), table["standardised"].to_numpy()
    lines = {o.line for o in uncertainty.outliers} if uncertainty else set()
    words = {k: f"line {line}" for k, line in enumerate(table["line"]) if line in lines}
    with axes_for(ax, "plot_residuals", "column", 45.0) as axes:
        draw_residuals(axes, load, standardised, "residual (std. dev.)", _series(result), words)
    return axes


def plot_profile(result: FitResult, name: str, ax: Axes | None = None) -> Axes:
    """Draw how much worse the fit gets when a coefficient moves and all others follow."""
    with axes_for(ax, "plot_profile", "column", 60.0) as axes:
        if result.uncertainty is None:
            _draw_profile_of_law(result, name, axes)
        else:
            _draw_profile_of_data(result, name, axes)
        unit = units_of(result.law, result.contact).get(name)
        axes.set_xlabel(f"{as_label(name)} ({unit})" if unit else as_label(name))
    return axes


def fit_drawing(result: FitResult) -> Drawing:
    """Draw a fit to measurements: the data with the law and its band, the residuals beneath.

    Parameters
    ----------
    result : FitResult
        Of measurements.

    Returns
    -------
    Drawing
        Its table is `FitResult.residuals`, its headline the coefficients.
    """
    figure = new_figure("column", 96.0)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1])
    plot(result, upper)
    plot_residuals(result, lower)
    upper.set_xlabel("")
    _move_long_legend(figure, upper)
    level = 100 * result.level
    values = ", ".join(f"{name} = {value:.4g}" for name, value in _free(result).items())
    caption = (
        f"{brief(result.name)}: {result.counts.samples} measurements, the {brief(result.law)} law "
        f"fitted to them ({values}), and the band of {level:g} % of new readings; beneath, "
        "measured less fitted in standard deviations."
    )
    return Drawing(figure, result.residuals, _free(result), caption)


def _move_long_legend(figure: Figure, axes: Axes) -> None:
    """Move a legend of many lines, which would cover the data, below the panels."""
    legend, (handles, labels) = axes.get_legend(), axes.get_legend_handles_labels()
    if legend is not None and len(labels) > _LEGEND:
        legend.remove()
        figure.set_figheight(figure.get_figheight() * (1 + _TALLER * len(labels)))
        figure.legend(handles, labels, loc="outside lower center")


def plot_choice(choice: Choice, ax: Axes | None = None) -> Axes:
    """Draw the data of the first pair with the best laws; a title names it if there are others."""
    data, (name, rows) = choice.data.measurements, _first_pair(choice)
    with axes_for(ax, "plot", "column", 68.0) as axes:
        draw_curves(axes, list(_of_laws(choice).values()))
        draw_readings(axes, data.load[rows], data.penetration[rows])
        if len(rows) < len(data.load):
            axes.set_title(as_label(name))
        axes.legend()
    return axes


def choice_drawing(choice: Choice) -> Drawing:
    """Draw the data with the best laws, and beneath both less the best law.

    Parameters
    ----------
    choice : Choice
        The ranked laws.

    Returns
    -------
    Drawing
        Its table is that of the choice, its headline the AICc of each law.
    """
    figure = new_figure("column", 104.0)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[1.6, 1])
    plot_choice(choice, upper)
    _draw_differences(choice, lower)
    upper.set_xlabel("")
    caption = (
        f"{brief(choice.data.name)}: measurements of one pair, {brief(_first_pair(choice)[0])}, "
        "and the best laws by AICc, each with its offset and stiffness fitted to all pairs; "
        f"beneath, all less {brief(choice.best.law)}. Of laws that coincide within "
        f"{100 * _APART:g} % of the range one is drawn."
    )
    return Drawing(
        figure, choice.table.reset_index(), {law.law: law.aicc for law in choice.laws}, caption
    )


def _first_pair(choice: Choice) -> tuple[str, Indices]:
    """Return the name and the rows of the first pair of the data."""
    names, index = choice.data.measurements.groups("pair")
    return names[0], np.flatnonzero(index == 0)


def _of_laws(choice: Choice) -> dict[str, Curve]:
    """Return the curves of the best laws for the first pair, of those that coincide only one."""
    data, (_, rows) = choice.data.measurements, _first_pair(choice)
    loads, pair = data.load[rows], data.take(rows[:1]).pair
    at = np.geomspace(loads.min(), loads.max(), _POINTS)
    curves: dict[str, Curve] = {}
    for ranked in choice.laws:
        (law,) = laws_of(ranked.problem.form(ranked.point[None, :]))
        if law is None:
            raise TypeError("the law is undefined at the best coefficients")
        reading = law.penetration(at, pair)
        apart = [np.abs(reading - c.reading).max() / np.ptp(c.reading) for c in curves.values()]
        if min(apart, default=np.inf) > _APART:
            curves[ranked.law] = Curve(at, reading, label=ranked.law)
    return dict(list(curves.items())[:_LAWS])


def _draw_differences(choice: Choice, axes: Axes) -> None:
    """Draw the readings of the first pair and the other laws, less the best law."""
    data, curves = choice.data.measurements, _of_laws(choice)
    best, (_, rows) = curves[choice.best.law], _first_pair(choice)
    load, reading = data.load[rows], data.penetration[rows]
    less = [
        Curve(curve.load, curve.reading - best.reading, label=name)
        for name, curve in curves.items()
    ]
    draw_curves(axes, less)
    draw_readings(axes, load, reading - np.interp(load, best.load, best.reading))
    axes.set_ylabel(f"less {as_label(choice.best.law)} (µm)")


def _free(result: FitResult) -> dict[str, float]:
    """Return the coefficients that were searched."""
    names = result.uncertainty.estimates if result.uncertainty else result.coefficients
    return {name: result.coefficients[name] for name in names}


def _series(result: FitResult) -> list[str] | None:
    """Return the series of each row: the groups, or the pairs if there are several."""
    data = measured(result.problem).data
    over = "group" if "group" in data.data.labels else "pair"
    names, index = data.groups(over)
    return [names[k] for k in index] if len(names) > 1 else None


def _curves(result: FitResult) -> list[Curve]:
    """Return the predicted curve of each pair in the data, over its loads."""
    data = measured(result.problem).data
    names, index = data.groups("pair")
    curves = []
    for number, name in enumerate(names[:_PAIRS]):
        rows: Indices = np.flatnonzero(index == number)
        loads = data.load[rows]
        at = np.geomspace(loads.min(), loads.max(), _POINTS)
        curves.append(_curve(result, rows[:1], at, name if len(names) > 1 else result.law))
    return curves


def _curve(result: FitResult, row: Indices, at: np.ndarray, label: str) -> Curve:
    """Return the curve of the pair of a row, without a band if there is no covariance."""
    problem, best = result.problem, result.coefficients
    pair, point = measured(problem).data.take(row).pair, problem.point(best)
    if residual_model_at(problem, point).covariance is None:
        (law,) = laws_of(problem.form(point[None, :]))
        if law is None:
            raise TypeError("the law is undefined at the best coefficients")
        return Curve(at, law.penetration(at, pair), label=label)
    table = band_table(problem, best, at, result.level, pair)
    low, high = table["low_mm"].to_numpy(), table["high_mm"].to_numpy()
    return Curve(at, table["penetration_mm"].to_numpy(), low, high, label)


def _draw_profile_of_law(result: FitResult, name: str, axes: Axes) -> None:
    """Draw the best objective over a coefficient of a fit to a law."""
    if name not in result.profiles:
        _refuse(result, name, list(result.profiles))
    curve, optimum = result.profiles[name], result.objective.value
    axes.plot(curve.values, curve.objective, marker="", linestyle="-")
    axes.axhline(1.01 * optimum, color=QUIET, linestyle=":", marker="")
    axes.axvline(result.coefficients[name], color=ACCENT, linestyle="--", marker="")
    axes.set_ylabel(f"best {as_label(result.objective.name)}")


def _draw_profile_of_data(result: FitResult, name: str, axes: Axes) -> None:
    """Draw the likelihood ratio over a coefficient of a fit to measurements."""
    uncertainty = result.uncertainty
    estimate = uncertainty.estimates.get(name) if uncertainty else None
    if estimate is None or estimate.profile is None:
        _refuse(result, name, list(uncertainty.estimates) if uncertainty else [])
        return
    values, root, threshold = likelihood_profile(
        result.problem, result.coefficients, name, estimate.profile, result.level
    )
    axes.plot(values, root, marker="", linestyle="-")
    axes.axhline(threshold, color=QUIET, linestyle=":", marker="")
    for end in (estimate.profile.low, estimate.profile.high):
        axes.axvline(end, color=QUIET, linestyle="--", marker="", linewidth=0.8)
    axes.axvline(estimate.value, color=ACCENT, linestyle="--", marker="")
    axes.set_ylabel("rise of the objective (std. dev.)")


def _refuse(result: FitResult, name: str, known: list[str]) -> None:
    """Refuse a coefficient without a profile."""
    rule = "has no profile: it was not searched, or the data do not determine it"
    remedy = f"choose {', '.join(known)}" if known else "free it"
    raise InputError(f"fit result {result.name!r}", "name", name, rule, remedy)
