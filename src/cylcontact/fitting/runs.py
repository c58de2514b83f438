"""The runs of a fit: each searches and descends on its own, and is recorded when it is done."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.fitting.measured import Fit
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.fitting.polish import minimise
from cylcontact.fitting.problem import Minimum, ParameterSpace
from cylcontact.fitting.records import Published, RunRecord
from cylcontact.fitting.specs import GeneticSpec
from cylcontact.journal import Journal
from cylcontact.parallel import Call, Workers, call, call_for, run_recorded
from cylcontact.progress import Progress
from cylcontact.spec import parse_spec


@dataclass(frozen=True)
class RunPlan:
    """The index, settings and seed of a run."""

    index: int
    population: int | None
    generations: int
    crossover: str | None
    seed: int
    optimizer: str = "genetic"


def searches(
    problem: ParameterSpace, optimizer: str, genetic: GeneticSpec, seed: int, source: str
) -> list[Call]:
    """Return the runs of an optimiser as calls, each of which returns its RunRecord."""
    plans = plan_runs(
        genetic.runs, genetic.populations, genetic.crossovers, genetic.generations, seed, optimizer
    )
    return [call(execute, problem, plan, source) for plan in plans]


def run_all(
    calls: Sequence[Call], jobs: Workers, progress: Progress, journal: Journal | None, resume: bool
) -> list[RunRecord]:
    """Execute the runs that the journal lacks, record each, and return all in order."""
    numbered: dict[tuple[int, ...], Call] = {
        (index,): call_for(index, each) for index, each in enumerate(calls)
    }
    records = run_recorded(
        numbered,
        journal,
        partial(_recorded, source=str(journal.path if journal else "")),
        lambda _, record: record.model_dump(),
        resume,
        jobs,
        partial(progress, "searching"),
    )
    return list(records.values())


def best_of(records: Sequence[RunRecord]) -> RunRecord:
    """Return the run of the lowest objective, the first of several."""
    return min(records, key=lambda record: (record.objective, record.index))


def published_on(problem: ParameterSpace) -> Published | None:
    """Return the published coefficients and their objective on the same data, if it has one."""
    published = problem.model.published
    if published is None:
        return None
    value = problem.value_of(published)
    return Published(coefficients=dict(published), objective=value) if np.isfinite(value) else None


def _recorded(entry: Any, source: str) -> tuple[int, RunRecord]:
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
    """Return the runs of a campaign, with populations, crossovers and seeds.

    All combinations of populations and crossovers take turns. Seeds are spawned from `seed`.
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


def execute(problem: ParameterSpace, plan: RunPlan, source: str = "campaign") -> RunRecord:
    """Search and polish on one thread, so that the result depends on the plan alone."""
    started = time.perf_counter()
    with threadpool_limits(limits=1):
        best = OPTIMIZERS[plan.optimizer].search(
            problem, plan.population or 0, plan.generations, plan.crossover, plan.seed
        )
        point, value = minimise(problem, best.point, plan.seed)
    if not np.isfinite(value):
        rule = f"run {plan.index} found no coefficients for which the law is defined"
        remedy = "narrow the parameters' bounds, or raise populations and generations"
        raise InputError(source, "genetic.populations", plan.population, rule, remedy)
    return record_of(problem, plan, best, Minimum(point, value, best.evaluations), started)


def descend_from(problem: Fit, start: FloatArray, index: int, seed: int) -> RunRecord:
    """Descend from one start on one thread and return the record of the run."""
    started, before = time.perf_counter(), Minimum(start, problem.value(start), 1)
    with threadpool_limits(limits=1):  # matrices this small are slower on several threads
        end = problem.minimise(start)
    return record_of(problem, RunPlan(index, None, 0, None, seed), before, end, started)


def record_of(
    problem: ParameterSpace, plan: RunPlan, before: Minimum, end: Minimum, started: float
) -> RunRecord:
    """Return what is kept of a run: where it was before its last descent, and where it ended."""
    return RunRecord(
        index=plan.index,
        seed=plan.seed,
        population=plan.population,
        crossover=plan.crossover,
        objective_before_polish=before.value,
        coefficients_before_polish=problem.coefficients(before.point),
        objective=end.value,
        coefficients=problem.coefficients(end.point),
        evaluations=end.evaluations,
        seconds=round(time.perf_counter() - started, 3),
    )
