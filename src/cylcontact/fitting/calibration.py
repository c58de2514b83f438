"""Run a campaign: search, polish, and say what the result is worth.

A grid and a table of measurements differ in the problem to minimise and in what the best
coefficients are worth; a table also in its searches, if no optimiser is named.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from cylcontact.datasets.grid import AnyGrid
from cylcontact.datasets.moments import Moments
from cylcontact.datasets.sampling import Counts, reduce_grid
from cylcontact.errors import InputError
from cylcontact.fitting.campaign import Campaign, TableData, grid_of
from cylcontact.fitting.measured_fit import (
    descents,
    largest_percent,
    measured_problem,
    require_increasing,
)
from cylcontact.fitting.measured_objective import measured
from cylcontact.fitting.noise_fit import at_best
from cylcontact.fitting.objectives import (
    ON_ROWS,
    RmsLogPenetration,
    make_objective,
    max_abs_difference_percent,
)
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.fitting.polish import minimise
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.records import (
    MaxDifference,
    ObjectiveValue,
    Published,
    RunRecord,
    SampleCounts,
)
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.samples import Samples, collect_samples
from cylcontact.fitting.specs import CampaignSpec
from cylcontact.fitting.uncertainty.estimates import Uncertainty, uncertainty_of
from cylcontact.fitting.uncertainty.law_profiles import Profile, profiles
from cylcontact.journal import Journal
from cylcontact.parallel import Call, Workers, call, call_for, collect, run_recorded
from cylcontact.progress import Progress, silent
from cylcontact.spec import parse_spec

# Every worker keeps all samples in memory, 24 bytes each.
_MAX_ROWS = 20_000_000
# Descents to so few measurements take less than a second.
_FEW_ROWS = 2_000
# Sets of coefficients evaluated at a time until the law is defined for one.
_TRIED = 64


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
        OPTIMIZERS[campaign.spec.optimizer].require_installed(
            campaign.source, campaign.spec.optimizer
        )
    elif isinstance(jobs, int) and _is_quick(campaign):
        jobs = 1  # starting the workers would take longer
    provenance = campaign.provenance  # of what is run, not of what is there when it ends
    problem, counts = problem_of(campaign, jobs, progress)
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    records = search_all(problem, campaign, jobs, progress, journal, resume)
    best = min(records, key=lambda record: (record.objective, record.index))
    published = _published(problem)
    compared = [best.coefficients] + ([published.coefficients] if published else [])
    if campaign.data.kind == "noise":
        problem = at_best(problem, best.coefficients)
    way = _WAYS[campaign.data.kind]
    largest = way.largest_percent(campaign, compared, jobs, progress)
    quality = way.quality(campaign, problem, compared, jobs, progress)
    result = FitResult(
        name=campaign.name,
        law=campaign.model.law,
        contact=campaign.model.contact,
        reference=campaign.data.reference,
        coefficients=best.coefficients,
        objective=ObjectiveValue(name=campaign.objective, value=best.objective),
        published=published,
        max_abs_diff_percent=MaxDifference(
            fitted=largest[0], published=largest[1] if published else None
        ),
        runs=records,
        counts=SampleCounts(samples=counts.samples, masked=counts.masked),
        settings=campaign.settings,
        provenance=provenance,
        kind=campaign.data.kind,
        bound=quality.bound,
        profiles=quality.profiles,
        uncertainty=quality.uncertainty,
    )
    return result.with_problem(problem) if campaign.data.kind == "noise" else result


def _is_quick(campaign: Campaign) -> bool:
    """Return whether a fit to a table takes less time than starting worker processes does."""
    return isinstance(campaign.data, TableData) and len(campaign.data.measurements) <= _FEW_ROWS


def problem_of(campaign: Campaign, jobs: Workers, progress: Progress) -> tuple[Problem, Counts]:
    """Return the problem of a campaign and the number of its samples, used and masked."""
    return _WAYS[campaign.data.kind].problem(campaign, jobs, progress)


# --- what differs between a grid and a table ----------------------------------------------------


@dataclass(frozen=True)
class _Quality:
    """The bound, the profiles and the uncertainty of the best coefficients, where there are any."""

    bound: float | None = None
    profiles: dict[str, Profile] = field(default_factory=dict)
    uncertainty: Uncertainty | None = None


@dataclass(frozen=True)
class _Way:
    """The steps of a calibration that differ between a grid and a table of measurements."""

    # From the campaign, workers and progress to the problem and the number of samples.
    problem: Callable[[Campaign, Workers, Progress], tuple[Problem, Counts]]
    # The largest |Eq 9| over the data in percent for each of several sets of coefficients.
    largest_percent: Callable[
        [Campaign, list[dict[str, float]], Workers, Progress], Sequence[float | None]
    ]
    # The quality of the first of several sets of coefficients, the second being the published.
    quality: Callable[[Campaign, Problem, list[dict[str, float]], Workers, Progress], _Quality]


def _problem_on_grid(
    campaign: Campaign, jobs: Workers, progress: Progress
) -> tuple[Problem, Counts]:
    """Sample the reference law, or reduce its samples to moments."""
    grid, name = grid_of(campaign), campaign.objective
    samples: Moments | Samples
    if campaign.model.power_form is not None and name not in ON_ROWS:
        samples, counts = reduce_grid(grid, jobs, _by_clearance(progress, "sampling", grid))
    else:
        _require_few(grid, campaign)
        samples, counts = collect_samples(grid)
    problem = Problem(campaign.model, campaign.parameters, make_objective(name, samples))
    _require_defined_somewhere(problem, campaign.source)
    return problem, counts


def _by_clearance(progress: Progress, stage: str, grid: AnyGrid) -> Callable[[int], None]:
    """Return a function that reports how many clearances are done."""
    return lambda done: progress(stage, done, grid.dR.size)


def _require_few(grid: AnyGrid, campaign: Campaign) -> None:
    """Refuse a grid whose samples do not fit into memory."""
    if grid.size > _MAX_ROWS:
        moments = ", or use rms-log-penetration, which needs only moments"
        raise InputError(
            campaign.source,
            "objective",
            campaign.objective,
            f"keeps every sample in memory and the grid has {grid.size} (at most {_MAX_ROWS})",
            f"thin the grid{moments if campaign.model.power_form else ''}",
        )


def _require_defined_somewhere(problem: Problem, source: str) -> None:
    """Refuse bounds if the law is undefined at some sample for each of 4098 sets within them."""
    unit = np.random.default_rng(0).uniform(size=(1 << 12, len(problem.free)))
    corners = np.vstack([np.zeros(len(problem.free)), np.ones(len(problem.free)), unit])
    points = problem.low + corners * (problem.high - problem.low)
    some = (points[k : k + _TRIED] for k in range(0, len(points), _TRIED))
    if not any(np.isfinite(problem.values(part)).any() for part in some):
        raise InputError(
            source,
            "parameters",
            {p.name: [p.low, p.high] for p in problem.free},
            "within these bounds the law is undefined for some of the samples",
            "move the bounds; a power law needs a positive factor and n at every ΔR",
        )


def _largest_on_grid(
    campaign: Campaign, compared: list[dict[str, float]], jobs: Workers, progress: Progress
) -> list[float]:
    """Compare with every sample of the grid."""
    grid = grid_of(campaign)
    progress("comparing", 0, grid.dR.size)
    done = _by_clearance(progress, "comparing", grid)
    largest = max_abs_difference_percent(grid, campaign.model, compared, jobs, done)
    return [float(value) for value in largest]


def _quality_on_grid(
    campaign: Campaign,
    problem: Problem,
    compared: list[dict[str, float]],
    jobs: Workers,
    progress: Progress,
) -> _Quality:
    """Profile the objective over every free parameter, unless the campaign says not to."""
    best, *published = compared
    unwanted = isinstance(campaign.spec, CampaignSpec) and campaign.spec.profiles is False
    names = [] if unwanted else [p.name for p in problem.free]
    # One batch from moments; from rows a worker for each.
    is_batch = isinstance(problem.objective, RmsLogPenetration)
    groups = [names] * bool(names) if is_batch else [[name] for name in names]
    calls = [call(profiles, problem, group, best, next(iter(published), None)) for group in groups]
    progress("profiling", 0, len(calls))
    curves = collect(calls, 1 if is_batch else jobs, progress, "profiling")
    bound = problem.objective.bound if problem.model.power_form else None
    return _Quality(bound, {name: each for some in curves for name, each in some.items()})


def _problem_on_table(campaign: Campaign, *_: object) -> tuple[Problem, Counts]:
    """Compare with every row."""
    problem = measured_problem(campaign)
    return problem, Counts(len(measured(problem).data), 0)


def _largest_on_table(
    campaign: Campaign, compared: list[dict[str, float]], *_: object
) -> list[float | None]:
    """Compare with every row."""
    return [largest_percent(campaign, campaign.model.build(each)) for each in compared]


def _quality_on_table(
    _: Campaign,
    problem: Problem,
    compared: list[dict[str, float]],
    jobs: Workers,
    progress: Progress,
) -> _Quality:
    """Estimate the uncertainty from the noise."""
    progress("profiling", 0, 1)
    require_increasing(problem, compared[0])
    uncertainty = uncertainty_of(problem, compared[0], jobs=jobs)
    progress("profiling", 1, 1)
    return _Quality(uncertainty=uncertainty)


_WAYS: Mapping[str, _Way] = {
    "discrepancy": _Way(_problem_on_grid, _largest_on_grid, _quality_on_grid),
    "noise": _Way(_problem_on_table, _largest_on_table, _quality_on_table),
}


# --- the runs ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class RunPlan:
    """The index, settings and seed of a run."""

    index: int
    population: int
    generations: int
    crossover: str | None
    seed: int
    optimizer: str = "genetic"


def search_all(
    problem: Problem,
    campaign: Campaign,
    jobs: Workers,
    progress: Progress,
    journal: Journal | None = None,
    resume: bool = False,
) -> list[RunRecord]:
    """Execute the runs that the journal lacks, record each, and return all in order."""
    calls: dict[tuple[int, ...], Call] = {
        (index,): call_for(index, each) for index, each in enumerate(_calls(campaign, problem))
    }
    records = run_recorded(
        calls,
        journal,
        partial(_recorded_run, source=str(journal.path if journal else "")),
        lambda _, record: record.model_dump(),
        resume,
        jobs,
        partial(progress, "searching"),
    )
    return list(records.values())


def _calls(campaign: Campaign, problem: Problem) -> list[Call]:
    """Return the runs of a campaign as calls, each of which returns its RunRecord."""
    genetic, optimizer = campaign.spec.genetic, campaign.spec.optimizer
    if optimizer is None:
        return descents(campaign, problem)
    plans = plan_runs(
        genetic.runs,
        genetic.populations,
        genetic.crossovers,
        genetic.generations,
        campaign.spec.seed,
        optimizer,
    )
    return [call(execute, problem, plan, campaign.source) for plan in plans]


def _recorded_run(entry: Any, source: str) -> tuple[int, RunRecord]:
    """Return the index and the record of a run in a journal."""
    record = parse_spec(RunRecord, entry, source)
    return record.index, record


def plan_runs(
    runs: int,
    populations: tuple[int, ...],
    crossovers: tuple[str, ...],
    generations: int,
    seed: int,
    optimizer: str = "genetic",
) -> list[RunPlan]:
    """Return the runs of a campaign, with populations and crossovers in turn and spawned seeds.

    >>> for plan in plan_runs(3, (60, 120), ("uniform", "blend"), 300, seed=1):
    ...     print(plan.population, plan.crossover)
    60 uniform
    120 uniform
    60 blend
    """
    seeds = [int(child.generate_state(1)[0]) for child in np.random.SeedSequence(seed).spawn(runs)]
    return [
        RunPlan(
            index=index,
            population=populations[index % len(populations)],
            generations=generations,
            crossover=crossovers[index // len(populations) % len(crossovers)]
            if OPTIMIZERS[optimizer].has_crossover
            else None,
            seed=run_seed,
            optimizer=optimizer,
        )
        for index, run_seed in enumerate(seeds)
    ]


def execute(problem: Problem, plan: RunPlan, source: str = "campaign") -> RunRecord:
    """Search and polish on one thread, so that the result depends on the plan alone."""
    started = time.perf_counter()
    with threadpool_limits(limits=1):
        search = OPTIMIZERS[plan.optimizer].search
        best = search(problem, plan.population, plan.generations, plan.crossover, plan.seed)
        point, value = minimise(problem, best.point, plan.seed)
    if not np.isfinite(value):
        raise InputError(
            source,
            "genetic.populations",
            plan.population,
            f"run {plan.index} found no coefficients for which the law is defined",
            "narrow the parameters' bounds, or raise populations and generations",
        )
    return RunRecord(
        index=plan.index,
        seed=plan.seed,
        population=plan.population,
        crossover=plan.crossover,
        objective_before_polish=best.value,
        coefficients_before_polish=problem.coefficients(best.point),
        objective=value,
        coefficients=problem.coefficients(point),
        evaluations=best.evaluations,
        seconds=round(time.perf_counter() - started, 3),
    )


# --- what the best coefficients are worth -----------------------------------------------------


def _published(problem: Problem) -> Published | None:
    """Return the published coefficients and their objective on the same data, if it has one."""
    published = problem.model.published
    if published is None:
        return None
    value = problem.value_of(published)
    return Published(coefficients=dict(published), objective=value) if np.isfinite(value) else None
