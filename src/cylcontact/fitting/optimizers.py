"""Optimisers beside the genetic search, on the same problem with the same budget.

Each goes on until the budget is spent, starting anew from other random points where it has
converged, and hands back the best candidate that it evaluated. All random numbers come from a
generator made from the run's seed, none from a global one.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.fitting import genetic
from cylcontact.fitting.evaluation_budget import BudgetSpentError, EvaluationBudget
from cylcontact.fitting.problem import Problem

OPTIMIZERS = ("genetic", "differential-evolution", "least-squares", "cma")
# Differential evolution: Storn and Price (1997), best/1/bin with dithered differences.
DE_CONVERGED = 1e-8
# CMA-ES: the first step, relative to the bounds, and the spread at which it starts anew.
CMA_STEP, CMA_CONVERGED = 0.3, 1e-9
# What stands for an undefined law where an optimiser wants a number.
WORST = 1e30


def budget_of(population: int, generations: int) -> int:
    """Return the candidates that a genetic run may evaluate, which all optimisers are given.

    Examples
    --------
    >>> budget_of(60, 300)
    17460
    """
    return population + generations * (population - min(genetic.ELITE, population - 1))


def search(
    problem: Problem,
    optimizer: str,
    population: int,
    generations: int,
    crossover: str | None,
    seed: int,
) -> genetic.Search:
    """Search a problem with any of the optimisers.

    Parameters
    ----------
    problem : Problem
        What to minimise.
    optimizer : str
        One of `OPTIMIZERS`.
    population, generations : int
        Of the genetic search; `budget_of` them is the budget of every other one.
    crossover : str or None
        Of the genetic search.
    seed : int
        Same seed, same result.

    Returns
    -------
    Search
    """
    if optimizer == "genetic":
        return genetic.search(problem, population, generations, crossover or "blend", seed)
    metered = EvaluationBudget(problem, budget_of(population, generations))
    with suppress(BudgetSpentError):
        SEARCHES[optimizer](metered, population, np.random.default_rng(seed))
    return genetic.Search(metered.point, metered.value, metered.spent)


def require_installed(optimizer: str, source: str) -> None:
    """Refuse an optimiser whose library is missing.

    Raises
    ------
    InputError
        If it is `cma` and the extra `peers` is not installed.
    """
    if optimizer != "cma":
        return
    try:
        import cma  # noqa: F401
    except ImportError:
        raise InputError(
            source,
            "optimizer",
            optimizer,
            "needs the extra 'peers'",
            "make extras, or pip install 'cylcontact[peers]'",
        ) from None


def differential_evolution(
    metered: EvaluationBudget, population: int, rng: np.random.Generator
) -> None:
    """Search by differential evolution, as scipy has it, from one random population after another.

    Parameters
    ----------
    metered : EvaluationBudget
        What to minimise, until its budget is spent.
    population : int
        Candidates of a population, at least five.
    rng : Generator
        Where all random numbers come from.
    """
    from scipy import optimize

    shape = (max(5, population), metered.size)

    def values(units: FloatArray, /) -> FloatArray:
        return _finite(metered.values(units.T))

    while True:
        optimize.differential_evolution(
            values,  # type: ignore[arg-type]  # the stubs know of one candidate at a time
            optimize.Bounds(np.zeros(metered.size), np.ones(metered.size)),
            init=rng.uniform(size=shape),
            maxiter=10**9,
            tol=0.0,
            atol=DE_CONVERGED,
            polish=False,
            updating="deferred",
            vectorized=True,
            rng=rng,
        )


def least_squares(metered: EvaluationBudget, _: int, rng: np.random.Generator) -> None:
    """Search by least squares, as scipy has it, from one random point after another.

    A Jacobian by central differences counts as the 2k candidates that it evaluates.

    Parameters
    ----------
    metered : EvaluationBudget
        What to minimise, until its budget is spent.
    _ : int
        Not used.
    rng : Generator
        Where all random numbers come from.
    """
    from scipy import optimize

    from cylcontact.fitting.minimax import central_differences

    low, high = np.zeros(metered.size), np.ones(metered.size)

    def residuals(unit: FloatArray) -> FloatArray:
        return as_floats(metered.residuals(unit[None, :])[0])

    def jacobian(unit: FloatArray) -> FloatArray:
        return central_differences(metered.residuals, low, high, unit)

    while True:
        start = rng.uniform(size=metered.size)
        if np.isfinite(metered.values(start[None, :])[0]):
            found = optimize.least_squares(residuals, start, jac=jacobian, bounds=(low, high))
            metered.values(found.x[None, :])


def cma_es(metered: EvaluationBudget, _: int, rng: np.random.Generator) -> None:
    """Search by CMA-ES, as pycma has it, doubling the population with each restart.

    Hansen and Ostermeier (2001); restarts of Auger and Hansen (2005).

    Parameters
    ----------
    metered : EvaluationBudget
        What to minimise, until its budget is spent.
    _ : int
        Not used: CMA-ES sets its own population.
    rng : Generator
        Where all random numbers come from.
    """
    import cma

    population = 4 + int(3 * np.log(metered.size))
    while True:
        options = {
            "bounds": [0.0, 1.0],
            "popsize": population,
            "seed": np.nan,  # leaves the global generator alone
            "randn": lambda *shape: rng.standard_normal(shape),
            "tolx": CMA_CONVERGED,
            "verbose": -9,
        }
        strategy = cma.CMAEvolutionStrategy(rng.uniform(size=metered.size), CMA_STEP, options)
        while not strategy.stop():
            candidates = strategy.ask()
            strategy.tell(candidates, _finite(metered.values(np.array(candidates))).tolist())
        population *= 2


def _finite(values: FloatArray) -> FloatArray:
    """Put a huge number where a candidate is undefined."""
    return np.where(np.isfinite(values), values, WORST)


SEARCHES: dict[str, Callable[[EvaluationBudget, int, np.random.Generator], None]] = {
    "differential-evolution": differential_evolution,
    "least-squares": least_squares,
    "cma": cma_es,
}
