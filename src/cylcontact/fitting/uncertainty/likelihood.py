"""Profile-likelihood intervals and regions of fitted parameters.

With Gaussian noise the likelihood ratio of fixed parameters to the optimum, with the others
refitted, is (S(θ) − S)/τ. An interval or region holds the values for which it stays below the
quantile of χ² (standard deviations known) or of F (not known). Unlike an interval from the
covariance it follows the curvature of the law.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np
from pydantic import Field
from scipy.optimize import brentq

from cylcontact.arrays import FloatArray
from cylcontact.fitting.least_squares import descend
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.residual_model import ResidualModel
from cylcontact.spec import Spec

__all__ = [
    "BETTER",
    "PAIR_POINTS",
    "Interval",
    "PairMap",
    "fixed_ratio",
    "interval",
    "pair_map",
    "pairs_of",
]

# Precision of an interval's ends, relative to the distance from the optimum.
_EDGE_PRECISION = 1e-4
_FIRST_STEP = 1e-6
# Values of each parameter in a map of a pair.
PAIR_POINTS = 21
# Half-widths of the intervals on either side of the optimum in a map of a pair.
_PAIR_REACH = 1.6
_FAR = 1e6
# Below this the profile found a better optimum; it is not round-off.
BETTER = -1e-6


class Interval(Spec):
    """An interval of a parameter."""

    low: float = Field(description="the lower end")
    high: float = Field(description="the upper end")
    low_is_bound: bool = Field(description="whether a bound of the search cuts it off below")
    high_is_bound: bool = Field(description="whether a bound of the search cuts it off above")
    lowest: float = Field(
        0.0, description="the lowest (S(θ) − S)/τ; below 0 there is a better optimum"
    )


class PairMap(Spec):
    """The likelihood ratio over two parameters, all others refitted."""

    names: tuple[str, str] = Field(description="the two parameters", strict=False)
    x: list[float] = Field(description="values of the first, increasing")
    y: list[float] = Field(description="values of the second, increasing")
    ratio: list[list[float | None]] = Field(
        description="(S(θ) − S)/τ, a row for each y; null where the law is undefined, "
        "below 0 where a better optimum was found"
    )
    thresholds: dict[str, float] = Field(description="the contour of each level, in percent")


def fixed_ratio(
    problem: Problem, noise: ResidualModel, fixed: Mapping[str, float], start: Mapping[str, float]
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
    smaller = problem
    for name, value in fixed.items():
        smaller = smaller.fixing(name, value)
    point, reached, _ = descend(smaller, smaller.point(start))
    ratio = (noise.rows * reached**2 - noise.sum_of_squares) / noise.unit
    return float(ratio), smaller.coefficients(point)


def interval(
    problem: Problem, noise: ResidualModel, name: str, best: Mapping[str, float], level: float
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
    parameter = next(p for p in problem.free if p.name == name)
    low, low_is_bound, below = _edge(problem, noise, name, best, parameter.low, level)
    high, high_is_bound, above = _edge(problem, noise, name, best, parameter.high, level)
    return Interval(
        low=low,
        high=high,
        low_is_bound=low_is_bound,
        high_is_bound=high_is_bound,
        lowest=min(below, above),
    )


def pair_map(
    problem: Problem,
    noise: ResidualModel,
    names: tuple[str, str],
    best: Mapping[str, float],
    intervals: Mapping[str, Interval],
    levels: tuple[float, ...],
    points: int = PAIR_POINTS,
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
    x, y = (_reach(problem, name, best[name], intervals[name], points) for name in names)
    ratio: list[list[float | None]] = [[None] * x.size for _ in y]
    for row, second in enumerate(y):
        start: Mapping[str, float] = best
        for column, first in enumerate(x):
            fixed = {names[0]: float(first), names[1]: float(second)}
            value, coefficients = fixed_ratio(problem, noise, fixed, {**start, **fixed})
            if np.isfinite(value):
                ratio[row][column], start = value, coefficients
    return PairMap(
        names=names,
        x=[float(v) for v in x],
        y=[float(v) for v in y],
        ratio=ratio,
        thresholds={f"{100 * level:g}": noise.threshold(level, 2) for level in levels},
    )


def pairs_of(problem: Problem) -> list[tuple[str, str]]:
    """Return the pairs of free parameters."""
    return list(combinations([p.name for p in problem.free], 2))


def _reach(problem: Problem, name: str, best: float, ends: Interval, points: int) -> FloatArray:
    """Return values of a parameter around its interval, within its bounds."""
    parameter = next(p for p in problem.free if p.name == name)
    low = max(parameter.low, best - _PAIR_REACH * (best - ends.low))
    high = min(parameter.high, best + _PAIR_REACH * (ends.high - best))
    return np.linspace(low, high, points)


def _edge(
    problem: Problem,
    noise: ResidualModel,
    name: str,
    best: Mapping[str, float],
    bound: float,
    level: float,
) -> tuple[float, bool, float]:
    """Return the end of an interval towards a bound.

    Also return whether it is the bound, and the lowest ratio evaluated, at most 0.
    """
    limit = float(np.sqrt(noise.threshold(level)))
    reach = bound - best[name]
    lowest = 0.0
    if reach == 0:
        return bound, True, lowest
    step = _guess(problem, noise, name, limit) / abs(reach)
    inner, outer, start = 0.0, min(1.0, max(step, _FIRST_STEP)), best

    def above(share: float) -> float:
        # The square root of the ratio is nearly linear in the parameter.
        nonlocal start, lowest
        fixed = {name: best[name] + share * reach}
        ratio, coefficients = fixed_ratio(problem, noise, fixed, start)
        if np.isfinite(ratio):
            start, lowest = coefficients, min(lowest, ratio)
        return float(min(np.sqrt(max(ratio, 0.0)), _FAR * limit)) - limit

    while above(outer) <= 0:
        if outer == 1.0:
            return bound, True, lowest
        inner, outer = outer, min(1.0, 2 * outer)
    share = brentq(above, inner, outer, rtol=_EDGE_PRECISION, xtol=_EDGE_PRECISION * outer)
    return best[name] + float(share) * reach, False, lowest


def _guess(problem: Problem, noise: ResidualModel, name: str, limit: float) -> float:
    """Return slightly more than the distance to the threshold by the covariance."""
    if noise.covariance is None:
        return 0.0
    place = [p.name for p in problem.free].index(name)
    return 1.1 * limit * float(np.sqrt(max(noise.covariance[place, place], 0.0)))
