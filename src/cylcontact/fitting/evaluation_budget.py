"""A problem that counts evaluations, keeps the best candidate and stops at a budget."""

from __future__ import annotations

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.problem import Problem

__all__ = ["BudgetSpentError", "EvaluationBudget"]


class BudgetSpentError(Exception):
    """The budget of evaluations is spent."""


class EvaluationBudget:
    """A problem with a limited number of evaluations, in coordinates scaled to [0, 1].

    Parameters
    ----------
    problem : Problem
        What to minimise.
    budget : int
        Candidates that may be evaluated; the last one raises `BudgetSpentError`.

    Attributes
    ----------
    size : int
        Free parameters, k.
    spent : int
        Candidates evaluated.
    point : array of float, shape (k,)
        The best candidate, unscaled.
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
        """Return the objective of P candidates, shape (P, k) to (P,); inf if undefined."""
        points = self._points(units)
        values = self._problem.values(points)
        if values.size and values.min() < self.value:
            best = int(values.argmin())
            self.point, self.value = points[best], float(values[best])
        self._require_complete(units)
        return values

    def residuals(self, units: FloatArray) -> FloatArray:
        """Return the residuals of P candidates, shape (P, k) to (P, q); 1e3 if undefined."""
        residuals = self._problem.finite_residuals(self._points(units))
        self._require_complete(units)
        return residuals

    def _points(self, units: FloatArray) -> FloatArray:
        """Return as many candidates as the budget allows, unscaled, and charge for them."""
        allowed = units[: self._budget - self.spent]
        self.spent += len(allowed)
        span = self._problem.high - self._problem.low
        return as_floats(self._problem.low + np.clip(allowed, 0, 1) * span)

    def _require_complete(self, units: FloatArray) -> None:
        if self.spent >= self._budget and len(units):
            raise BudgetSpentError
