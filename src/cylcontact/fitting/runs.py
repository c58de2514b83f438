"""The runs of a fit: each searches and descends on its own, and is recorded when it is done."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from cylcontact.files.journal import Journal, call_for, run_recorded
from cylcontact.files.spec import parse_spec
from cylcontact.fitting.measured import Fit
from cylcontact.fitting.records import Published, RunRecord
from cylcontact.fitting.search import Minimum, genetic_search, minimise
from cylcontact.fitting.space import Space
from cylcontact.fitting.specs import GeneticSpec
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Call, Workers, call
from cylcontact.support.progress import Progress


def searches(space: Space, genetic: GeneticSpec, seed: int, source: str = "campaign") -> list[Call]:
    """Return the runs of a campaign as calls, each of which returns its RunRecord."""
    children = np.random.SeedSequence(seed).spawn(genetic.runs)
    seeds = [int(child.generate_state(1)[0]) for child in children]
    return [call(run_search, space, genetic, index, own, source) for index, own in enumerate(seeds)]


def run_search(
    space: Space, genetic: GeneticSpec, index: int, seed: int, source: str = "campaign"
) -> RunRecord:
    """Search and descend on one thread, so that the result depends on the arguments alone.

    All combinations of populations and crossovers take turns.
    """
    started = time.perf_counter()
    turn, place = divmod(index, len(genetic.populations))
    population = genetic.populations[place]
    crossover = genetic.crossovers[turn % len(genetic.crossovers)]
    with threadpool_limits(limits=1):
        best = genetic_search(space, population, genetic.generations, crossover, seed)
        point, value = minimise(space, best.point, seed)
    if not np.isfinite(value):
        rule = f"run {index} found no coefficients for which the law is defined"
        remedy = "narrow the bounds, or raise populations and generations"
        raise InputError(source, "genetic.populations", population, rule, remedy)
    end = Minimum(point, value, best.evaluations)
    return _record(space, best, end, started, index, seed, population, crossover)


def descend_from(fit: Fit, start: FloatArray, index: int, seed: int) -> RunRecord:
    """Descend from one start on one thread and return the record of the run."""
    started, before = time.perf_counter(), Minimum(start, fit.value(start), 1)
    with threadpool_limits(limits=1):  # matrices this small are slower on several threads
        end = fit.minimise(start)
    return _record(fit, before, end, started, index, seed)


def _record(
    space: Space,
    before: Minimum,
    end: Minimum,
    started: float,
    index: int,
    seed: int,
    population: int | None = None,
    crossover: str | None = None,
) -> RunRecord:
    return RunRecord(
        index=index,
        seed=seed,
        population=population,
        crossover=crossover,
        objective_before_polish=before.value,
        coefficients_before_polish=space.coefficients(before.point),
        objective=end.value,
        coefficients=space.coefficients(end.point),
        evaluations=end.evaluations,
        seconds=round(time.perf_counter() - started, 3),
    )


def run_all(
    calls: Sequence[Call],
    jobs: Workers,
    progress: Progress,
    journal: Journal | None = None,
    resume: bool = False,
) -> list[RunRecord]:
    """Execute the runs that the journal lacks, record each, and return all in order."""
    source = str(journal.path) if journal else ""

    def recorded(entry: Any) -> tuple[int, RunRecord]:
        record = parse_spec(RunRecord, entry, source)
        return record.index, record

    records = run_recorded(
        {(index,): call_for(index, each) for index, each in enumerate(calls)},
        journal,
        recorded,
        lambda _, record: record.model_dump(),
        resume,
        jobs,
        partial(progress, "searching"),
    )
    return list(records.values())


def best_of(records: Sequence[RunRecord]) -> RunRecord:
    """Return the run of the lowest objective, the first of several."""
    return min(records, key=lambda record: (record.objective, record.index))


def published_on(space: Space) -> Published | None:
    """Return the published coefficients and their objective on the same data, if it has one."""
    published = space.model.published
    if published is None:
        return None
    value = space.value_of(published)
    return Published(coefficients=dict(published), objective=value) if np.isfinite(value) else None
