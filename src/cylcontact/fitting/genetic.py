"""The genetic search, by PyGAD.

Genes are the free parameters scaled to [0, 1] between their bounds. The whole population is
evaluated in one call. Crossover is one of PyGAD's own or blend (BLX-½, Eshelman and Schaffer
1993); mutation moves genes by Gaussian steps whose size is itself drawn between 0.1 % and
30 % of the range, so that one setting serves both exploring and refining. All random numbers
come from the generator that PyGAD seeds for each run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pygad

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.problem import Problem

CROSSOVERS = ("single_point", "two_points", "uniform", "scattered", "blend")
MUTATION_PROBABILITY = 0.2
STEP_DECADES = (-3.0, -0.5)
ELITE = 2
# PyGAD ranks by fitness and refuses NaN; this stands for an undefined law.
WORST_FITNESS = -1e300


@dataclass(frozen=True)
class Search:
    """What a genetic run found.

    Attributes
    ----------
    point : array of float, shape (k,)
        The best free parameters.
    value : float
        Their objective.
    evaluations : int
        Candidates evaluated.
    """

    point: FloatArray
    value: float
    evaluations: int


def search(
    problem: Problem, population: int, generations: int, crossover: str, seed: int
) -> Search:
    """Search a problem genetically.

    Parameters
    ----------
    problem : Problem
        What to minimise.
    population, generations : int
        Size of the population and number of generations.
    crossover : str
        One of `CROSSOVERS`.
    seed : int
        Same seed, same result.

    Returns
    -------
    Search
    """
    span = problem.high - problem.low

    def points(genes: FloatArray) -> FloatArray:
        return problem.low + np.atleast_2d(genes) * span

    def fitness(_: pygad.GA, genes: FloatArray, __: Any) -> FloatArray:
        values = problem.values(points(genes))
        return np.where(np.isfinite(values), -values, WORST_FITNESS)

    engine = pygad.GA(
        num_generations=generations,
        num_parents_mating=max(2, population // 2),
        sol_per_pop=population,
        num_genes=len(problem.free),
        gene_space={"low": 0.0, "high": 1.0},
        fitness_func=fitness,
        fitness_batch_size=population,
        crossover_type=_blend if crossover == "blend" else crossover,
        mutation_type=_mutate,
        keep_elitism=min(ELITE, population - 1),
        random_seed=seed,
        suppress_warnings=True,
    )
    engine.run()
    genes, best, _ = engine.best_solution(pop_fitness=engine.last_generation_fitness)
    point = points(genes)[0]
    return Search(point, float(-best), int(engine.num_fitness_evaluations))


def _blend(parents: FloatArray, size: tuple[int, int], engine: pygad.GA) -> FloatArray:
    """Return offspring drawn, gene by gene, from the parents' interval widened by half."""
    rng = engine.numpy_random_generator
    one, two = parents[rng.randint(len(parents), size=(2, size[0]))]
    weight = rng.uniform(-0.5, 1.5, size=size)
    return as_floats(np.clip(weight * one + (1 - weight) * two, 0, 1))


def _mutate(offspring: FloatArray, engine: pygad.GA) -> FloatArray:
    """Return offspring with some genes moved by Gaussian steps of random size."""
    rng = engine.numpy_random_generator
    hit = rng.uniform(size=offspring.shape) < MUTATION_PROBABILITY
    step = rng.normal(size=offspring.shape) * 10 ** rng.uniform(*STEP_DECADES, offspring.shape)
    return as_floats(np.clip(np.where(hit, offspring + step, offspring), 0, 1))
