"""Profiles: how much worse a fit gets when a parameter moves and all others follow.

A profile is the lowest objective with one parameter held, as a function of its value. Each value is
refitted from the minima of its neighbours, beginning at the optimum. All refits are remembered;
where one is lower, its neighbours are refitted from it. So the ends of an interval lie between two
values that are known to be inside and outside of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from cylcontact.fitting.search import descend
from cylcontact.fitting.space import Space
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray

# Neighbours that are refitted from a lower minimum, and the relative gain for which they are.
_NEIGHBOURS, _GAIN = (1, 4), 1e-6
# Relative gains at the end of a descent and of the last one.
_FINE, _EXACT = 1e-6, 1e-10
_Distance = Callable[[FloatArray, int], FloatArray]
# An end is where the distance is 1 to this precision, after so many steps at most.
_PRECISION, _STEPS = 1e-4, 40


class Profiles:
    """The profiles of some parameters of a space, at places that are remembered.

    Parameters
    ----------
    space : Space
        What is fitted.
    best : array of float, shape (k,)
        The free parameters at the optimum.
    values : sequence of arrays of float
        For each free parameter the values at which it is held first; none for no profile.
    """

    def __init__(self, space: Space, best: FloatArray, values: Sequence[FloatArray]) -> None:
        self.space, self.best = space, best
        # Of each of N places the parameter that is held, the lowest point and its objective.
        self.axis = np.repeat(np.arange(len(values)), [each.size for each in values])
        self.points = np.tile(best, (self.axis.size, 1))
        self.objective = np.full(self.axis.size, np.inf)
        self.points[np.arange(self.axis.size), self.axis] = np.concatenate(values)
        places = np.arange(self.axis.size)
        if space.in_batches:
            first = places
        else:  # spread from the places that are nearest to the optimum
            away = np.abs(self.at - best[self.axis]) / space.span[self.axis]
            own = map(self.places, set(self.axis.tolist()))
            first = np.array([each[away[each].argmin()] for each in own])
        self._refit(self.points[first], first)
        self._spread(first)
        self._refit(self.points, places, _EXACT)

    @property
    def at(self) -> FloatArray:
        """The value of the parameter that is held at each place, shape (N,)."""
        return self.points[np.arange(self.axis.size), self.axis]

    def places(self, axis: int) -> IndexArray:
        """Return the places of a parameter, in the order of its values."""
        own = np.flatnonzero(self.axis == axis)
        return own[np.argsort(self.at[own], kind="stable")]

    def ends(self, distance: _Distance) -> FloatArray:
        """Return the ends of the interval of each parameter, shape (k, 2).

        `distance` of an objective, towards the lower (0) or upper side (1), is 0 at the optimum, 1
        at the ends of an interval, and nearly linear in a parameter. NaN stands for an end beyond
        the bound.
        """
        ends = np.full((self.best.size, 2), np.nan)
        sides = [key for key in np.ndindex(ends.shape) if key[0] in self.axis]
        for step in range(_STEPS):
            pairs = {key: self._bracket(distance, *key) for key in sides}
            if self._extend([key for key, pair in pairs.items() if pair is None]):
                continue
            brackets = {key: pair for key, pair in pairs.items() if pair}
            inner, outer = np.array([*brackets.values()], dtype=np.intp).reshape(-1, 2).T
            low, high = self.at[inner], self.at[outer]
            of_side = [side for _, side in brackets]
            inside, outside = (
                np.array(
                    [
                        distance(self.objective[[k]], s)[0]
                        for k, s in zip(each, of_side, strict=True)
                    ]
                )
                - 1
                for each in (inner, outer)
            )
            share = inside / (inside - outside)
            for key, end in zip(brackets, low + share * (high - low), strict=True):
                ends[key] = end
            width = np.abs(high - low) / np.abs(high - self.best[self.axis[outer]])
            on = (np.minimum(-inside, outside) > _PRECISION) & (width > _PRECISION)
            if not on.any():
                break
            # Every third step halves the bracket, where the distance is far from linear.
            share = np.clip(np.full(share.size, 0.5) if step % 3 == 2 else share, 0.05, 0.95)
            self._insert((low + share * (high - low))[on], inner[on], outer[on])
        return ends

    def _bracket(self, distance: _Distance, axis: int, side: int) -> tuple[int, int] | None:
        """Return the last place inside an interval towards a side and the first outside."""
        own = self.places(axis)
        middle = int(np.searchsorted(self.at[own], self.best[axis]))
        way = own[middle:] if side else own[middle::-1]
        outside = np.flatnonzero(distance(self.objective[way], side) > 1)
        return (int(way[outside[0] - 1]), int(way[outside[0]])) if outside.size else None

    def _extend(self, sides: list[tuple[int, int]]) -> bool:
        """Add a place twice as far, or at the bound, to each side that does not reach an end."""
        last, at = [], []
        for axis, side in sides:
            place = self.places(axis)[-1 if side else 0]
            bound, best = (self.space.low, self.space.high)[side][axis], self.best[axis]
            far = best + 2 * (self.at[place] - best)
            if self.at[place] != bound:
                last.append(place)
                at.append(min(far, bound) if side else max(far, bound))
        if last:
            self._insert(np.array(at), np.array(last))
        return bool(last)

    def _insert(self, at: FloatArray, *beside: IndexArray) -> None:
        """Refit at new places from those beside them.

        Where two of these lead to different minima, so may their neighbours.
        """
        new = self.axis.size + np.arange(at.size)
        self.axis = np.append(self.axis, self.axis[beside[0]])
        self.points = np.vstack([self.points, self.points[beside[0]]])
        self.points[new, self.axis[new]] = at
        self.objective = np.append(self.objective, np.full(new.size, np.inf))
        starts = self.points[np.concatenate(beside)]
        values = self._refit(starts, np.tile(new, len(beside))).reshape(len(beside), -1)
        agree = values.max(axis=0) <= values.min(axis=0) * (1 + _GAIN)
        self._spread(new[~agree] if len(beside) > 1 else new)
        self._refit(self.points[new], new, _EXACT)

    def _spread(self, changed: IndexArray) -> None:
        """Refit the neighbours of places that are lower than before, until that gains nothing."""
        while changed.size:
            pairs = []
            for axis in set(self.axis[changed].tolist()):
                own = self.places(axis)
                for step in _NEIGHBOURS:
                    pairs += [[own[:-step], own[step:]], [own[step:], own[:-step]]]
            here, there = np.concatenate(pairs, axis=1).astype(np.intp)
            from_changed = np.isin(here, changed)
            before = self.objective.copy()
            self._refit(self.points[here[from_changed]], there[from_changed])
            changed = np.flatnonzero(self.objective < before * (1 - _GAIN))

    def _refit(
        self, starts: FloatArray, places: IndexArray, precision: float = _FINE
    ) -> FloatArray:
        """Refit at some places from starts; return the objective from each."""
        starts = self._holding(starts, places)
        ends, values = descend(self.space, starts, precision, self._held(places))
        for end, value, place in zip(ends, values, places, strict=True):
            if value < self.objective[place]:
                self.points[place], self.objective[place] = end, value
        return values

    def _holding(self, starts: FloatArray, places: IndexArray) -> FloatArray:
        return np.where(self._held(places), self.points[places], starts)

    def _held(self, places: IndexArray) -> BoolArray:
        return np.asarray(np.arange(self.best.size) == self.axis[places][:, None])
