"""The optimisers on the calibration for internal contact: the objective of every run."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.ticker import MultipleLocator

from cylcontact.fitting.comparison import CSV_COLUMNS
from cylcontact.fitting.records import SAME_BASIN
from cylcontact.plots.figure import (
    Drawing,
    StyledFigure,
    legend_below,
    new_figure,
    panel_title,
    plain_log,
)
from cylcontact.plots.style import COLOURS, MARKERS
from cylcontact.reports.bench import Bench
from cylcontact.support.errors import InputError

CAMPAIGN = "internal"
CAPTION = (
    "Objective of every run above the best that any run found (%), best run first, before and "
    "after a local polish, for {optimizers} optimisers on the calibration for internal contact: "
    "{runs} runs each, with a median of {evaluations:,.0f} candidates. Grey: within 0.1 % of the "
    "best. Excesses below 0.001 % are drawn on the lower edge."
)
METHOD = (
    "The campaign is 'internal' and its objective the root mean square of ln(δ/δ_Johnson). All "
    "optimisers have the same seeds, the same budget and the same local polish. Least squares and "
    "CMA-ES start anew where they have converged, until the budget is spent; descents alone do not "
    "search. Budgets and settings are ours; the paper used a genetic search only."
)
# Excesses below this, in percent, are drawn at it.
FLOOR = 1e-3
# What the panels call the optimisers.
NAMES = {
    "genetic": "genetic search",
    "differential-evolution": "differential evolution",
    "least-squares": "least squares",
    "descents": "descents alone",
    "cma": "CMA-ES",
}
# The mark after the polish is inside the one before it where the polish gains nothing.
SIZES = (1.4, 0.6)
STEPS = {"searched": "before the polish", "polished": "after the polish"}


def draw(bench: Bench) -> Drawing:
    runs = optimizer_runs(bench, CAMPAIGN)
    table = _table(runs)
    headline = {"best objective": float(runs["polished"].min())}
    for optimizer, share in _in_best_basin(runs).items():
        headline[f"{optimizer}: share of runs in the best basin"] = share
    caption = CAPTION.format(
        optimizers=runs["optimizer"].nunique(),
        runs=runs["run"].nunique(),
        evaluations=float(runs["evaluations"].median()),
    )
    return Drawing(_draw_panels(table), table, headline, caption, METHOD)


def optimizer_runs(bench: Bench, campaign: str) -> pd.DataFrame:
    """Read the runs that `cylcontact optimizers` wrote, without the timings."""
    path = bench.result_file(f"optimizers-{campaign}.csv")
    remedy = f"make it with: cylcontact optimizers fitting/{campaign}.toml -o {path}"
    _require(path.is_file(), path, "this comparison does not exist", remedy)
    try:
        runs = pd.read_csv(path)
    except ValueError:
        runs = pd.DataFrame()
    _require(tuple(runs.columns) == CSV_COLUMNS, path, "is not a comparison of optimisers", remedy)
    return runs.drop(columns="seconds")


def _require(holds: bool, path: Path, rule: str, remedy: str) -> None:
    if not holds:
        raise InputError(str(path), "", None, rule, remedy)


def _table(runs: pd.DataFrame) -> pd.DataFrame:
    """Return every optimiser's runs, best first, with their excess over the best of all."""
    best = runs["polished"].min()
    tables = []
    for optimizer in runs["optimizer"].unique():
        for step in STEPS:
            objective = runs.loc[runs["optimizer"] == optimizer, step].sort_values()
            tables.append(
                pd.DataFrame(
                    {
                        "optimizer": optimizer,
                        "step": step,
                        "place": range(1, len(objective) + 1),
                        "objective": objective.to_numpy(),
                        "excess_percent": 100 * (objective.to_numpy() / best - 1),
                    }
                )
            )
    return pd.concat(tables, ignore_index=True)


def _in_best_basin(runs: pd.DataFrame) -> dict[str, float]:
    """Return the share of each optimiser's runs within 0.1 % of the best of all."""
    limit = runs["polished"].min() * (1 + SAME_BASIN)
    shares = (runs["polished"] <= limit).groupby(runs["optimizer"], sort=False).mean()
    return {str(name): float(share) for name, share in shares.items()}


def _draw_panels(table: pd.DataFrame) -> StyledFigure:
    """Draw the waterfalls of a table, a panel for each optimiser."""
    optimizers = table["optimizer"].unique()
    figure = new_figure("full", 62.0)
    panels = figure.subplots(1, len(optimizers), sharey=True)
    for number, (axes, optimizer) in enumerate(zip(panels, optimizers, strict=True)):
        _draw_runs(axes, table[table["optimizer"] == optimizer])
        panel_title(axes, number, NAMES.get(optimizer, optimizer))
    panels[0].set_ylim(FLOOR, max(100.0, 1.2 * table["excess_percent"].max()))
    panels[0].set_ylabel("objective above the best found (%)")
    legend_below(panels[0], 2)
    return figure


def _draw_runs(axes: Axes, table: pd.DataFrame) -> None:
    """Draw one optimiser's runs, best first, before and after the polish."""
    axes.axhspan(0.1 * FLOOR, 100 * SAME_BASIN, color="0.9", linewidth=0)
    for number, (step, label) in enumerate(STEPS.items()):
        runs = table[table["step"] == step]
        axes.plot(
            runs["place"],
            runs["excess_percent"].clip(lower=FLOOR),
            color=COLOURS[number],
            markersize=SIZES[number] * rcParams["lines.markersize"],
            linestyle="none",
            marker=MARKERS[number],
            label=label,
            clip_on=False,
            zorder=3,
        )
    plain_log(axes, "y", (1e-3, 1e-2, 0.1, 1, 10, 100, 1000))
    axes.set_xlabel("run, best first")
    axes.xaxis.set_major_locator(MultipleLocator(5))
