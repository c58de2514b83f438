"""Four optimisers on the calibration for internal contact: what each run reached."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.optimizers import (
    in_best_basin,
    optimizer_runs,
    waterfall_panels,
    waterfall_table,
)

CAMPAIGN = "internal"
CAPTION = (
    "Objective of every run, RMS of ln(δ/δ_Johnson), above the best that any run found (%), best "
    "run first, for the campaign 'internal': {runs} runs of each optimiser with the same seeds, "
    "about {evaluations:,.0f} candidates a run and the same local polish. The axis is linear below "
    "0.001 % and logarithmic above. Grey band: within 0.1 % of the best, what counts as the same "
    "basin. Least squares and CMA-ES start anew where they have converged, until the budget is "
    "spent. Budgets and settings are ours; the paper used a genetic search only."
)


def draw(bench: Bench) -> Drawing:
    runs = optimizer_runs(bench, CAMPAIGN)
    table = waterfall_table(runs)
    headline = {"best objective": float(runs["polished"].min())}
    for optimizer, share in in_best_basin(runs).items():
        headline[f"{optimizer}: share of runs in the best basin"] = share
    caption = CAPTION.format(
        runs=runs["run"].nunique(), evaluations=float(runs["evaluations"].median())
    )
    return Drawing(waterfall_panels(table), table, headline, caption)
