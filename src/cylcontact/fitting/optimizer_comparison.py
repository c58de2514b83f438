"""Compare optimisers on one campaign, with the same seeds, budget and polish."""

from __future__ import annotations

from collections.abc import Collection

import pandas as pd

from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.fitting.problem import ParameterSpace
from cylcontact.fitting.records import SAME_BASIN
from cylcontact.fitting.runs import run_all, searches
from cylcontact.fitting.table_campaign import TableCampaign
from cylcontact.parallel import Workers
from cylcontact.progress import Progress, silent
from cylcontact.text_tables import Table

CSV_COLUMNS = ("optimizer", "run", "seed", "searched", "polished", "evaluations", "seconds")


def compare_optimizers(
    campaign: Campaign | TableCampaign,
    optimizers: Collection[str] = OPTIMIZERS,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Return a row for each run of each optimiser, with the columns `CSV_COLUMNS`.

    "searched" and "polished" are the objectives before the polish and after it.
    """
    for optimizer in optimizers:
        OPTIMIZERS[optimizer].require_installed(campaign.source, optimizer)
    if isinstance(campaign, TableCampaign):
        problem: ParameterSpace = campaign.fit()
    else:
        problem, _ = problem_of(campaign, jobs, progress)
    spec, rows = campaign.spec, []
    for optimizer in optimizers:

        def report(_: str, done: int, total: int, name: str = optimizer) -> None:
            progress(name, done, total)

        calls = searches(problem, optimizer, spec.genetic, spec.seed, campaign.source)
        for run in run_all(calls, jobs, report, None, False):
            objectives = run.objective_before_polish, run.objective
            rows.append((optimizer, run.index, run.seed, *objectives, run.evaluations, run.seconds))
    return pd.DataFrame(rows, columns=list(CSV_COLUMNS))


def as_text(runs: pd.DataFrame) -> str:
    """Return a table of the optimisers, with how many runs are within 0.1 % of the best of all."""
    limit = runs["polished"].min() * (1 + SAME_BASIN) + 1e-12
    head = ("optimizer", "best", "median", "evaluations a run", "seconds a run")
    rows = [
        (
            str(optimizer),
            f"{own['polished'].min():.6g}",
            f"{own['polished'].median():.6g}",
            f"{own['evaluations'].median():,.0f}",
            f"{own['seconds'].median():.2f}",
            *(f"{(own[step] <= limit).sum()}/{len(own)}" for step in ("searched", "polished")),
        )
        for optimizer, own in runs.groupby("optimizer", sort=False)
    ]
    return str(Table((*head, "in best basin, searched", "polished"), rows))
