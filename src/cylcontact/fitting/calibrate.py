"""Run a campaign: sample the grid, search, polish and profile."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing
from pathlib import Path

from cylcontact.datasets.moments import Moments
from cylcontact.datasets.sampling import Counts, reduce_grid
from cylcontact.errors import InputError
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.max_difference import max_abs_difference_percent
from cylcontact.fitting.measured_campaign import MeasuredCampaign
from cylcontact.fitting.measured_fit import fit_measurements, robust_problem
from cylcontact.fitting.objectives import ON_ROWS, make_objective
from cylcontact.fitting.optimizers import require_installed
from cylcontact.fitting.planning import AnyCampaign, provenance
from cylcontact.fitting.problem import Problem, require_defined_somewhere
from cylcontact.fitting.profile import Profile, profile
from cylcontact.fitting.result import (
    FitResult,
    MaxDifference,
    ObjectiveValue,
    Published,
    SampleCounts,
)
from cylcontact.fitting.run import RunPlan, RunRecord, execute, plan_runs
from cylcontact.fitting.samples import Samples, collect_samples
from cylcontact.journal import Journal
from cylcontact.parallel import Workers, call, run_calls
from cylcontact.progress import Progress, silent
from cylcontact.spec import parse_spec

__all__ = ["calibrate", "problem_of", "search_all"]

# Every worker keeps all samples in memory, 24 bytes each.
_MAX_ROWS = 20_000_000


def calibrate(
    campaign: AnyCampaign,
    jobs: Workers = 1,
    progress: Progress = silent,
    checkpoint: Path | None = None,
    resume: bool = False,
) -> FitResult:
    """Run a campaign.

    Parameters
    ----------
    campaign : Campaign
        From `read_campaign`; one on measurements, from `read_plan`, takes seconds and has no
        journal.
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
    if isinstance(campaign, MeasuredCampaign):
        return fit_measurements(campaign, jobs, progress)
    require_installed(campaign.spec.optimizer, campaign.source)
    problem, counts = problem_of(campaign, jobs, progress)
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    records = search_all(problem, campaign, jobs, progress, journal, resume)
    best = min(records, key=lambda record: (record.objective, record.index))
    published = campaign.model.published
    return FitResult(
        name=campaign.name,
        law=campaign.model.law,
        contact=campaign.model.contact,
        reference=campaign.grid.reference,
        coefficients=best.coefficients,
        objective=ObjectiveValue(name=campaign.spec.objective, value=best.objective),
        bound=problem.objective.bound if campaign.model.power_form is not None else None,
        published=None
        if published is None
        else Published(coefficients=dict(published), objective=problem.value_of(published)),
        max_abs_diff_percent=_max_difference(campaign, best.coefficients, jobs, progress),
        profiles=_profiles(problem, best.coefficients, published, jobs, progress),
        runs=records,
        counts=SampleCounts(samples=counts.samples, masked=counts.masked),
        settings=campaign.settings,
        provenance=provenance(campaign),
    )


def problem_of(campaign: AnyCampaign, jobs: Workers, progress: Progress) -> tuple[Problem, Counts]:
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
    if isinstance(campaign, MeasuredCampaign):
        return robust_problem(campaign), Counts(len(campaign.measurements), 0)
    data, counts = _data(campaign, jobs, progress)
    objective = make_objective(campaign.spec.objective, data)
    problem = Problem(campaign.model, campaign.parameters, objective)
    require_defined_somewhere(problem, campaign.source)
    return problem, counts


def _data(
    campaign: Campaign, jobs: Workers, progress: Progress
) -> tuple[Moments | Samples, Counts]:
    """Sample the campaign's grid: moments where the objective allows, else rows."""
    grid = campaign.grid
    if campaign.model.power_form is not None and campaign.spec.objective not in ON_ROWS:
        return reduce_grid(grid, jobs, lambda done: progress("sampling", done, grid.dR.size))
    if grid.size > _MAX_ROWS:
        raise InputError(
            campaign.source,
            "objective",
            campaign.spec.objective,
            f"keeps every sample in memory and the grid has {grid.size} (at most {_MAX_ROWS})",
            "thin the grid, or use rms-log-penetration, which needs only moments",
        )
    return collect_samples(grid)


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
    genetic = campaign.spec.genetic
    plans = plan_runs(
        genetic.runs,
        genetic.populations,
        genetic.crossovers,
        genetic.generations,
        campaign.spec.seed,
        campaign.spec.optimizer,
    )
    records = _recorded_runs(journal) if journal and resume else []
    if journal and not resume:
        journal.start()
    finished = {record.index for record in records}
    waiting: list[RunPlan] = [plan for plan in plans if plan.index not in finished]
    progress("searching", len(records), len(plans))
    searches = [call(execute, problem, plan, campaign.source) for plan in waiting]
    with closing(run_calls(searches, jobs, ordered=False)) as results:
        for record in results:
            if journal:
                journal.add(record.model_dump())
            records.append(record)
            progress("searching", len(records), len(plans))
    return sorted(records, key=lambda record: record.index)


def _recorded_runs(journal: Journal) -> list[RunRecord]:
    """Return the runs in a journal."""
    return journal.load(lambda entry: parse_spec(RunRecord, entry, str(journal.path)))


def _profiles(
    problem: Problem,
    best: Mapping[str, float],
    published: Mapping[str, float] | None,
    jobs: Workers,
    progress: Progress,
) -> dict[str, Profile]:
    """Profile every free parameter."""
    names = [p.name for p in problem.free]
    work = [
        call(profile, problem, name, best, published[name] if published else None) for name in names
    ]
    profiles = {}
    progress("profiling", 0, len(names))
    with closing(run_calls(work, jobs)) as curves:
        for name, curve in zip(names, curves, strict=True):
            profiles[name] = curve
            progress("profiling", len(profiles), len(names))
    return profiles


def _max_difference(
    campaign: Campaign, best: Mapping[str, float], jobs: Workers, progress: Progress
) -> MaxDifference:
    """Return the largest |Eq 9| over the grid, fitted and published."""
    model, published = campaign.model, campaign.model.published
    candidates = [best] if published is None else [best, published]
    grid = campaign.grid
    progress("comparing", 0, grid.dR.size)
    worst = max_abs_difference_percent(
        grid, model, candidates, jobs, lambda done: progress("comparing", done, grid.dR.size)
    )
    return MaxDifference(
        fitted=float(worst[0]), published=float(worst[1]) if published is not None else None
    )
