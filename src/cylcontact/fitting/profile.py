"""Profiles of the objective, which measure how well each coefficient is identified.

A reference law has no noise, so a coefficient has no confidence interval. Instead, the 1 %
interval holds the values for which the objective, minimised over all other coefficients, stays
within 1 % of the optimum.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from pydantic import Field
from scipy.optimize import brentq

from cylcontact.arrays import FloatArray
from cylcontact.fitting.polish import polish
from cylcontact.fitting.problem import Problem
from cylcontact.spec import Spec

__all__ = ["FAIRLY", "TOLERANCE", "WELL", "Profile", "profile"]

TOLERANCE = 0.01
_CURVE_POINTS = 41
# Half-widths of the 1 % interval, relative to the value, up to which a coefficient is well or
# fairly identified.
WELL, FAIRLY = 0.02, 0.10
_FIRST_STEP = 1e-4
_EDGE_PRECISION = 1e-4
_PRECISION = 1e-10


class Profile(Spec):
    """The best attainable objective as a function of one coefficient."""

    values: list[float] = Field(description="values of the coefficient, increasing")
    objective: list[float] = Field(description="the objective with all others re-optimised")
    low: float = Field(description="lower end of the 1 % interval, or the bound it meets")
    high: float = Field(description="upper end of the 1 % interval, or the bound it meets")
    low_is_bound: bool = Field(description="whether the interval was cut off below by the bound")
    high_is_bound: bool = Field(description="whether the interval was cut off above by the bound")
    objective_at_published: float | None = Field(
        description="the objective with the coefficient at its published value"
    )

    @property
    def interval(self) -> str:
        """The 1 % interval, and whether a bound cuts it off."""
        cut = ", bound" if self.low_is_bound or self.high_is_bound else ""
        return f"{self.low:.4g} … {self.high:.4g}{cut}"

    def verdict(self, value: float) -> str:
        """Return "well", "fairly", "poorly" or "at a bound" for a coefficient at `value`."""
        half_width = (self.high - self.low) / 2
        margin = 1e-6 * half_width
        if (self.low_is_bound and value - self.low <= margin) or (
            self.high_is_bound and self.high - value <= margin
        ):
            return "at a bound"
        if self.low_is_bound or self.high_is_bound or half_width > FAIRLY * abs(value):
            return "poorly"
        return "well" if half_width <= WELL * abs(value) else "fairly"


def profile(
    problem: Problem, name: str, best: Mapping[str, float], published: float | None
) -> Profile:
    """Profile the objective over one free parameter.

    Parameters
    ----------
    problem : Problem
        The problem.
    name : str
        The parameter.
    best : mapping
        The coefficients at the optimum.
    published : float or None
        The published value, which the curve includes.

    Returns
    -------
    Profile
        At 41 equidistant values between the bounds, the optimum and the published value, except
        where the law is undefined.
    """
    parameter = next(p for p in problem.free if p.name == name)
    extra = [best[name]] + ([published] if published is not None else [])
    grid = np.union1d(np.linspace(parameter.low, parameter.high, _CURVE_POINTS), extra)
    objective = _walk(problem, name, grid, best)
    defined = np.isfinite(objective)
    low, low_is_bound = _edge(problem, name, best, parameter.low)
    high, high_is_bound = _edge(problem, name, best, parameter.high)
    return Profile(
        values=[float(v) for v in grid[defined]],
        objective=[float(v) for v in objective[defined]],
        low=low,
        high=high,
        low_is_bound=low_is_bound,
        high_is_bound=high_is_bound,
        objective_at_published=None
        if published is None or not defined[np.searchsorted(grid, published)]
        else float(objective[np.searchsorted(grid, published)]),
    )


def _fixed(
    problem: Problem, name: str, value: float, start: Mapping[str, float]
) -> tuple[float, dict[str, float]]:
    """Return the best objective and coefficients with one parameter fixed at a value."""
    smaller = problem.fixing(name, value)
    point, objective = polish(smaller, smaller.point(start), _PRECISION)
    return objective, smaller.coefficients(point)


def _walk(problem: Problem, name: str, grid: FloatArray, best: Mapping[str, float]) -> FloatArray:
    """Return the profile on a grid, each point started from its neighbour nearer the optimum."""
    objective = np.empty(grid.size)
    middle = int(np.searchsorted(grid, best[name]))
    for order in (range(middle, grid.size), range(middle - 1, -1, -1)):
        start: Mapping[str, float] = best
        for index in order:
            value, coefficients = _fixed(problem, name, float(grid[index]), start)
            objective[index] = value
            if np.isfinite(value):
                start = coefficients
    return objective


def _edge(
    problem: Problem, name: str, best: Mapping[str, float], bound: float
) -> tuple[float, bool]:
    """Return the end of the 1 % interval towards a bound, and whether it is the bound."""
    limit = problem.value_of(best) * (1 + TOLERANCE)
    reach, inner, start = bound - best[name], 0.0, best
    outer = _FIRST_STEP
    while True:
        value, coefficients = _fixed(problem, name, best[name] + outer * reach, start)
        if not value <= limit:
            break
        if outer == 1.0:
            return bound, True
        inner, start, outer = outer, coefficients, min(1.0, 2 * outer)

    def above(share: float) -> float:
        value, _ = _fixed(problem, name, best[name] + share * reach, start)
        return min(value, 2 * limit) - limit

    share = brentq(above, inner, outer, rtol=_EDGE_PRECISION, xtol=_EDGE_PRECISION * outer)
    return best[name] + float(share) * reach, False
