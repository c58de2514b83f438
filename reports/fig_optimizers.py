"""Four optimisers on the calibration for internal contact: the objective of every run."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from cylcontact.errors import InputError
from cylcontact.fitting.assessment import SAME_BASIN
from cylcontact.fitting.optimizer_comparison import CSV_COLUMNS
from cylcontact.plots.figure import Drawing, StyledFigure, new_figure, panel_title
from cylcontact.plots.style import COLOURS, MARKERS, QUIET
from cylcontact.reports.bench import Bench

CAMPAIGN = "internal"
CAPTION = (
    "Objective of every run, RMS of ln(δ/δ_Johnson), above the best that any run found (%), best "
    "run first, for the campaign 'internal': {runs} runs of each optimiser with the same seeds, "
    "about {evaluations:,.0f} candidates a run and the same local polish. The axis is linear below "
    "0.001 % and logarithmic above. Grey band: within 0.1 % of the best, what counts as the same "
    "basin. Least squares and CMA-ES start anew where they have converged, until the budget is "
    "spent. Budgets and settings are ours; the paper used a genetic search only."
)
# Excesses below this, in percent, are drawn as zero.
FLOOR = 1e-3
# Distance between the optimisers of one place, in places.
APART = 0.18
STEPS = {"searched": "after the search", "polished": "after the polish"}


def draw(bench: Bench) -> Drawing:
    runs = optimizer_runs(bench, CAMPAIGN)
    table = _table(runs)
    headline = {"best objective": float(runs["polished"].min())}
    for optimizer, share in _in_best_basin(runs).items():
        headline[f"{optimizer}: share of runs in the best basin"] = share
    caption = CAPTION.format(
        runs=runs["run"].nunique(), evaluations=float(runs["evaluations"].median())
    )
    return Drawing(_draw_panels(table), table, headline, caption)


def optimizer_runs(bench: Bench, campaign: str) -> pd.DataFrame:
    """Read the runs that `cylcontact fit --optimizer all` wrote, without the timings."""
    path = bench.result_file(f"optimizers-{campaign}.csv")
    remedy = f"make it with: cylcontact fit fitting/{campaign}.toml --optimizer all -o {path}"
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
    """Draw the waterfalls of a table, one panel after the search and one after the polish."""
    figure = new_figure("full", 70.0)
    panels = figure.subplots(1, 2, sharey=True)
    for number, (axes, (step, title)) in enumerate(zip(panels, STEPS.items(), strict=True)):
        _draw_runs(axes, table[table["step"] == step])
        panel_title(axes, number, title)
    panels[0].set_ylabel("objective above the best found (%)")
    panels[1].legend(loc="upper left")
    return figure


def _draw_runs(axes: Axes, table: pd.DataFrame) -> None:
    """Draw every optimiser's runs, best first."""
    optimizers = table["optimizer"].nunique()
    axes.axhspan(0, 100 * SAME_BASIN, color="0.9", linewidth=0)
    for number, (optimizer, runs) in enumerate(table.groupby("optimizer", sort=False)):
        # No lines: across the linear part of the axis they would suggest slopes. The optimisers
        # are side by side at each place, so that those at zero do not hide each other.
        axes.plot(
            runs["place"] + APART * (number - (optimizers - 1) / 2),
            runs["excess_percent"].where(runs["excess_percent"] > FLOOR, 0.0),
            color=COLOURS[number],
            linestyle="none",
            marker=MARKERS[number],
            label=str(optimizer),
        )
    axes.set_yscale("symlog", linthresh=FLOOR)
    axes.set_ylim(-0.3 * FLOOR, 300)
    axes.set_yticks(
        [0, 1e-3, 1e-2, 0.1, 1, 10, 100], ["0", "0.001", "0.01", "0.1", "1", "10", "100"]
    )
    axes.axhline(0, color=QUIET, linewidth=0.5, linestyle="-", marker="")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("run, best first")
