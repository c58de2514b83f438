"""One run of a campaign: a search and a polish."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from pydantic import Field
from threadpoolctl import threadpool_limits

from cylcontact.errors import InputError
from cylcontact.fitting.optimizers import OPTIMIZERS, search
from cylcontact.fitting.polish import polish_across_kinks
from cylcontact.fitting.problem import Problem
from cylcontact.spec import Spec

__all__ = ["RunPlan", "RunRecord", "execute", "plan_runs"]


@dataclass(frozen=True)
class RunPlan:
    """The index, settings and seed of a run."""

    index: int
    population: int
    generations: int
    crossover: str | None
    seed: int
    optimizer: str = "genetic"


class RunRecord(Spec):
    """The result of a run; only the seconds differ between repeats."""

    index: int = Field(description="the run's place in the campaign")
    seed: int = Field(description="the seed of the search")
    population: int = Field(description="the population, which sets the budget of every search")
    crossover: str | None = Field(description="the crossover of a genetic search")
    objective_before_polish: float = Field(description="the best of the search")
    coefficients_before_polish: dict[str, float] = Field(description="those of the search alone")
    objective: float = Field(description="the objective after the polish")
    coefficients: dict[str, float] = Field(description="the coefficients after the polish")
    evaluations: int = Field(description="candidates that the search evaluated")
    seconds: float = Field(description="wall-clock time")


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

    Examples
    --------
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
    """Search and polish on one thread, so that the result depends on the plan alone.

    Parameters
    ----------
    problem : Problem
        The problem.
    plan : RunPlan
        The settings of the run.
    source : str
        The campaign's name in errors.

    Returns
    -------
    RunRecord

    Raises
    ------
    InputError
        If the search found no coefficients for which the law is defined.
    """
    started = time.perf_counter()
    with threadpool_limits(limits=1):
        best = search(
            problem, plan.optimizer, plan.population, plan.generations, plan.crossover, plan.seed
        )
        point, value = polish_across_kinks(problem, best.point)
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
