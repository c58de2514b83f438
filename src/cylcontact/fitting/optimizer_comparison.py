"""The optimisers side by side: the same campaign, the same budget, the same polish."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import median

from cylcontact.fitting.calibrate import problem_of, search_all
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.optimizers import OPTIMIZERS, require_installed
from cylcontact.fitting.run import RunRecord
from cylcontact.fitting.summary import text_table
from cylcontact.fitting.verdicts import SAME_BASIN, same_basin
from cylcontact.parallel import Workers
from cylcontact.progress import Progress, silent

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
    """The runs of one optimiser, in the order of the campaign.

    Attributes
    ----------
    optimizer : str
        Its name.
    records : tuple of RunRecord
        What each run found.
    """

    optimizer: str
    records: tuple[RunRecord, ...]


def compare_optimizers(
    campaign: Campaign,
    optimizers: Sequence[str] = OPTIMIZERS,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> list[OptimizerRuns]:
    """Run a campaign with several optimisers; seeds, budgets and polish are the same for all.

    Parameters
    ----------
    campaign : Campaign
        From `read_campaign`; the optimiser that it names plays no part.
    optimizers : sequence of str
        Some of `OPTIMIZERS`.
    jobs : int or Cluster
        Worker processes, or a Dask cluster; only the seconds depend on it.
    progress : callable, optional
        As for `calibrate`; the stages are the optimisers.

    Returns
    -------
    list of OptimizerRuns

    Raises
    ------
    InputError
        As `calibrate` does, and where an optimiser's library is missing.
    """
    for optimizer in optimizers:
        require_installed(optimizer, campaign.source)
    problem, _ = problem_of(campaign, jobs, progress)
    found = []
    for optimizer in optimizers:
        spec = campaign.spec.model_copy(update={"optimizer": optimizer})

        def show(_: str, done: int, total: int, name: str = optimizer) -> None:
            progress(name, done, total)

        records = search_all(problem, replace(campaign, spec=spec), jobs, show)
        found.append(OptimizerRuns(optimizer, tuple(records)))
    return found


def best_objective(compared: Sequence[OptimizerRuns]) -> float:
    """Return the least objective that any run of any optimiser reached."""
    return min(record.objective for runs in compared for record in runs.records)


def as_text(compared: Sequence[OptimizerRuns]) -> str:
    """Return one table of all optimisers.

    A run is in the best basin if its objective is within 0.1 % of the best of all runs of all
    optimisers, before the polish ("searched") or after it ("polished").
    """
    best = best_objective(compared)
    lines: list[tuple[str, ...]] = []
    for runs in compared:
        polished = [record.objective for record in runs.records]
        searched = [record.objective_before_polish for record in runs.records]
        lines.append(
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
    return text_table(_TEXT_COLUMNS, lines)


def as_csv(compared: Sequence[OptimizerRuns]) -> str:
    """Return every run of every optimiser, one line each, columns `CSV_COLUMNS`."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    for runs in compared:
        for record in runs.records:
            found = (record.objective_before_polish, record.objective)
            effort = (record.evaluations, record.seconds)
            writer.writerow([runs.optimizer, record.index, record.seed, *found, *effort])
    return stream.getvalue()
