"""Profiles of a fit: how far parameters may move before it gets worse by so much.

A profile fixes a parameter and refits the others. What is worse by so much depends on what the
residuals are:

- *noise* of measurements: the likelihood ratio to the optimum is (S(θ) − S)/τ if the noise is
  Gaussian. An interval or region holds the values for which it stays below the quantile of χ²
  (standard deviations known) or of F (not known). Unlike an interval from the covariance it
  follows the curvature of the law.
- *discrepancy* of a law, which has no noise and no confidence interval: the 1 % interval holds
  the values for which the objective stays within 1 % of the optimum.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations, product

import numpy as np
from pydantic import Field
from scipy.optimize import brentq

from cylcontact.arrays import FloatArray, IndexArray
from cylcontact.fitting.least_squares import descend as descend_to_data
from cylcontact.fitting.polish import affordable_starts, climb_down, descend, polish, scatter
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.residual_model import ResidualModel, residual_model_at
from cylcontact.laws.law import Coefficients
from cylcontact.spec import Spec

__all__ = [
    "BETTER",
    "FAIRLY",
    "TOLERANCE",
    "WELL",
    "Descent",
    "DiscrepancyPair",
    "Interval",
    "PairMap",
    "Profile",
    "discrepancy_pair",
    "fixed_ratio",
    "interval",
    "is_at_bound",
    "likelihood_profile",
    "pair_map",
    "pairs_of",
    "profile",
    "refit_to_data",
    "refit_to_law",
]

# Half-widths of an interval, relative to the value, up to which a parameter is well or fairly
# determined.
WELL, FAIRLY = 0.02, 0.10
# Precision of an interval's ends, relative to the distance from the optimum.
_EDGE_PRECISION = 1e-4
# Closer to a bound than this, relative to its interval, a parameter is at it.
_AT_BOUND = 1e-9
# The first step towards an end, relative to the distance to the bound.
_FIRST_STEP = 1e-6
# Half-widths of the intervals on either side of the optimum in a map of a pair. The contour of 10 %
# is at about 3.2 half-widths of the 1 % interval.
_REACH_OF_NOISE, _REACH_OF_LAWS = 1.6, 4.0
# Values of each parameter in a map of a pair, and in a profile of the objective.
_PAIR_POINTS, _CURVE_POINTS = 21, 41
_FAR = 1e6
# Below this ratio the profile found a better optimum; it is not round-off.
BETTER = -1e-6
# Random starts for each refit of a law, the steps to the neighbours that are refitted from it, the
# relative gain for which they are, and those of the descents and of the last one.
_LADDERS, _NEIGHBOURS, _GAIN, _FINER, _PRECISE = 4, (1, 4), 1e-6, 1e-6, 1e-10
# The rise of the objective at the ends of the interval of a law.
TOLERANCE = 0.01

# From a problem and a start to a minimum and its objective.
Descent = Callable[[Problem, FloatArray], tuple[FloatArray, float]]


class Interval(Spec):
    """An interval of a parameter."""

    low: float = Field(description="the lower end")
    high: float = Field(description="the upper end")
    low_is_bound: bool = Field(description="whether a bound of the search cuts it off below")
    high_is_bound: bool = Field(description="whether a bound of the search cuts it off above")
    lowest: float = Field(
        0.0, description="the lowest (S(θ) − S)/τ; below 0 there is a better optimum"
    )


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
        if is_at_bound(self, value):
            return "at a bound"
        if self.low_is_bound or self.high_is_bound or half_width > FAIRLY * abs(value):
            return "poorly"
        return "well" if half_width <= WELL * abs(value) else "fairly"


class _Map(Spec):
    """Values of two parameters over which something is mapped."""

    names: tuple[str, str] = Field(description="the two parameters", strict=False)
    x: list[float] = Field(description="values of the first, increasing")
    y: list[float] = Field(description="values of the second, increasing")


class PairMap(_Map):
    """The likelihood ratio over two parameters, all others refitted."""

    ratio: list[list[float | None]] = Field(
        description="(S(θ) − S)/τ, a row for each y; null where the law is undefined, "
        "below 0 where a better optimum was found"
    )
    thresholds: dict[str, float] = Field(description="the contour of each level, in percent")


class DiscrepancyPair(_Map):
    """The rise of the objective over two coefficients, all others re-optimised."""

    rise: list[list[float | None]] = Field(
        description="best objective over the optimum, less 1; null where the law is undefined"
    )


def is_at_bound(ends: Interval | Profile, value: float) -> bool:
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
    ends: Interval | Profile,
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
            rtol=_EDGE_PRECISION,
            xtol=_EDGE_PRECISION * outer,
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


def refit_to_law(problem: Problem, start: FloatArray) -> tuple[FloatArray, float]:
    """Return the minimum of a problem on a grid, less precise than a run's, and its objective."""
    return polish(problem, start, precision=1e-10)


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
    x = around(problem, best, name, ends, _REACH_OF_NOISE)
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
    x, y = (around(problem, best, name, intervals[name], _REACH_OF_NOISE, points) for name in names)
    free = [p.name for p in problem.free]
    places = [free.index(name) for name in names]
    return PairMap(
        names=names,
        x=x,
        y=y,
        ratio=refits.over(names, x, y),
        thresholds={f"{100 * level:g}": noise.threshold(level, places) for level in levels},
    )


# --- discrepancy of laws ----------------------------------------------------------------------


class _Minima:
    """The lowest minima of a law with some parameters fixed at each of a lattice of values.

    All refits are one batch, from the best coefficients and from random points. Then each is
    repeated from the minima of its neighbours, until that gains nothing. If only few descents are
    affordable, they spread from the values that are nearest to the best.
    """

    def __init__(
        self, problem: Problem, best: Coefficients, names: Sequence[str], axes: Sequence[FloatArray]
    ) -> None:
        self._problem = problem
        self._held = [[p.name for p in problem.free].index(name) for name in names]
        lattice = np.meshgrid(*axes, indexing="ij")
        self._fixed = np.stack([axis.ravel() for axis in lattice], axis=1)
        places = np.arange(len(self._fixed))
        self.points = np.tile(problem.point(best), (places.size, 1))
        self.points[:, self._held] = self._fixed
        self.values = np.full(places.size, np.inf)
        if affordable_starts(problem):
            random = scatter(problem, np.random.default_rng(0), _LADDERS * places.size)
            many = np.tile(places, 1 + _LADDERS)
            random[:, self._held] = self._fixed[many[places.size :]]
            random = climb_down(problem, random, self._held)
            changed = self._refit(np.vstack([self.points, random]), many)
        else:
            span = (problem.high - problem.low)[self._held]
            away = np.abs(self._fixed - problem.point(best)[self._held]) / span
            nearest = places[[away.sum(axis=1).argmin()]]
            changed = self._refit(self.points[nearest], nearest)
        beside = _neighbours(places.reshape(lattice[0].shape))
        while changed.size:
            here, there = beside[np.isin(beside[:, 0], changed)].T
            changed = self._refit(self.points[here], there)
        self._refit(self.points, places, precision=_PRECISE)

    def _refit(
        self, starts: FloatArray, places: IndexArray, precision: float = _FINER
    ) -> IndexArray:
        """Refit from starts at some places, and return those where that is noticeably lower."""
        starts = starts.copy()
        starts[:, self._held] = self._fixed[places]
        ends, values = descend(self._problem, starts, precision, self._held)
        before = self.values.copy()
        for end, value, place in zip(ends, values, places, strict=True):
            if value < self.values[place]:
                self.points[place], self.values[place] = end, value
        return np.flatnonzero(self.values < before * (1 - _GAIN))

    def end(self, best: float, optimum: float, bound: float) -> tuple[float, bool]:
        """Return the end towards a bound of the 1 % interval, and whether it is the bound.

        For a lattice of one parameter, with the optimum among its values.
        """
        values, way = self._fixed[:, 0], 1 if bound > best else -1
        (middle,) = np.flatnonzero(values == best)
        limit = np.sqrt(TOLERANCE * optimum)

        def excess(objective: float) -> float:
            # This root is nearly linear in the parameter.
            return float(min(np.sqrt(max(objective - optimum, 0.0)) / limit, _FAR) - 1)

        towards = range(middle, values.size) if way > 0 else range(middle, -1, -1)
        outer = next((k for k in towards if excess(self.values[k]) > 0), None)
        if outer is None:
            return bound, True
        inner = outer - way

        def excess_at(distance: float) -> float:
            starts = self.points[[inner, outer]]
            starts[:, self._held] = best + distance
            return excess(descend(self._problem, starts, _PRECISE, self._held)[1].min())

        distance = brentq(
            excess_at, values[inner] - best, values[outer] - best, rtol=_EDGE_PRECISION, xtol=1e-14
        )
        return best + float(distance), False


def _neighbours(places: IndexArray) -> IndexArray:
    """Return the pairs of places so many steps apart along an axis, shape (pairs, 2)."""
    pairs = []
    for axis, step in product(range(places.ndim), _NEIGHBOURS):
        size = places.shape[axis]
        here = places.take(range(size - step), axis).ravel()
        there = places.take(range(step, size), axis).ravel()
        pairs += [np.stack([here, there], axis=1), np.stack([there, here], axis=1)]
    return np.concatenate(pairs)


def profile(problem: Problem, name: str, best: Coefficients, published: float | None) -> Profile:
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
    minima = _Minima(problem, best, [name], [grid])
    objective = minima.values
    defined = np.isfinite(objective)
    optimum = problem.value_of(best)
    low, low_is_bound = minima.end(best[name], optimum, parameter.low)
    high, high_is_bound = minima.end(best[name], optimum, parameter.high)
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


def discrepancy_pair(
    problem: Problem,
    names: tuple[str, str],
    best: Coefficients,
    profiles: Mapping[str, Profile],
) -> DiscrepancyPair:
    """Return the rise of the objective over two coefficients, all others re-optimised.

    Parameters
    ----------
    problem, best
        As for `profile`.
    names : tuple of str
        The two coefficients.
    profiles : mapping
        Their profiles, which set the extent of the map.

    Returns
    -------
    DiscrepancyPair
    """
    x, y = (around(problem, best, name, profiles[name], _REACH_OF_LAWS) for name in names)
    minima = _Minima(problem, best, names[::-1], [np.array(y), np.array(x)])
    rise = minima.values.reshape(len(y), len(x)) / problem.value_of(best) - 1
    rows = [[float(v) if np.isfinite(v) else None for v in row] for row in rise]
    return DiscrepancyPair(names=names, x=x, y=y, rise=rows)
