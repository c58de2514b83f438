"""Compare optimisers on one campaign, with the same budget and polish."""

from __future__ import annotations

import csv
import io
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from statistics import median

from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.fitting.problem import ParameterSpace
from cylcontact.fitting.records import SAME_BASIN, RunRecord, same_basin
from cylcontact.fitting.runs import run_all, searches
from cylcontact.fitting.table_campaign import TableCampaign
from cylcontact.parallel import Workers
from cylcontact.progress import Progress, silent
from cylcontact.text_tables import Table

CSV_COLUMNS = ("optimizer", "run", "seed", "searched", "polished", "evaluations", "seconds")
_TEXT_COLUMNS = (
    "optimizer",
    "best",
    "median",
    "evaluations a run",
    "seconds a run",
    "in best basin, searched",
    "polished",
)


@dataclass(frozen=True)
class OptimizerRuns:
    """The runs of one optimiser, in the order of the campaign."""

    optimizer: str
    records: tuple[RunRecord, ...]


def compare_optimizers(
    campaign: Campaign | TableCampaign,
    optimizers: Collection[str] = OPTIMIZERS,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> list[OptimizerRuns]:
    """Run a campaign with several optimisers, with the same seeds, budget and polish.

    The optimisers are the stages of the progress.
    """
    for optimizer in optimizers:
        OPTIMIZERS[optimizer].require_installed(campaign.source, optimizer)
    problem: ParameterSpace
    if isinstance(campaign, TableCampaign):
        problem = campaign.fit()
    else:
        problem, _ = problem_of(campaign, jobs, progress)
    spec = campaign.spec
    compared = []
    for optimizer in optimizers:

        def report(_: str, done: int, total: int, name: str = optimizer) -> None:
            progress(name, done, total)

        calls = searches(problem, optimizer, spec.genetic, spec.seed, campaign.source)
        records = run_all(calls, jobs, report, None, False)
        compared.append(OptimizerRuns(optimizer, tuple(records)))
    return compared


def best_objective(compared: Sequence[OptimizerRuns]) -> float:
    """Return the lowest objective of all runs."""
    return min(record.objective for runs in compared for record in runs.records)


def as_text(compared: Sequence[OptimizerRuns]) -> str:
    """Return a table of the optimisers.

    A run is in the best basin if its objective is within 0.1 % of the best of all runs, before
    the polish ("searched") or after it ("polished").
    """
    best = best_objective(compared)
    rows: list[tuple[str, ...]] = []
    for runs in compared:
        polished = [record.objective for record in runs.records]
        searched = [record.objective_before_polish for record in runs.records]
        rows.append(
            (
                runs.optimizer,
                f"{min(polished):.6g}",
                f"{median(polished):.6g}",
                f"{median(record.evaluations for record in runs.records):,.0f}",
                f"{median(record.seconds for record in runs.records):.2f}",
                f"{sum(value <= best * (1 + SAME_BASIN) for value in searched)}/{len(searched)}",
                f"{sum(same_basin(r, best) for r in runs.records)}/{len(polished)}",
            )
        )
    return str(Table(_TEXT_COLUMNS, rows))


def as_csv(compared: Sequence[OptimizerRuns]) -> str:
    """Return one line for each run, with the columns `CSV_COLUMNS`."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    for runs in compared:
        for record in runs.records:
            objectives = (record.objective_before_polish, record.objective)
            effort = (record.evaluations, record.seconds)
            writer.writerow([runs.optimizer, record.index, record.seed, *objectives, *effort])
    return stream.getvalue()
