"""The runs of a fit side by side."""

from __future__ import annotations

import math

import pandas as pd

from cylcontact.fitting.results import LawFit
from cylcontact.plots.figure import Drawing, legend_below, new_figure
from cylcontact.plots.style import ACCENT, COLOURS, QUIET, figure_style
from cylcontact.support.plain_text import as_label

__all__ = ["runs_drawing", "runs_table"]


def runs_table(result: LawFit) -> pd.DataFrame:
    """Return the runs of a result, best first."""
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
    """Draw the objective of every run before and after the polish, best first."""
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
    axes.xaxis.get_major_locator().set_params(integer=True)  # type: ignore[call-arg]
    legend_below(axes)
    value, agreeing = result.basins()[0]
    caption = (
        f"The {len(table)} runs of the fit {result.name!r}, best first: {result.objective.name} "
        f"after the genetic search and after the polish. {agreeing} of them reached the best "
        "objective within 0.1 %."
    )
    return Drawing(figure, table, {"objective": value, "runs that reached it": agreeing}, caption)
