"""The optimisers of a campaign, with the same budget of evaluations and the same polish.

The genetic search brings its own stopping rule. The others restart from random points until the
budget is spent, and the best candidate is the result. "descents" does not search: the polish, which
descends from many points at once, does all the work. All random numbers come from a generator
with the run's seed.

The command line reads the names, so slow and optional libraries are imported in the functions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from cylcontact.fitting.problem import ELITE, Minimum, ParameterSpace
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError

# Differential evolution: Storn and Price (1997), best/1/bin with dithered differences.
_DE_CONVERGED = 1e-8
# CMA-ES: the first step, relative to the bounds, and the spread at which it restarts.
_CMA_STEP, _CMA_CONVERGED = 0.3, 1e-9
# The objective of an undefined law, for optimisers that need a number.
_WORST = 1e30


@dataclass(frozen=True)
class Optimizer:
    """An optimiser to choose in a campaign."""

    search: Callable[[ParameterSpace, int, int, str | None, int], Minimum]
    has_crossover: bool = False
    library: str = ""
    extra: str = ""

    def require_installed(self, source: str, name: str) -> None:
        """Refuse the optimiser if its library is missing."""
        try:
            import_module(self.library or "numpy")
        except ImportError:
            remedy = f"make extras, or pip install 'cylcontact[{self.extra}]'"
            rule = f"needs the extra '{self.extra}'"
            raise InputError(source, "optimizer", name, rule, remedy) from None


def _genetic(
    problem: ParameterSpace, population: int, generations: int, crossover: str | None, seed: int
) -> Minimum:
    from cylcontact.fitting import genetic

    return genetic.search(problem, population, generations, crossover or "blend", seed)


def _random(problem: ParameterSpace, population: int, _: int, __: str | None, seed: int) -> Minimum:
    """Return the best of a population of random points, from which the polish descends."""
    points = problem.scatter(np.random.default_rng(seed), population)
    values = problem.values(points)
    return Minimum(points[values.argmin()], float(values.min()), population)


class BudgetSpentError(Exception):
    """The budget of evaluations is spent."""


class EvaluationBudget:
    """A problem with a limited number of evaluations, in coordinates scaled to [0, 1].

    The last candidate that the budget allows raises `BudgetSpentError`; `point` and `value` are the
    best so far.
    """

    def __init__(self, problem: ParameterSpace, budget: int) -> None:
        self.size = len(problem.free)
        self.spent = 0
        self.point = (problem.low + problem.high) / 2
        self.value = np.inf
        self._problem = problem
        self._budget = budget

    def values(self, units: FloatArray) -> FloatArray:
        """Return the objective of P candidates, shape (P, k) to (P,); inf if undefined."""
        return self._spend(units, self._best_kept)

    def residuals(self, units: FloatArray) -> FloatArray:
        """Return the residuals of P candidates, shape (P, k) to (P, q); 1e3 if undefined."""
        return self._spend(units, self._problem.finite_residuals)

    def _best_kept(self, points: FloatArray) -> FloatArray:
        values = self._problem.values(points)
        best = int(values.argmin())
        if values[best] < self.value:
            self.point, self.value = points[best], float(values[best])
        return values

    def _spend(self, units: FloatArray, evaluate: Callable[[FloatArray], FloatArray]) -> FloatArray:
        low, high = self._problem.low, self._problem.high
        allowed = units[: self._budget - self.spent]
        self.spent += len(allowed)
        answers = evaluate(as_floats(low + np.clip(allowed, 0, 1) * (high - low)))
        if self.spent >= self._budget:
            raise BudgetSpentError
        return answers


def _within_budget(
    restart: Callable[[EvaluationBudget, int, np.random.Generator], None],
) -> Callable[[ParameterSpace, int, int, str | None, int], Minimum]:
    """Return the search that restarts until it has spent the budget of a genetic run."""

    def search(
        problem: ParameterSpace, population: int, generations: int, _: str | None, seed: int
    ) -> Minimum:
        new = population - min(ELITE, population - 1)  # of a generation of a genetic run
        budget = EvaluationBudget(problem, population + generations * new)
        with suppress(BudgetSpentError):
            restart(budget, population, np.random.default_rng(seed))
        return Minimum(budget.point, budget.value, budget.spent)

    return search


@_within_budget
def _differential_evolution(
    budget: EvaluationBudget, population: int, rng: np.random.Generator
) -> None:
    from scipy import optimize

    shape = (max(5, population), budget.size)

    def values(units: FloatArray, /) -> FloatArray:
        values = budget.values(units.T)
        return np.where(np.isfinite(values), values, _WORST)

    while True:
        optimize.differential_evolution(
            values,  # type: ignore[arg-type]  # the stubs lack vectorized functions
            optimize.Bounds(np.zeros(budget.size), np.ones(budget.size)),
            init=rng.uniform(size=shape),
            maxiter=10**9,
            tol=0.0,
            atol=_DE_CONVERGED,
            polish=False,
            updating="deferred",
            vectorized=True,
            rng=rng,
        )


@_within_budget
def _least_squares(budget: EvaluationBudget, _: int, rng: np.random.Generator) -> None:
    """Search by scipy's least squares; a Jacobian counts as the 2k candidates that it needs."""
    from scipy import optimize

    from cylcontact.fitting.polish import central_differences

    low, high = np.zeros(budget.size), np.ones(budget.size)

    def residuals(unit: FloatArray) -> FloatArray:
        return as_floats(budget.residuals(unit[None, :])[0])

    def jacobian(unit: FloatArray) -> FloatArray:
        return as_floats(central_differences(budget.residuals, low, high, unit[None, :])[0].T)

    while True:
        start = rng.uniform(size=budget.size)
        if np.isfinite(budget.values(start[None, :])[0]):
            solution = optimize.least_squares(residuals, start, jac=jacobian, bounds=(low, high))
            budget.values(solution.x[None, :])


@_within_budget
def _cma_es(budget: EvaluationBudget, _: int, rng: np.random.Generator) -> None:
    """Search by pycma; each restart doubles the population (Auger and Hansen 2005)."""
    import cma

    population = 4 + int(3 * np.log(budget.size))
    while True:
        options = {
            "bounds": [0.0, 1.0],
            "popsize": population,
            "seed": np.nan,  # leaves the global generator alone
            "randn": lambda *shape: rng.standard_normal(shape),
            "tolx": _CMA_CONVERGED,
            "verbose": -9,
        }
        if budget.size == 1:  # pycma fails where it would lower the deviation of one variable
            options["maxstd"] = np.inf
        strategy = cma.CMAEvolutionStrategy(rng.uniform(size=budget.size), _CMA_STEP, options)
        while not strategy.stop():
            candidates = strategy.ask()
            values = budget.values(np.array(candidates))
            strategy.tell(candidates, np.where(np.isfinite(values), values, _WORST).tolist())
        population *= 2


OPTIMIZERS: Mapping[str, Optimizer] = {
    "genetic": Optimizer(_genetic, has_crossover=True),
    "differential-evolution": Optimizer(_differential_evolution),
    "least-squares": Optimizer(_least_squares),
    "descents": Optimizer(_random),
    "cma": Optimizer(_cma_es, library="cma", extra="peers"),
}
