"""Figures of one fit: its runs side by side, and the profile of a coefficient."""

from __future__ import annotations

import math

import pandas as pd

from cylcontact.errors import InputError
from cylcontact.fitting.results import LawFit
from cylcontact.plain_text import as_label
from cylcontact.plots.arguments import add_legend
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import ACCENT, COLOURS, QUIET, figure_style

__all__ = ["profile_drawing", "runs_drawing", "runs_table"]

METHOD = (
    "At points between the bounds of the search one coefficient is fixed and the objective "
    "minimised over all others; each descent starts where that of the point nearer the optimum "
    "ended. The ends of the grey interval are found to a ten-thousandth of its width."
)


def runs_table(result: LawFit) -> pd.DataFrame:
    """Return the runs of a result, best first.

    Parameters
    ----------
    result : LawFit
        The fit.

    Returns
    -------
    pandas.DataFrame
        Columns run, population, crossover, searched and polished (the objective before and after
        the polish), evaluations, seconds, and each coefficient of the search before the polish.
    """
    ordered = sorted(result.runs, key=lambda run: (run.objective, run.index))
    return pd.DataFrame(
        {
            "run": [run.index for run in ordered],
            "population": [run.population for run in ordered],
            "crossover": [run.crossover for run in ordered],
            "searched": [run.objective_before_polish for run in ordered],
            "polished": [run.objective for run in ordered],
            "evaluations": [run.evaluations for run in ordered],
            "seconds": [run.seconds for run in ordered],
        }
        | {
            f"{name}_searched": [
                (run.coefficients_before_polish or {}).get(name, math.nan) for run in ordered
            ]
            for name in result.profiles
        }
    )


@figure_style()
def runs_drawing(result: LawFit) -> Drawing:
    """Draw the objective of every run before and after the polish, best first.

    Parameters
    ----------
    result : LawFit
        The fit.

    Returns
    -------
    Drawing
        Its headline has the best objective and the number of runs within 0.1 % of it.
    """
    table = runs_table(result)
    figure = new_figure("column", 66.0)
    axes = figure.subplots()
    place = range(1, len(table) + 1)
    axes.vlines(place, table["polished"], table["searched"], color=QUIET, linewidth=0.8)
    axes.plot(place, table["searched"], "o", color=COLOURS[1], label="genetic search")
    axes.plot(place, table["polished"], "s", color=ACCENT, label="after the polish")
    if result.bound is not None:
        label = "lower bound of any law of this form"
        axes.axhline(result.bound, color="black", linestyle=":", linewidth=0.8, label=label)
    axes.set(xlabel="run, best first", ylabel=as_label(result.objective.name), ylim=0)
    axes.xaxis.get_major_locator().set_params(integer=True)
    add_legend(axes)
    value, agreeing = result.basins()[0]
    caption = (
        f"The {len(table)} runs of the fit {result.name!r}, best first: {result.objective.name} "
        f"after the genetic search and after the polish. {agreeing} of them reached the best "
        "objective within 0.1 %."
    )
    return Drawing(figure, table, {"objective": value, "runs that reached it": agreeing}, caption)


@figure_style()
def profile_drawing(result: LawFit, name: str, label: str) -> Drawing:
    """Draw the best attainable objective against one coefficient.

    Parameters
    ----------
    result : LawFit
        The fit.
    name : str
        The coefficient.
    label : str
        Label of the horizontal axis, with the unit.

    Returns
    -------
    Drawing

    Raises
    ------
    InputError
        If the fit did not vary the coefficient.
    """
    if name not in result.profiles:
        raise InputError(
            f"fit result {result.name!r}",
            "profiles",
            name,
            "the fit has no profile of this coefficient",
            f"choose among {', '.join(result.profiles)}",
        )
    profile, best = result.profiles[name], result.coefficients[name]
    figure = new_figure("column", 66.0)
    axes = figure.subplots()
    axes.axvspan(profile.low, profile.high, color="0.85", linewidth=0, label="within 1 % of best")
    axes.plot(profile.values, profile.objective, "-", color="black", marker="")
    axes.plot(best, result.objective.value, "o", color=ACCENT, markerfacecolor=ACCENT, label="best")
    if result.published is not None and profile.objective_at_published is not None:
        published = result.published.coefficients[name]
        objective = profile.objective_at_published
        axes.plot(published, objective, "s", color=COLOURS[1], label=f"published {as_label(name)}")
    axes.set(xlabel=label, ylabel=f"least {as_label(result.objective.name)} (-)")
    axes.margins(y=0.1)
    axes.set_title(f"{result.contact} contact")
    add_legend(axes)
    table = pd.DataFrame({name: profile.values, "objective": profile.objective})
    return Drawing(figure, table, _headline(result, name), _caption(result, name), METHOD)


def _headline(result: LawFit, name: str) -> dict[str, float]:
    """Return the optimum, its 1 % interval, and the rise at the published value."""
    profile = result.profiles[name]
    headline = {
        f"fitted {name}": result.coefficients[name],
        "objective": result.objective.value,
        f"lowest {name} within 1 %": profile.low,
        f"highest {name} within 1 %": profile.high,
    }
    if profile.objective_at_published is not None:
        rise = profile.objective_at_published / result.objective.value - 1
        headline |= {"rise of the objective at the published value, %": 100 * rise}
    return headline


def _caption(result: LawFit, name: str) -> str:
    """Return the caption of a profile."""
    return (
        f"The fit {result.name!r} of the enhanced law (Eqs 5-6, {result.contact} contact) to "
        f"Johnson's: least {result.objective.name} with {name} held at a value and the other "
        f"coefficients fitted anew. Grey: values of {name} that cost at most 1 %. Coefficients "
        "belong to mm, N and MPa; the grid, the objective and the bounds are ours."
    )
