"""Profiles of the likelihood: how far parameters may move before a fit gets worse by so much.

A profile fixes a parameter and refits the others. The likelihood ratio to the optimum is
(S(θ) − S)/τ if the noise is Gaussian. An interval or region holds the values for which it stays
below the quantile of χ² (standard deviations known) or of F (not known). Unlike an interval from
the covariance it follows the curvature of the law.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import Protocol

import numpy as np
from pydantic import Field
from scipy.optimize import brentq

from cylcontact.arrays import FloatArray
from cylcontact.fitting.least_squares import descend as descend_to_data
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.residual_model import ResidualModel, residual_model_at
from cylcontact.laws.definition import Coefficients
from cylcontact.spec import Spec

# Half-widths of an interval, relative to the value, up to which a parameter is well or fairly
# determined.
WELL, FAIRLY = 0.02, 0.10
# Precision of an interval's ends, relative to the distance from the optimum.
EDGE_PRECISION = 1e-4
# Closer to a bound than this, relative to its interval, a parameter is at it.
_AT_BOUND = 1e-9
# The first step towards an end, relative to the distance to the bound.
_FIRST_STEP = 1e-6
# Half-widths of the intervals on either side of the optimum in a map of a pair, and its values of
# each parameter.
_REACH, _PAIR_POINTS = 1.6, 21
_FAR = 1e6
# Below this ratio the profile found a better optimum; it is not round-off.
BETTER = -1e-6

# From a problem and a start to a minimum and its objective.
Descent = Callable[[Problem, FloatArray], tuple[FloatArray, float]]


class Ends(Protocol):
    """The ends of an interval, and whether a bound of the search cuts it off there."""

    @property
    def low(self) -> float:
        """The lower end."""

    @property
    def high(self) -> float:
        """The upper end."""

    @property
    def low_is_bound(self) -> bool:
        """Whether it is cut off below."""

    @property
    def high_is_bound(self) -> bool:
        """Whether it is cut off above."""


class Interval(Spec):
    """An interval of a parameter."""

    low: float = Field(description="the lower end")
    high: float = Field(description="the upper end")
    low_is_bound: bool = Field(description="whether a bound of the search cuts it off below")
    high_is_bound: bool = Field(description="whether a bound of the search cuts it off above")
    lowest: float = Field(
        0.0, description="the lowest (S(θ) − S)/τ; below 0 there is a better optimum"
    )


class ParameterMap(Spec):
    """Values of two parameters over which something is mapped."""

    names: tuple[str, str] = Field(description="the two parameters", strict=False)
    x: list[float] = Field(description="values of the first, increasing")
    y: list[float] = Field(description="values of the second, increasing")


class PairMap(ParameterMap):
    """The likelihood ratio over two parameters, all others refitted."""

    ratio: list[list[float | None]] = Field(
        description="(S(θ) − S)/τ, a row for each y; null where the law is undefined, "
        "below 0 where a better optimum was found"
    )
    thresholds: dict[str, float] = Field(description="the contour of each level, in percent")


def is_at_bound(ends: Ends, value: float) -> bool:
    """Return whether a value is at an end of its interval that is a bound of the search."""
    margin = 1e-6 * (ends.high - ends.low) / 2
    return (ends.low_is_bound and value - ends.low <= margin) or (
        ends.high_is_bound and ends.high - value <= margin
    )


def pairs_of(problem: Problem) -> list[tuple[str, str]]:
    """Return the pairs of free parameters."""
    return list(combinations([p.name for p in problem.free], 2))


def around(
    problem: Problem,
    best: Coefficients,
    name: str,
    ends: Ends,
    reach: float,
    points: int = _PAIR_POINTS,
) -> list[float]:
    """Return values within the bounds, up to so many half-widths of an interval away."""
    parameter = next(p for p in problem.free if p.name == name)
    low = max(parameter.low, best[name] - reach * (best[name] - ends.low))
    high = min(parameter.high, best[name] + reach * (ends.high - best[name]))
    return [float(value) for value in np.linspace(low, high, points)]


# --- refits with fixed parameters -------------------------------------------------------------


@dataclass(frozen=True)
class _Criterion:
    """When a fit is worse by so much that an interval ends, and how the end is sought."""

    # From the cost to a number that is positive outside, and the largest that counts.
    excess: Callable[[float], float]
    most: float
    # Where to expect the end.
    distance: float = 0.0


@dataclass(frozen=True)
class _Refits:
    """Refits with some parameters fixed, around an optimum.

    `refit` returns the cost of fixed parameters, given a start for the others, and all
    coefficients. The cost is the likelihood ratio.
    """

    problem: Problem
    best: Coefficients
    refit: Callable[[Coefficients, Coefficients], tuple[float, dict[str, float]]]

    def along(self, name: str, values: FloatArray) -> FloatArray:
        """Return the cost along a parameter, each refit started from that nearer the best."""
        cost = np.empty(values.size)
        middle = int(np.searchsorted(values, self.best[name]))
        for order in (range(middle, values.size), range(middle - 1, -1, -1)):
            start = self.best
            for index in order:
                cost[index], start = self.refit({name: float(values[index])}, start)
        return cost

    def over(
        self, names: tuple[str, str], x: list[float], y: list[float]
    ) -> list[list[float | None]]:
        """Return the cost over two parameters, a row for each y; None where undefined."""
        rows: list[list[float | None]] = [[None] * len(x) for _ in y]
        for row, second in zip(rows, y, strict=True):
            start = self.best
            for column, first in enumerate(x):
                cost, start = self.refit({names[0]: first, names[1]: second}, start)
                if np.isfinite(cost):
                    row[column] = cost
        return rows

    def edge(self, name: str, bound: float, criterion: _Criterion) -> tuple[float, bool, float]:
        """Return the end of an interval towards a bound.

        Also return whether it is the bound, and the lowest cost on the way.
        """
        best, reach, lowest = self.best[name], bound - self.best[name], np.inf
        if reach == 0:
            return bound, True, lowest
        step = max(criterion.distance / abs(reach), _FIRST_STEP)
        inner, outer = 0.0, min(1.0, step)
        start = last = self.best

        def excess(share: float) -> float:
            nonlocal last, lowest
            # A descent that starts at a bound may stay there.
            origin = start if self._is_at_bound(last) else last
            fixed = {name: best + share * reach}
            cost, last = self.refit(fixed, origin)
            if not np.isfinite(cost) and origin is not start:  # undefined with the others of last
                cost, last = self.refit(fixed, start)
            lowest = min(lowest, cost)
            return criterion.excess(cost)

        while excess(outer) <= 0:
            if outer == 1.0:
                return bound, True, lowest
            inner, start, outer = outer, last, min(1.0, 2 * outer)
        share = brentq(
            lambda share: min(excess(share), criterion.most),
            inner,
            outer,
            rtol=EDGE_PRECISION,
            xtol=EDGE_PRECISION * outer,
        )
        return best + float(share) * reach, False, lowest

    def _is_at_bound(self, coefficients: Coefficients) -> bool:
        """Return whether a free parameter is at a bound, to the precision of a descent."""
        return any(
            min(coefficients[p.name] - p.low, p.high - coefficients[p.name])
            < _AT_BOUND * (p.high - p.low)
            for p in self.problem.free
        )


def refit_to_data(problem: Problem, start: FloatArray) -> tuple[FloatArray, float]:
    """Return the minimum of a problem on measurements, and its objective."""
    return descend_to_data(problem, start)[:2]


# --- noise of measurements --------------------------------------------------------------------


def fixed_ratio(
    problem: Problem, noise: ResidualModel, fixed: Coefficients, start: Coefficients
) -> tuple[float, dict[str, float]]:
    """Return (S(θ) − S)/τ with some parameters fixed and the others refitted.

    Parameters
    ----------
    problem : Problem
        On measurements.
    noise : ResidualModel
        At its optimum.
    fixed : mapping
        The fixed parameters and their values.
    start : mapping
        Coefficients from which the refit starts.

    Returns
    -------
    ratio : float
        Below `BETTER` if the refit found a better optimum.
    coefficients : dict
        The refitted ones, and the fixed ones.
    """
    for name, value in fixed.items():
        problem = problem.fixing(name, value)
    point, reached = refit_to_data(problem, problem.point(start))
    ratio = (noise.rows * reached**2 - noise.sum_of_squares) / noise.unit
    return float(ratio), problem.coefficients(point)


def interval(
    problem: Problem, noise: ResidualModel, name: str, best: Coefficients, level: float
) -> Interval:
    """Return the profile-likelihood interval of one parameter.

    Parameters
    ----------
    problem : Problem
        On measurements.
    noise : ResidualModel
        At its optimum.
    name : str
        A free parameter.
    best : mapping
        The coefficients at the optimum.
    level : float
        E.g. 0.95.

    Returns
    -------
    Interval
    """
    refits = _Refits(problem, best, partial(fixed_ratio, problem, noise))
    place = [p.name for p in problem.free].index(name)
    limit = float(np.sqrt(noise.threshold(level, [place])))

    def excess(ratio: float) -> float:
        # The square root of the ratio is nearly linear in the parameter.
        return float(np.sqrt(max(ratio, 0.0))) - limit

    criterion = _Criterion(
        excess,
        most=_FAR * limit - limit,
        distance=_guess(noise, place, limit),
    )
    parameter = next(p for p in problem.free if p.name == name)
    low, low_is_bound, below = refits.edge(name, parameter.low, criterion)
    high, high_is_bound, above = refits.edge(name, parameter.high, criterion)
    return Interval(
        low=low,
        high=high,
        low_is_bound=low_is_bound,
        high_is_bound=high_is_bound,
        lowest=min(0.0, below, above),
    )


def likelihood_profile(
    problem: Problem, best: Coefficients, name: str, ends: Interval, level: float
) -> tuple[FloatArray, FloatArray, float]:
    """Return the rise of a fit over one parameter, with all others refitted.

    Parameters
    ----------
    problem : Problem
        On measurements.
    best : mapping
        The coefficients at the optimum.
    name : str
        A free parameter.
    ends : Interval
        Its profile interval, which sets the extent.
    level : float
        Of the threshold.

    Returns
    -------
    values : array of float, shape (n,)
        Of the parameter.
    rise : array of float, shape (n,)
        √((S(θ) − S)/τ), which for a linear law is the distance in standard errors.
    threshold : float
        Its value at the ends of the interval.
    """
    noise = residual_model_at(problem, problem.point(best))
    refits = _Refits(problem, best, partial(fixed_ratio, problem, noise))
    x = around(problem, best, name, ends, _REACH)
    values = np.union1d(x, [best[name]])
    place = [p.name for p in problem.free].index(name)
    rise = np.sqrt(np.maximum(refits.along(name, values), 0.0))
    return values, rise, float(np.sqrt(noise.threshold(level, [place])))


def _guess(noise: ResidualModel, place: int, limit: float) -> float:
    """Return slightly more than the distance to the threshold by the covariance."""
    if noise.covariance is None:
        return 0.0
    return 1.1 * limit * float(np.sqrt(max(noise.covariance[place, place], 0.0)))


def pair_map(
    problem: Problem,
    noise: ResidualModel,
    names: tuple[str, str],
    best: Coefficients,
    intervals: Mapping[str, Interval],
    levels: tuple[float, ...],
    points: int = _PAIR_POINTS,
) -> PairMap:
    """Return the likelihood ratio over two parameters, all others refitted.

    Parameters
    ----------
    problem, noise, best
        As for `interval`.
    names : tuple of str
        The two parameters.
    intervals : mapping
        Their profile intervals, which set the extent of the map.
    levels : tuple of float
        Levels of the contours.
    points : int
        Values of each parameter.

    Returns
    -------
    PairMap
    """
    refits = _Refits(problem, best, partial(fixed_ratio, problem, noise))
    x, y = (around(problem, best, name, intervals[name], _REACH, points) for name in names)
    free = [p.name for p in problem.free]
    places = [free.index(name) for name in names]
    return PairMap(
        names=names,
        x=x,
        y=y,
        ratio=refits.over(names, x, y),
        thresholds={f"{100 * level:g}": noise.threshold(level, places) for level in levels},
    )
