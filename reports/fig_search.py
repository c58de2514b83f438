"""What the genetic search finds by itself, before the local polish, in every run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from cylcontact.fitting.result import FitResult
from cylcontact.pair import CONTACTS
from cylcontact.plots.figure import Drawing, StyledFigure, new_figure, panel_title
from cylcontact.plots.style import COLOURS, MARKERS
from cylcontact.reports.bench import Bench

CAPTION = (
    "Coefficients of every run of the genetic search before any polish: how far each is from the "
    "best polished one of the same campaign (%, absolute; 0.001 and below are drawn at 0.001). "
    "Synthetic: samples of the published law itself, all coefficients searched. Recovered: "
    "Johnson's law, two coefficients searched, the others held or tied. Refit: Johnson's law, all "
    "coefficients searched. Populations, generations and bounds are ours."
)
# The campaigns of each contact, and what the legend calls them.
CAMPAIGNS = {"synthetic": "synthetic", "recovered": "recovered", "": "refit"}
FLOOR = 1e-3  # percent
APART = 0.26


def draw(bench: Bench) -> Drawing:
    table = pd.concat(
        [
            runs(bench.result(f"{campaign}-{contact}".removeprefix("-"))).assign(
                contact=contact, kind=label
            )
            for contact in CONTACTS
            for campaign, label in CAMPAIGNS.items()
        ],
        ignore_index=True,
    )
    headline: dict[str, float] = {}
    for name, rows in table.groupby("campaign", sort=False):
        away = rows.filter(like="_away_percent")
        headline |= {
            f"{name}: runs": float(len(rows)),
            f"{name}: largest excess of a search, %": rows["excess_percent"].max(),
            f"{name}: median distance of a coefficient, %": float(np.nanmedian(away)),
            f"{name}: largest distance of a coefficient, %": float(np.nanmax(away)),
        }
    return Drawing(_draw_panels(table), table, headline, CAPTION)


def runs(result: FitResult) -> pd.DataFrame:
    """Return what the search of each run reached before the polish.

    Parameters
    ----------
    result : FitResult
        Of a campaign.

    Returns
    -------
    pandas.DataFrame
        A row for each run: the objective before and after the polish, the excess of the search
        over the best polished objective in percent, and each coefficient searched with its
        distance from the best polished one in percent.
    """
    return pd.DataFrame([_row(result, index) for index in range(len(result.runs))])


def _row(result: FitResult, index: int) -> dict[str, Any]:
    """Return one run."""
    run = result.runs[index]
    row: dict[str, Any] = {
        "campaign": result.name,
        "run": run.index,
        "population": run.population,
        "crossover": run.crossover,
        "evaluations": run.evaluations,
        "searched": run.objective_before_polish,
        "polished": run.objective,
        "excess_percent": 100 * (run.objective_before_polish / result.objective.value - 1),
    }
    for name in result.profiles:
        value, best = run.coefficients_before_polish[name], result.coefficients[name]
        row |= {name: value, f"{name}_away_percent": 100 * abs(value / best - 1)}
    return row


def _draw_panels(table: pd.DataFrame) -> StyledFigure:
    """Draw a panel for each contact, as wide as it has coefficients."""
    names = {contact: _searched(table, contact) for contact in CONTACTS}
    figure = new_figure("full", 80.0)
    widths = [len(names[contact]) for contact in CONTACTS]
    panels = figure.subplots(1, 2, sharey=True, gridspec_kw={"width_ratios": widths})
    for number, (axes, contact) in enumerate(zip(panels, CONTACTS, strict=True)):
        _draw_runs(axes, table[table["contact"] == contact], names[contact])
        panel_title(axes, number, f"{contact} contact")
    panels[0].set_ylabel("distance from the best polished value (%)")
    panels[0].legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3)
    return figure


def _searched(table: pd.DataFrame, contact: str) -> list[str]:
    """Return the coefficients that some campaign of a contact searches."""
    rows = table[table["contact"] == contact].filter(like="_away_percent")
    return [str(name).removesuffix("_away_percent") for name in rows.dropna(axis=1, how="all")]


def _draw_runs(axes: Axes, table: pd.DataFrame, names: list[str]) -> None:
    """Draw each run's distances, the campaigns side by side at every coefficient."""
    for number, (kind, rows) in enumerate(table.groupby("kind", sort=False)):
        away = rows[[f"{name}_away_percent" for name in names]].to_numpy()
        places = np.arange(len(names)) + APART * (number - 1)
        axes.plot(
            np.broadcast_to(places, away.shape).ravel(),
            np.maximum(away, FLOOR).ravel(),
            color=COLOURS[number],
            marker=MARKERS[number],
            linestyle="none",
            label=kind,
        )
    axes.set(yscale="log", ylim=(0.6 * FLOOR, 5e3), xlim=(-0.6, len(names) - 0.4))
    axes.set_xticks(range(len(names)), ["\n".join(name.rsplit("_", 1)) for name in names])
    axes.tick_params(axis="x", length=0)
    axes.grid(axis="y", linewidth=0.4, color="0.9")
