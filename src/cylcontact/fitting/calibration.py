"""Run a campaign: search, polish, and say what the result is worth."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import numpy as np

from cylcontact.datasets.sampling import Counts
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.optimizers import require_installed
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.result import (
    FitResult,
    MaxDifference,
    ObjectiveValue,
    Published,
    SampleCounts,
)
from cylcontact.fitting.run import RunRecord
from cylcontact.journal import Journal
from cylcontact.parallel import Workers, run_calls
from cylcontact.progress import Progress, silent
from cylcontact.spec import parse_spec

__all__ = ["calibrate", "problem_of", "search_all"]


def calibrate(
    campaign: Campaign,
    jobs: Workers = 1,
    progress: Progress = silent,
    checkpoint: Path | None = None,
    resume: bool = False,
) -> FitResult:
    """Run a campaign.

    Parameters
    ----------
    campaign : Campaign
        From `read_campaign` or `campaign_of_table`.
    jobs : int or Cluster
        Worker processes, or a Dask cluster; the result does not depend on it.
    progress : callable, optional
        Called with the stage, how many of its parts are done, and their number.
    checkpoint : path, optional
        The journal of finished runs; the caller removes it once the result is saved.
    resume : bool
        Whether to take the runs already in `checkpoint` from there.

    Returns
    -------
    FitResult

    Raises
    ------
    InputError
        If every sample is masked, the bounds exclude the law's domain, the optimiser's library
        is missing, or `checkpoint` belongs to another campaign.

    Examples
    --------
    Samples of the published external law recover its coefficients:

    >>> from cylcontact.fitting.campaign import campaign_from_settings
    >>> span = {"points": 4, "spacing": "log"}
    >>> axes = {
    ...     "E": {"values": [207.0]},
    ...     "nu": {"values": [0.3]},
    ...     "dR": {"min": 5.0, "max": 500.0, **span},
    ...     "load": {"min": 10.0, "max": 1000.0, **span},
    ... }
    >>> bounds = {"a": (0.1, 1.5), "b": (0.1, 3.0), "n": (1.0, 1.5)}
    >>> campaign = {
    ...     "dataset": "inline",
    ...     "law": "enhanced",
    ...     "parameters": {k: {"low": low, "high": high} for k, (low, high) in bounds.items()},
    ...     "genetic": {"runs": 2, "populations": [20], "generations": 20},
    ... }
    >>> grid = {"contact": "external", "reference": "enhanced", "axes": axes}
    >>> settings = {"campaign": campaign, "dataset": grid}
    >>> result = calibrate(campaign_from_settings("recovery", settings, "example"))
    >>> print({name: round(value, 6) for name, value in result.coefficients.items()})
    {'a': 0.39, 'b': 0.85, 'n': 1.094}
    """
    if campaign.spec.optimizer is not None:
        require_installed(campaign.spec.optimizer, campaign.source)
    problem, counts = problem_of(campaign, jobs, progress)
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    records = search_all(problem, campaign, jobs, progress, journal, resume)
    best = min(records, key=lambda record: (record.objective, record.index))
    published = _published(problem)
    values = None if published is None else published.coefficients
    quality = campaign.data.quality(problem, best.coefficients, values, jobs, progress)
    return FitResult(
        name=campaign.name,
        law=campaign.model.law,
        contact=campaign.model.contact,
        reference=campaign.data.reference,
        coefficients=best.coefficients,
        objective=ObjectiveValue(name=campaign.objective, value=best.objective),
        bound=quality.bound,
        published=published,
        max_abs_diff_percent=MaxDifference(
            fitted=quality.largest_percent, published=quality.largest_percent_published
        ),
        profiles=quality.profiles,
        runs=records,
        counts=SampleCounts(samples=counts.samples, masked=counts.masked),
        settings=campaign.settings,
        provenance=campaign.provenance,
        kind=campaign.data.kind,
        uncertainty=quality.uncertainty,
    )


def problem_of(campaign: Campaign, jobs: Workers, progress: Progress) -> tuple[Problem, Counts]:
    """Return the problem of a campaign and the number of its samples.

    Parameters
    ----------
    campaign, jobs, progress
        As for `calibrate`.

    Returns
    -------
    problem : Problem
    counts : Counts
        Samples used and masked.

    Raises
    ------
    InputError
        If every sample is masked, or the bounds exclude the law's domain.
    """
    return campaign.data.problem(campaign, jobs, progress)


def search_all(
    problem: Problem,
    campaign: Campaign,
    jobs: Workers,
    progress: Progress,
    journal: Journal | None = None,
    resume: bool = False,
) -> list[RunRecord]:
    """Execute the runs that the journal lacks, record each, and return all in order.

    Parameters
    ----------
    problem : Problem
        From `problem_of`.
    campaign, jobs, progress
        As for `calibrate`.
    journal : Journal, optional
        The finished runs.
    resume : bool
        Whether to take the runs already in the journal from there.

    Returns
    -------
    list of RunRecord
    """
    calls = campaign.data.searches(campaign, problem)
    records = _recorded_runs(journal) if journal and resume else []
    if journal and not resume:
        journal.start()
    finished = {record.index for record in records}
    waiting = [each for index, each in enumerate(calls) if index not in finished]
    progress("searching", len(records), len(calls))
    with closing(run_calls(waiting, jobs, ordered=False)) as results:
        for record in results:
            if journal:
                journal.add(record.model_dump())
            records.append(record)
            progress("searching", len(records), len(calls))
    return sorted(records, key=lambda record: record.index)


def _recorded_runs(journal: Journal) -> list[RunRecord]:
    """Return the runs in a journal."""
    return journal.load(lambda entry: parse_spec(RunRecord, entry, str(journal.path)))


def _published(problem: Problem) -> Published | None:
    """Return the published coefficients and their objective on the same data, if it has one."""
    published = problem.model.published
    if published is None:
        return None
    value = problem.value_of(published)
    return Published(coefficients=dict(published), objective=value) if np.isfinite(value) else None
