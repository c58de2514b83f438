"""The genetic search, a population per call, against its objective alone and PyGAD used plainly."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pygad

from benchmarks.harness import Row, Side, compare
from benchmarks.sampling import grid_of
from cylcontact.datasets import reduce_grid
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.parameters import Parameter
from cylcontact.fitting.reference import OnMoments
from cylcontact.fitting.search import genetic_search

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


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the time of a search."""
    space = space_of(9, 5, 61, 15)
    population, generations = (60, 5) if short else (120, 50)
    points = space.scatter(np.random.default_rng(0), population)
    size = (space, population, generations)
    sides = [
        Side("cylcontact: genetic search", lambda: genetic_search(*size, "uniform", 1)),
        Side("the objective alone", lambda: [space.values(points) for _ in range(generations)]),
        Side(
            "PyGAD, the same objective for one individual after the other",
            lambda: pygad_of(*size, space.value, mutation_probability=0.2, keep_elitism=2).run(),
        ),
    ]
    case = f"{population} candidates, {generations} generations"
    rounds = 1 if short else 5
    yield compare("search", case, sides, rounds, "ms per generation", 1e3 / generations)


def space_of(*shape: int) -> OnMoments:
    """Return the calibration of the enhanced law for internal contact on a grid of that shape."""
    moments, _ = reduce_grid(grid_of(*shape))
    parameters = tuple(Parameter(name, low, high) for name, (low, high) in BOUNDS.items())
    return OnMoments(MODELS["enhanced", "internal"], parameters, moments)


def pygad_of(
    bounds: object, population: int, generations: int, value: Callable, **options: object
) -> pygad.GA:
    """Return PyGAD's search as its manual shows it, for what has the bounds `low` and `high`."""
    span = bounds.high - bounds.low
    return pygad.GA(
        num_generations=generations,
        num_parents_mating=population // 2,
        sol_per_pop=population,
        num_genes=span.size,
        gene_space={"low": 0.0, "high": 1.0},
        fitness_func=lambda _, genes, __: -value(bounds.low + genes * span),
        crossover_type="uniform",
        suppress_warnings=True,
        **{"random_seed": 1, **options},
    )
