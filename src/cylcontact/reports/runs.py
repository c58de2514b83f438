"""The runs of a campaign side by side: how far the search came, and how far the polish."""

from __future__ import annotations

import pandas as pd

from cylcontact.fitting.result import FitResult
from cylcontact.fitting.verdicts import basins
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import ACCENT, COLOURS, QUIET


def runs_table(result: FitResult) -> pd.DataFrame:
    """Return the runs of a result, best first.

    Parameters
    ----------
    result : FitResult
        The fit.

    Returns
    -------
    pandas.DataFrame
        Columns run, population, crossover, searched and polished (the objective before and after
        the polish), evaluations and seconds.
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
    )


def runs_drawing(result: FitResult) -> Drawing:
    """Draw what every run reached before and after the polish, best first: a waterfall.

    Parameters
    ----------
    result : FitResult
        The fit.

    Returns
    -------
    Drawing
        Its headline has the best objective and how many runs reached it within 0.1 %.
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
    axes.set(xlabel="run, best first", ylabel=result.objective.name, ylim=0)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.legend(loc="lower right")
    value, agreeing = basins(result)[0]
    caption = (
        f"The {len(table)} runs of the fit {result.name!r}, best first: {result.objective.name} "
        f"after the genetic search and after the polish. {agreeing} of them reached the best "
        "objective within 0.1 %."
    )
    return Drawing(figure, table, {"objective": value, "runs that reached it": agreeing}, caption)
