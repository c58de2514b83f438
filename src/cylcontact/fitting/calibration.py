"""Fit a law to a law: sample the reference on a grid, search, descend, and profile."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from cylcontact.datasets.grid import Grid
from cylcontact.datasets.moments import Moments
from cylcontact.datasets.sampling import Counts, reduce_grid
from cylcontact.files.journal import Journal
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.objectives import (
    ON_ROWS,
    Problem,
    RmsLogPenetration,
    Samples,
    collect_samples,
    make_objective,
    max_abs_difference_percent,
)
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.fitting.profiles import profiles
from cylcontact.fitting.records import MaxDifference, ObjectiveValue, Profile, SampleCounts
from cylcontact.fitting.results import LawFit
from cylcontact.fitting.runs import best_of, published_on, run_all, searches
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call, collect
from cylcontact.support.progress import Progress, silent

# Sets of coefficients evaluated at a time until the law is defined for one.
_TRIED = 64


def calibrate(
    campaign: Campaign,
    jobs: Workers = 1,
    progress: Progress = silent,
    checkpoint: Path | None = None,
    resume: bool = False,
) -> LawFit:
    """Fit a law to a law: sample the grid, search, descend, and profile each coefficient.

    Parameters
    ----------
    campaign : Campaign
        From `Campaign.read`.
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
    LawFit

    Raises
    ------
    InputError
        If every sample is masked, the bounds exclude the law's domain, the optimiser's library
        is missing, or `checkpoint` belongs to another campaign.

    Examples
    --------
    Samples of the published external law recover its coefficients:

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
    >>> result = calibrate(Campaign.of_settings("recovery", settings, "example"))
    >>> print({name: round(value, 6) for name, value in result.coefficients.items()})
    {'a': 0.39, 'b': 0.85, 'n': 1.094}
    """
    spec = campaign.spec
    OPTIMIZERS[spec.optimizer].require_installed(campaign.source, spec.optimizer)
    provenance = campaign.provenance  # of what is run, not of what is there when it ends
    problem, counts = problem_of(campaign, jobs, progress)
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    calls = searches(problem, spec.optimizer, spec.genetic, spec.seed, campaign.source)
    records = run_all(calls, jobs, progress, journal, resume)
    best, published = best_of(records), published_on(problem)
    compared = [best.coefficients] + ([published.coefficients] if published else [])
    progress("comparing", 0, campaign.grid.dR.size)
    done = _by_clearance(progress, "comparing", campaign.grid)
    largest = max_abs_difference_percent(campaign.grid, campaign.model, compared, jobs, done)
    return LawFit(
        name=campaign.name,
        law=campaign.model.law,
        contact=campaign.model.contact,
        reference=campaign.reference,
        coefficients=best.coefficients,
        objective=ObjectiveValue(name=campaign.objective, value=best.objective),
        published=published,
        max_abs_diff_percent=MaxDifference(
            fitted=float(largest[0]), published=float(largest[1]) if published else None
        ),
        runs=records,
        counts=SampleCounts(samples=counts.samples, masked=counts.masked),
        settings=campaign.settings,
        provenance=provenance,
        bound=problem.objective.bound if problem.model.power_form else None,
        profiles={} if spec.profiles is False else _profiles(problem, compared, jobs, progress),
    )


def problem_of(
    campaign: Campaign, jobs: Workers = 1, progress: Progress = silent
) -> tuple[Problem, Counts]:
    """Return the problem of a campaign, and the number of its samples used and masked."""
    grid, name = campaign.grid, campaign.objective
    samples: Moments | Samples
    if campaign.model.power_form is not None and name not in ON_ROWS:
        samples, counts = reduce_grid(grid, jobs, _by_clearance(progress, "sampling", grid))
    else:
        samples, counts = collect_samples(grid)
    problem = Problem(campaign.model, campaign.parameters, make_objective(name, samples))
    _require_defined_somewhere(problem, campaign.source)
    return problem, counts


def _by_clearance(progress: Progress, stage: str, grid: Grid) -> Callable[[int], None]:
    return lambda done: progress(stage, done, grid.dR.size)


def _require_defined_somewhere(problem: Problem, source: str) -> None:
    """Refuse bounds if the law is undefined at some sample for each of 4098 sets within them."""
    unit = np.random.default_rng(0).uniform(size=(1 << 12, len(problem.free)))
    corners = np.vstack([np.zeros(len(problem.free)), np.ones(len(problem.free)), unit])
    points = problem.low + corners * (problem.high - problem.low)
    some = (points[k : k + _TRIED] for k in range(0, len(points), _TRIED))
    if not any(np.isfinite(problem.values(part)).any() for part in some):
        bounds = {p.name: [p.low, p.high] for p in problem.free}
        rule = "within these bounds the law is undefined for some of the samples"
        remedy = "move the bounds; a power law needs a positive factor and n at every ΔR"
        raise InputError(source, "parameters", bounds, rule, remedy)


def _profiles(
    problem: Problem, compared: list[dict[str, float]], jobs: Workers, progress: Progress
) -> dict[str, Profile]:
    best, *published = compared
    # One batch from moments; from rows a worker for each.
    is_batch = isinstance(problem.objective, RmsLogPenetration)
    groups = [problem.names] if is_batch else [[name] for name in problem.names]
    calls = [call(profiles, problem, group, best, next(iter(published), None)) for group in groups]
    progress("profiling", 0, len(calls))
    curves = collect(calls, 1 if is_batch else jobs, progress, "profiling")
    return {name: each for some in curves for name, each in some.items()}
