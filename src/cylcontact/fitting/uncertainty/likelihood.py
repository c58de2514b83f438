"""Profile likelihood: how far parameters may move before the data object, the others refitted.

With Gaussian noise the likelihood ratio of parameters held somewhere against the optimum is
(S(θ) − S)/τ. An interval or region holds the values for which that stays below the quantile of χ²
(standard deviations known) or of F (not known). Other than an interval from the covariance it
follows the curvature of the law, and it ends at a bound only if the data let it.
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

# Precision of an interval's ends, relative to the distance from the optimum.
EDGE_PRECISION = 1e-4
FIRST_STEP = 1e-6
PAIR_POINTS = 21
# How far a pair's map reaches, in half-widths of the intervals.
PAIR_REACH = 1.6
FAR = 1e6
# A ratio below this is no rounding: what was called the optimum is not.
BETTER = -1e-6


class Interval(Spec):
    """Where a parameter may be."""

    low: float = Field(description="the lower end")
    high: float = Field(description="the upper end")
    low_is_bound: bool = Field(description="whether a bound of the search cuts it off below")
    high_is_bound: bool = Field(description="whether a bound of the search cuts it off above")
    lowest: float = Field(
        0.0, description="the lowest (S(θ) − S)/τ met: below 0 there is a better optimum"
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


def ratio_held(
    problem: Problem, noise: ResidualModel, held: Mapping[str, float], start: Mapping[str, float]
) -> tuple[float, dict[str, float]]:
    """Return (S(θ) − S)/τ with some parameters held, and the coefficients that reach it.

    Parameters
    ----------
    problem : Problem
        On measurements.
    noise : ResidualModel
        At its optimum.
    held : mapping
        The parameters that are held, and where.
    start : mapping
        Coefficients from which the others are refitted.

    Returns
    -------
    ratio : float
        Below 0 by more than rounding (`BETTER`) where the refit found a better optimum.
    coefficients : dict
        That reach it.
    """
    smaller = problem
    for name, value in held.items():
        smaller = smaller.holding(name, value)
    point, reached, _ = descend(smaller, smaller.point(start))
    risen = (noise.rows * reached**2 - noise.sum_of_squares) / noise.unit
    return float(risen), smaller.coefficients(point)


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
        Their profile intervals, which set how far the map reaches.
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
            held = {names[0]: float(first), names[1]: float(second)}
            value, found = ratio_held(problem, noise, held, {**start, **held})
            if np.isfinite(value):
                ratio[row][column], start = value, found
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


def _reach(problem: Problem, name: str, best: float, found: Interval, points: int) -> FloatArray:
    """Return values of a parameter around its interval, within its bounds."""
    parameter = next(p for p in problem.free if p.name == name)
    low = max(parameter.low, best - PAIR_REACH * (best - found.low))
    high = min(parameter.high, best + PAIR_REACH * (found.high - best))
    return np.linspace(low, high, points)


def _edge(
    problem: Problem,
    noise: ResidualModel,
    name: str,
    best: Mapping[str, float],
    bound: float,
    level: float,
) -> tuple[float, bool, float]:
    """Return where, towards a bound, the likelihood ratio passes the threshold.

    Then whether that is the bound, and the lowest ratio met, at most 0.
    """
    limit = float(np.sqrt(noise.threshold(level)))
    reach = bound - best[name]
    lowest = 0.0
    if reach == 0:
        return bound, True, lowest
    step = _guess(problem, noise, name, limit) / abs(reach)
    inner, outer, start = 0.0, min(1.0, max(step, FIRST_STEP)), best

    def above(share: float) -> float:
        # The root of the ratio is nearly linear in the parameter, which is quick to solve.
        nonlocal start, lowest
        held = {name: best[name] + share * reach}
        ratio, found = ratio_held(problem, noise, held, start)
        if np.isfinite(ratio):
            start, lowest = found, min(lowest, ratio)
        return float(min(np.sqrt(max(ratio, 0.0)), FAR * limit)) - limit

    while above(outer) <= 0:
        if outer == 1.0:
            return bound, True, lowest
        inner, outer = outer, min(1.0, 2 * outer)
    share = brentq(above, inner, outer, rtol=EDGE_PRECISION, xtol=EDGE_PRECISION * outer)
    return best[name] + float(share) * reach, False, lowest


def _guess(problem: Problem, noise: ResidualModel, name: str, limit: float) -> float:
    """Return the distance to the threshold that the covariance promises, a little more."""
    if noise.covariance is None:
        return 0.0
    place = [p.name for p in problem.free].index(name)
    return 1.1 * limit * float(np.sqrt(max(noise.covariance[place, place], 0.0)))
