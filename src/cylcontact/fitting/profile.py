"""How well the data determine each coefficient: profiles of the objective.

A reference law has no noise, so a coefficient has no confidence interval. What can be said is
how far it may move before the fit gets noticeably worse, all others re-optimised: the
interval within which the best attainable objective stays within 1 % of the optimum.
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

TOLERANCE = 0.01
CURVE_POINTS = 41
# Half-widths of the 1 % interval relative to the value: below the first a coefficient counts
# as well identified, below the second as fairly, else as poorly.
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
        """Say in a word how well the coefficient is identified."""
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
        The published value, which the curve is made to include.

    Returns
    -------
    Profile
        `CURVE_POINTS` equidistant values between the bounds, and the optimum and the
        published value, those at which the law is undefined left out.
    """
    parameter = next(p for p in problem.free if p.name == name)
    extra = [best[name]] + ([published] if published is not None else [])
    grid = np.union1d(np.linspace(parameter.low, parameter.high, CURVE_POINTS), extra)
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


def _held(
    problem: Problem, name: str, value: float, start: Mapping[str, float]
) -> tuple[float, dict[str, float]]:
    """Return the best objective and coefficients with one parameter held at a value."""
    held = problem.holding(name, value)
    point, objective = polish(held, held.point(start), _PRECISION)
    return objective, held.coefficients(point)


def _walk(problem: Problem, name: str, grid: FloatArray, best: Mapping[str, float]) -> FloatArray:
    """Return the profile on a grid, walked outwards so that each point starts from the last."""
    objective = np.empty(grid.size)
    middle = int(np.searchsorted(grid, best[name]))
    for order in (range(middle, grid.size), range(middle - 1, -1, -1)):
        start: Mapping[str, float] = best
        for index in order:
            value, found = _held(problem, name, float(grid[index]), start)
            objective[index] = value
            if np.isfinite(value):
                start = found
    return objective


def _edge(
    problem: Problem, name: str, best: Mapping[str, float], bound: float
) -> tuple[float, bool]:
    """Return where, towards a bound, the profile rises 1 % above the optimum."""
    limit = problem.value_of(best) * (1 + TOLERANCE)
    reach, inner, start = bound - best[name], 0.0, best
    outer = _FIRST_STEP
    while True:
        value, found = _held(problem, name, best[name] + outer * reach, start)
        if not value <= limit:
            break
        if outer == 1.0:
            return bound, True
        inner, start, outer = outer, found, min(1.0, 2 * outer)

    def above(share: float) -> float:
        value, _ = _held(problem, name, best[name] + share * reach, start)
        return min(value, 2 * limit) - limit

    share = brentq(above, inner, outer, rtol=_EDGE_PRECISION, xtol=_EDGE_PRECISION * outer)
    return best[name] + float(share) * reach, False
