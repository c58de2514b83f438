"""How sharply a fit determines a coefficient: the profile of its objective."""

from __future__ import annotations

import pandas as pd

from cylcontact.errors import InputError
from cylcontact.fitting.result import FitResult
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import ACCENT, COLOURS


def profile_drawing(result: FitResult, name: str, label: str) -> Drawing:
    """Draw the best attainable objective against one coefficient.

    Parameters
    ----------
    result : FitResult
        The fit.
    name : str
        The coefficient.
    label : str
        What stands below the horizontal axis, with the unit.

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
    axes.axvspan(profile.low, profile.high, color="0.85", linewidth=0, label="within 1 %")
    axes.plot(profile.values, profile.objective, "-", color="black", marker=".", markersize=2)
    axes.plot(best, result.objective.value, "*", color=ACCENT, markersize=8, label="fitted")
    if result.published is not None and profile.objective_at_published is not None:
        published = result.published.coefficients[name]
        reached = profile.objective_at_published
        axes.plot(published, reached, "o", color=COLOURS[1], label="held at the published value")
    axes.set(xlabel=label, ylabel=f"best attainable objective (-)\n{result.objective.name}", ylim=0)
    axes.set_title(f"{result.contact} contact")
    axes.legend(loc="lower right")
    table = pd.DataFrame({name: profile.values, "objective": profile.objective})
    return Drawing(figure, table, _headline(result, name), _caption(result, name))


def _headline(result: FitResult, name: str) -> dict[str, float]:
    """Return the optimum, its 1 % interval, and what the published value costs."""
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


def _caption(result: FitResult, name: str) -> str:
    """Say what a profile shows and what it rests on."""
    return (
        f"The fit {result.name!r} of the enhanced law (Eqs 5-6, {result.contact} contact) to "
        f"Johnson's: the objective {result.objective.name} that can be reached with {name} held at "
        "a value and the other coefficients optimised anew. Grey: the values of "
        f"{name} whose objective stays within 1 % of the optimum. Coefficients belong to mm, N and "
        "MPa. The grid of samples, the objective and the bounds are our choice."
    )
