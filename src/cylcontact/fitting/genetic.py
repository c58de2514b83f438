"""The genetic search, by PyGAD.

Genes are the free parameters scaled to [0, 1] between their bounds. The whole population is
evaluated in one call. Crossover is one of PyGAD's own or blend (BLX-½, Eshelman and Schaffer
1993); mutation moves genes by Gaussian steps whose size is itself drawn between 0.1 % and
30 % of the range, so that one setting serves both exploring and refining. All random numbers
come from the generator that PyGAD seeds for each run.

PyGAD loops over individuals, which takes longer than evaluating an objective from moments. Its
operators are therefore reimplemented for whole populations. With the same random numbers they
return bit-identical offspring.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pygad
from numpy.random import RandomState
from numpy.typing import NDArray

from cylcontact.fitting.problem import ELITE, Minimum, ParameterSpace
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats

# A crossover of PyGAD: from parents and the shape of the offspring to the offspring.
_Operator = Callable[[FloatArray, tuple[int, int], pygad.GA], FloatArray]

_MUTATION_PROBABILITY = 0.2
_STEP_DECADES = (-3.0, -0.5)
# The fitness of an undefined law; PyGAD refuses NaN.
_WORST_FITNESS = -1e300


def search(
    problem: ParameterSpace, population: int, generations: int, crossover: str, seed: int
) -> Minimum:
    """Return the best of a genetic search with one of `CROSSOVERS`."""
    low, span = problem.low, problem.high - problem.low

    def points(genes: FloatArray) -> FloatArray:
        return low + genes * span

    def fitness(_: pygad.GA, genes: FloatArray, __: Any) -> FloatArray:
        values = problem.values(points(genes))
        return np.where(np.isfinite(values), -values, _WORST_FITNESS)

    engine = WholePopulations(
        num_generations=generations,
        num_parents_mating=max(2, population // 2),
        sol_per_pop=population,
        num_genes=len(problem.free),
        gene_space={"low": 0.0, "high": 1.0},
        fitness_func=fitness,
        fitness_batch_size=population,
        crossover_type=OPERATORS[crossover],
        mutation_type=mutate,
        keep_elitism=min(ELITE, population - 1),
        random_seed=seed,
        suppress_warnings=True,
    )
    engine.run()
    genes, best, _ = engine.best_solution(engine.last_generation_fitness)
    return Minimum(points(genes), float(-best), int(engine.num_fitness_evaluations))


class WholePopulations(pygad.GA):  # type: ignore[misc]
    """PyGAD's search with vectorized ranking and evaluation."""

    def cal_pop_fitness(self) -> FloatArray:
        """Return the fitness of the population, reusing that of unchanged parents."""
        fitness_of: dict[bytes, float] = {}
        if self.last_generation_parents is not None:
            fitness_then = self.previous_generation_fitness[self.last_generation_parents_indices]
            fitness_of = dict(zip(_keys(self.last_generation_parents), fitness_then, strict=True))
        fitness = np.array([fitness_of.get(key, np.nan) for key in _keys(self.population)])
        new = np.isnan(fitness)
        if new.any():
            fitness[new] = self.fitness_func(self, self.population[new], None)
        self.num_fitness_evaluations += int(np.count_nonzero(new))
        return fitness

    def steady_state_selection(
        self, fitness: FloatArray, num_parents: int
    ) -> tuple[FloatArray, NDArray[np.intp]]:
        """Return the best individuals, the later of equals first, and their indices."""
        best = np.argsort(fitness, kind="stable")[::-1][:num_parents]
        return self.population[best], best

    def best_solution(self, pop_fitness: FloatArray) -> tuple[FloatArray, np.float64, int]:
        """Return the best individual, the first of equals, its fitness and its index."""
        best = int(np.argmax(pop_fitness))
        return self.population[best].copy(), pop_fitness[best], best


def _keys(genes: FloatArray) -> list[bytes]:
    data, width = genes.tobytes(), genes.shape[1] * genes.itemsize
    return [data[first : first + width] for first in range(0, len(data), width)]


def _crossover(second: Callable[[tuple[int, int], RandomState], BoolArray]) -> _Operator:
    """Return the crossover of neighbouring parents, given which genes the second one passes on."""

    def offspring(parents: FloatArray, size: tuple[int, int], engine: pygad.GA) -> FloatArray:
        k = np.arange(size[0])
        one, two = parents[k % len(parents)], parents[(k + 1) % len(parents)]
        return np.where(second(size, engine.numpy_random_generator), two, one)

    return offspring


def _beyond_one_point(size: tuple[int, int], rng: RandomState) -> BoolArray:
    point = rng.randint(0, size[1], size=size[0])
    return np.asarray(np.arange(size[1]) >= point[:, None])


def _between_two_points(size: tuple[int, int], rng: RandomState) -> BoolArray:
    one, two = rng.randint(0, size[1] + 1, size=size[0]), rng.randint(0, size[1], size=size[0])
    two += two >= one
    first, last = np.minimum(one, two)[:, None], np.maximum(one, two)[:, None]
    genes = np.arange(size[1])
    return np.asarray((genes >= first) & (genes < last))


def _any_genes(size: tuple[int, int], rng: RandomState) -> BoolArray:
    return np.asarray(rng.randint(0, 2, size=size) == 1)


def _blend(parents: FloatArray, size: tuple[int, int], engine: pygad.GA) -> FloatArray:
    """Return offspring drawn gene by gene from the parents' interval, widened by half."""
    rng = engine.numpy_random_generator
    one, two = parents[rng.randint(len(parents), size=(2, size[0]))]
    weight = rng.uniform(-0.5, 1.5, size=size)
    return as_floats(np.clip(weight * one + (1 - weight) * two, 0, 1))


def mutate(offspring: FloatArray, engine: pygad.GA) -> FloatArray:
    """Return offspring with some genes moved by Gaussian steps of random size."""
    rng = engine.numpy_random_generator
    hit = rng.uniform(size=offspring.shape) < _MUTATION_PROBABILITY
    step = rng.normal(size=offspring.shape) * 10 ** rng.uniform(*_STEP_DECADES, offspring.shape)
    return as_floats(np.clip(np.where(hit, offspring + step, offspring), 0, 1))


OPERATORS: dict[str, _Operator] = {
    "single_point": _crossover(_beyond_one_point),
    "two_points": _crossover(_between_two_points),
    "uniform": _crossover(_any_genes),
    "scattered": _crossover(_any_genes),
    "blend": _blend,
}
CROSSOVERS = tuple(OPERATORS)
