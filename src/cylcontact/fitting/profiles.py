"""Profiles of a fit to a reference law: how far coefficients may move before it gets worse.

A reference law has no noise, and a fit to it no confidence interval. The 1 % interval of a
coefficient holds the values for which the objective, with all others re-optimised, stays within
1 % of the optimum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, product

import numpy as np
from scipy.optimize import elementwise

from cylcontact.fitting.objectives import Problem
from cylcontact.fitting.polish import affordable_starts, climb_down, descend
from cylcontact.fitting.records import TOLERANCE, Profile
from cylcontact.laws.law import Coefficients
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray, as_floats

# Values of a coefficient in a profile.
_CURVE_POINTS = 41
_FAR = 1e6
# Precision of an interval's ends, relative to the distance from the optimum.
_EDGE_PRECISION = 1e-4
# Random starts for each refit, the steps to the neighbours that are refitted from it, the relative
# gain for which they are, and those of the descents and of the last one.
_LADDERS, _NEIGHBOURS, _GAIN, _FINER, _PRECISE = 3, (1, 4), 1e-6, 1e-6, 1e-10


class _Minima:
    """The lowest minima of a law with some parameters held at each of N places.

    All refits are one batch, from the best coefficients and from random points. Then each is
    repeated from the minima of its neighbours, until that gains nothing. If only few descents are
    affordable, they spread from the places that are nearest to the best.

    `points` are the best coefficients but for what is `held`, shape (N, k) both, and `neighbours`
    pairs of places, shape (pairs, 2).
    """

    def __init__(
        self,
        problem: Problem,
        best: FloatArray,
        points: FloatArray,
        held: BoolArray,
        neighbours: IndexArray,
    ) -> None:
        self._problem, self._fixed, self._held = problem, points, held
        self.points, self.values = points.copy(), np.full(len(points), np.inf)
        places = np.arange(len(points))
        if affordable_starts(problem):
            many = np.tile(places, _LADDERS)
            random = problem.scatter(np.random.default_rng(0), many.size)
            random = climb_down(problem, np.where(held[many], points[many], random), held[many])
            changed = self._refit(np.vstack([points, random]), np.tile(places, 1 + _LADDERS))
        else:
            away = (np.abs(points - best) / (problem.high - problem.low)).sum(axis=1)
            nearest = np.flatnonzero(away == away.min())
            changed = self._refit(points[nearest], nearest)
        while changed.size:
            here, there = neighbours[np.isin(neighbours[:, 0], changed)].T
            changed = self._refit(self.points[here], there)
        self._refit(self.points, places, precision=_PRECISE)

    def _refit(
        self, starts: FloatArray, places: IndexArray, precision: float = _FINER
    ) -> IndexArray:
        """Refit from starts at some places, and return those where that is noticeably lower."""
        held = self._held[places]
        starts = np.where(held, self._fixed[places], starts)
        ends, values = descend(self._problem, starts, precision, held)
        before = self.values.copy()
        for end, value, place in zip(ends, values, places, strict=True):
            if value < self.values[place]:
                self.points[place], self.values[place] = end, value
        return np.flatnonzero(self.values < before * (1 - _GAIN))

    def value_at(self, fixed: FloatArray, inner: IndexArray, outer: IndexArray) -> FloatArray:
        """Return the lowest values with others held than at two places, from whose minima."""
        held = self._held[inner]
        starts = np.concatenate(
            [np.where(held, fixed[:, None], self.points[k]) for k in (inner, outer)]
        )
        values = descend(self._problem, starts, _PRECISE, np.tile(held, (2, 1)))[1]
        return as_floats(values.reshape(2, -1).min(axis=0))


def _neighbours(places: IndexArray) -> IndexArray:
    """Return the pairs of places so many steps apart along an axis, shape (pairs, 2)."""
    pairs = []
    for axis, step in product(range(places.ndim), _NEIGHBOURS):
        size = places.shape[axis]
        here = places.take(range(size - step), axis).ravel()
        there = places.take(range(step, size), axis).ravel()
        pairs += [np.stack([here, there], axis=1), np.stack([there, here], axis=1)]
    return np.concatenate(pairs)


@dataclass(frozen=True)
class _Curve:
    """The places at which a coefficient is held for its profile, and its values there."""

    name: str
    places: IndexArray
    values: FloatArray


def profiles(
    problem: Problem, names: Sequence[str], best: Coefficients, published: Coefficients | None
) -> dict[str, Profile]:
    """Profile the objective over parameters, at even values, the best and the published one."""
    curves: list[_Curve] = []
    for name in names:
        parameter = problem.free[problem.names.index(name)]
        extra = [each[name] for each in (best, published) if each]
        even = np.linspace(parameter.low, parameter.high, _CURVE_POINTS)
        values, first = np.union1d(even, extra), sum(each.values.size for each in curves)
        curves.append(_Curve(name, np.arange(first, first + values.size), values))
    points = np.tile(problem.point(best), (curves[-1].places[-1] + 1, 1))
    held = np.zeros(points.shape, dtype=bool)
    for curve in curves:
        column = problem.names.index(curve.name)
        points[curve.places, column], held[curve.places, column] = curve.values, True
    neighbours = np.concatenate([_neighbours(curve.places) for curve in curves])
    minima = _Minima(problem, problem.point(best), points, held, neighbours)
    ends = _ends(minima, curves, best, problem.value_of(best))
    found = {}
    for curve, cut in zip(curves, ends, strict=True):
        parameter = problem.free[problem.names.index(curve.name)]
        low, high = np.where(np.isnan(cut), [parameter.low, parameter.high], cut)
        objective = minima.values[curve.places]
        defined = np.isfinite(objective)
        at_published = defined & (curve.values == (published or {}).get(curve.name))
        found[curve.name] = Profile(
            values=curve.values[defined].tolist(),
            objective=objective[defined].tolist(),
            low=float(low),
            high=float(high),
            low_is_bound=bool(np.isnan(cut[0])),
            high_is_bound=bool(np.isnan(cut[1])),
            objective_at_published=next(iter(objective[at_published].tolist()), None),
        )
    return found


def _ends(
    minima: _Minima, curves: Sequence[_Curve], best: Coefficients, optimum: float
) -> FloatArray:
    """Return the ends of the 1 % intervals, shape (curves, 2); NaN where a bound cuts one off."""

    def excess(objective: FloatArray) -> FloatArray:
        # This root is nearly linear in the coefficient.
        root = np.sqrt(np.maximum(objective - optimum, 0.0) / (TOLERANCE * optimum))
        return as_floats(np.minimum(root, _FAR) - 1)

    is_outside = excess(minima.values) > 0
    brackets: list[tuple[int, ...]] = []
    for number, curve in enumerate(curves):
        middle = int(np.searchsorted(curve.values, best[curve.name]))
        for side, towards in enumerate((range(middle, -1, -1), range(middle, curve.values.size))):
            outside = (k for k in curve.places[list(towards)] if is_outside[k])
            brackets += [(number, side, k - towards.step, k) for k in islice(outside, 1)]
    ends = np.full((len(curves), 2), np.nan)
    if brackets:
        number, side, inner, outer = np.array(brackets).T
        middle = np.array([best[curve.name] for curve in curves])[number]
        values = np.concatenate([curve.values for curve in curves])
        root = elementwise.find_root(
            lambda step, middle, *places: excess(minima.value_at(middle + step, *places)),
            (values[inner] - middle, values[outer] - middle),
            args=(middle, inner, outer),
            tolerances={"xrtol": _EDGE_PRECISION},
        )
        # Where the refit at the outer place gains a little more, the end is there.
        ends[number, side] = np.where(root.success, middle + root.x, values[outer])
    return ends
