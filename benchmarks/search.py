"""The genetic search, against its objective alone and against PyGAD one individual at a time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pygad

from benchmarks.harness import Row, Side, compare
from benchmarks.sampling import grid_of
from cylcontact.datasets import reduce_grid
from cylcontact.fitting import genetic
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.objectives import Problem, RmsLogPenetration
from cylcontact.fitting.optimizers import ELITE
from cylcontact.laws.law import Parameter

# The bounds of the paper's internal campaign.
BOUNDS = {
    "a": (0.1, 1.5),
    "b": (0.0, 0.5),
    "Y_log_scale": (1.0, 3.0),
    "Y_log_exponent": (-0.6, 0.0),
    "Y_slope": (-0.1, 0.1),
    "Y_offset": (0.8, 1.6),
    "n_exponent": (-0.1, 0.1),
}
# From this population on PyGAD takes long enough to be timed in three rounds.
LARGE = 480


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the time of a search by size of its population."""
    problem = problem_of(9, 5, 61, 15)
    generations = 5 if short else 50
    for population in (60,) if short else (60, 120, 480):
        sides = _sides(problem, population, generations)
        _require_same_search(problem, population, generations)
        case = f"{population} candidates, {generations} generations"
        rounds = 1 if short else 5 if population < LARGE else 3
        yield compare("search", case, sides, rounds, "ms per generation", 1e3 / generations)


def problem_of(*shape: int) -> Problem:
    """Return the calibration of the enhanced law for internal contact on a grid of that shape."""
    moments, _ = reduce_grid(grid_of(*shape))
    parameters = tuple(Parameter(name, low, high) for name, (low, high) in BOUNDS.items())
    return Problem(MODELS["enhanced", "internal"], parameters, RmsLogPenetration(moments))


def plain_pygad(problem: Problem, population: int, generations: int, seed: int) -> pygad.GA:
    """Return PyGAD's search as its manual shows it: its operators, one individual at a time."""
    span = problem.high - problem.low

    def fitness(_: pygad.GA, genes: np.ndarray, __: int) -> float:
        return -problem.value(problem.low + genes * span)

    return pygad.GA(
        num_generations=generations,
        num_parents_mating=population // 2,
        sol_per_pop=population,
        num_genes=len(problem.free),
        gene_space={"low": 0.0, "high": 1.0},
        fitness_func=fitness,
        crossover_type="uniform",
        mutation_type="random",
        mutation_probability=0.2,
        keep_elitism=2,
        random_seed=seed,
        suppress_warnings=True,
    )


def _sides(problem: Problem, population: int, generations: int) -> list[Side]:
    points = np.random.default_rng(0).uniform(size=(population - ELITE, len(problem.free)))
    points = problem.low + points * (problem.high - problem.low)

    def objective_alone():
        for _ in range(generations):
            problem.values(points)

    return [
        Side(
            "cylcontact: genetic search",
            lambda: genetic.search(problem, population, generations, "uniform", 1),
        ),
        Side("the objective alone", objective_alone),
        Side(
            "PyGAD, the same objective for one individual after the other",
            lambda: plain_pygad(problem, population, generations, 1).run(),
        ),
    ]


def _require_same_search(problem: Problem, population: int, generations: int) -> None:
    """Evolve with PyGAD's own crossover and ranking: not a bit of the result may differ."""
    span = problem.high - problem.low
    engine = pygad.GA(
        num_generations=generations,
        num_parents_mating=population // 2,
        sol_per_pop=population,
        num_genes=len(problem.free),
        gene_space={"low": 0.0, "high": 1.0},
        fitness_func=lambda _, genes, __: -problem.values(problem.low + genes * span),
        fitness_batch_size=population,
        crossover_type="uniform",
        mutation_type=genetic.mutate,
        keep_elitism=ELITE,
        random_seed=1,
        suppress_warnings=True,
    )
    engine.run()
    ours = genetic.search(problem, population, generations, "uniform", 1)
    genes, _, _ = engine.best_solution(engine.last_generation_fitness)
    assert np.array_equal(problem.low + genes * span, ours.point)
