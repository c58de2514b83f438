"""A problem that counts what is evaluated, keeps the best of it, and stops at a budget."""

from __future__ import annotations

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.problem import Problem


class BudgetSpentError(Exception):
    """The budget of evaluations is spent: the search is over."""


class EvaluationBudget:
    """A problem with a meter, in coordinates from 0 to 1 between the bounds.

    Parameters
    ----------
    problem : Problem
        What to minimise.
    budget : int
        Candidates that may be evaluated; with the last of them `BudgetSpentError` is raised.

    Attributes
    ----------
    size : int
        Free parameters, k.
    spent : int
        Candidates evaluated.
    point : array of float, shape (k,)
        The best of them, in the problem's own units.
    value : float
        Its objective.
    """

    def __init__(self, problem: Problem, budget: int) -> None:
        self.size = len(problem.free)
        self.spent = 0
        self.point = (problem.low + problem.high) / 2
        self.value = np.inf
        self._problem = problem
        self._budget = budget

    def values(self, units: FloatArray) -> FloatArray:
        """Return the objective of P candidates, shape (P, k) to (P,); inf where undefined."""
        points = self._points(units)
        values = self._problem.values(points)
        if values.size and values.min() < self.value:
            best = int(values.argmin())
            self.point, self.value = points[best], float(values[best])
        self._require_complete(units)
        return values

    def residuals(self, units: FloatArray) -> FloatArray:
        """Return the residuals of P candidates, shape (P, k) to (P, q); huge where undefined."""
        residuals = self._problem.residuals(self._points(units))
        self._require_complete(units)
        return as_floats(np.nan_to_num(residuals, nan=1e3, posinf=1e3, neginf=-1e3))

    def _points(self, units: FloatArray) -> FloatArray:
        """Spend on as many candidates as the budget allows and return them, unscaled."""
        allowed = units[: self._budget - self.spent]
        self.spent += len(allowed)
        span = self._problem.high - self._problem.low
        return as_floats(self._problem.low + np.clip(allowed, 0, 1) * span)

    def _require_complete(self, units: FloatArray) -> None:
        if self.spent >= self._budget and len(units):
            raise BudgetSpentError
