"""The runs of a fit: each searches and descends on its own, and is recorded when it is done."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from typing import Any, TypeVar

import numpy as np

from cylcontact.files.journal import Journal, call_for, run_recorded
from cylcontact.files.spec import parse_spec
from cylcontact.fitting.readings import Fit
from cylcontact.fitting.records import Published, RunRecord, SearchRecord
from cylcontact.fitting.search import genetic_search, polish
from cylcontact.fitting.space import Space
from cylcontact.fitting.specs import GeneticSpec
from cylcontact.support.arrays import FloatArray, on_one_thread
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Call, Workers, call
from cylcontact.support.progress import Progress

_Record = TypeVar("_Record", bound=RunRecord)


def searches(space: Space, genetic: GeneticSpec, seed: int, source: str = "campaign") -> list[Call]:
    """Return the runs of a campaign as calls, each of which returns its SearchRecord."""
    children = np.random.SeedSequence(seed).spawn(genetic.runs)
    seeds = [int(child.generate_state(1)[0]) for child in children]
    return [call(run_search, space, genetic, index, own, source) for index, own in enumerate(seeds)]


def run_search(
    space: Space, genetic: GeneticSpec, index: int, seed: int, source: str = "campaign"
) -> SearchRecord:
    """Search and descend on one thread, so that the result depends on the arguments alone."""
    started = time.perf_counter()
    with on_one_thread():
        best = genetic_search(space, genetic.population, genetic.generations, seed)
        end = polish(space, best.point)
    if not np.isfinite(end[1]):
        rule = f"run {index} found no coefficients for which the law is defined"
        remedy = "narrow the bounds, or raise population and generations"
        raise InputError(source, "genetic.population", genetic.population, rule, remedy)
    return SearchRecord(
        **_of_run(space, end, started, index, seed),
        population=genetic.population,
        evaluations=best.evaluations,
        objective_before_polish=best.value,
        coefficients_before_polish=space.coefficients(best.point),
    )


def descend_from(fit: Fit, start: FloatArray, index: int, seed: int) -> RunRecord:
    """Descend from one start on one thread and return the record of the run."""
    started = time.perf_counter()
    with on_one_thread():  # matrices this small are slower on several threads
        end = fit.minimise(start)
    return RunRecord(**_of_run(fit, end, started, index, seed))


def _of_run(
    space: Space, end: tuple[FloatArray, float], started: float, index: int, seed: int
) -> dict[str, Any]:
    return {
        "index": index,
        "seed": seed,
        "objective": end[1],
        "coefficients": space.coefficients(end[0]),
        "seconds": round(time.perf_counter() - started, 3),
    }


def run_all(
    calls: Sequence[Call],
    kind: type[_Record],
    jobs: Workers,
    progress: Progress,
    journal: Journal | None = None,
    resume: bool = False,
) -> list[_Record]:
    """Execute the runs that the journal lacks, record each, and return all in order."""
    source = str(journal.path) if journal else ""

    def recorded(entry: Any) -> tuple[int, _Record]:
        record = parse_spec(kind, entry, source)
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


def best_of(records: Sequence[_Record]) -> _Record:
    """Return the run of the lowest objective, the first of several."""
    return min(records, key=lambda record: (record.objective, record.index))


def published_on(space: Space) -> Published | None:
    """Return the published coefficients and their objective on the same data, if it has one."""
    published = space.model.published
    if published is None:
        return None
    value = space.value_of(published)
    return Published(coefficients=dict(published), objective=value) if np.isfinite(value) else None
