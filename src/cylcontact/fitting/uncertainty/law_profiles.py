"""Profiles of a fit to a reference law: how far coefficients may move before it gets worse.

A reference law has no noise, and a fit to it no confidence interval. The 1 % interval of a
coefficient holds the values for which the objective, with all others re-optimised, stays within
1 % of the optimum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
from pydantic import Field
from scipy.optimize import brentq

from cylcontact.arrays import FloatArray, IndexArray
from cylcontact.fitting.polish import affordable_starts, climb_down, descend
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.profiles import (
    EDGE_PRECISION,
    FAIRLY,
    WELL,
    ParameterMap,
    around,
    is_at_bound,
)
from cylcontact.laws.definition import Coefficients
from cylcontact.spec import Spec

# The rise of the objective at the ends of the interval of a coefficient.
TOLERANCE = 0.01
# Values of a coefficient in a profile.
_CURVE_POINTS = 41
# Half-widths of the intervals on either side of the optimum in a map of a pair: the contour of 10 %
# is at about 3.2.
_REACH = 4.0
_FAR = 1e6
# Random starts for each refit, the steps to the neighbours that are refitted from it, the relative
# gain for which they are, and those of the descents and of the last one.
_LADDERS, _NEIGHBOURS, _GAIN, _FINER, _PRECISE = 4, (1, 4), 1e-6, 1e-6, 1e-10


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


class DiscrepancyPair(ParameterMap):
    """The rise of the objective over two coefficients, all others re-optimised."""

    rise: list[list[float | None]] = Field(
        description="best objective over the optimum, less 1; null where the law is undefined"
    )


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
            random = problem.scatter(np.random.default_rng(0), _LADDERS * places.size)
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
            excess_at, values[inner] - best, values[outer] - best, rtol=EDGE_PRECISION, xtol=1e-14
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

    The curve has equidistant values between the bounds, the best and the published value, except
    those for which the law is undefined.
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
    """Map the objective over two coefficients, as far as their profiles reach."""
    x, y = (around(problem, best, name, profiles[name], _REACH) for name in names)
    minima = _Minima(problem, best, names[::-1], [np.array(y), np.array(x)])
    rise = minima.values.reshape(len(y), len(x)) / problem.value_of(best) - 1
    rows = [[float(v) if np.isfinite(v) else None for v in row] for row in rise]
    return DiscrepancyPair(names=names, x=x, y=y, rise=rows)
