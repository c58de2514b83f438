"""Branches of loading and unloading, from the course of the loads."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from cylcontact.arrays import BoolArray, FloatArray, IndexArray

__all__ = ["is_unloading"]

# The part of its range by which a load turns: less is noise.
_NOISE = 0.05
# A branch of fewer rows is a jump to the start of the next one.
_FEWEST = 2
# With fewer rows per turn the loads are in no order.
_ROWS_PER_TURN = 3


def is_unloading(load: FloatArray, series: IndexArray) -> BoolArray | None:
    """Return which rows belong to unloading.

    A turning point is where the load turns by more than 5 % of its range. The loads from a peak
    down to the next turning point are unloading, if there are at least two: one alone is where
    the next loading starts.

    Parameters
    ----------
    load : array, shape (N,)
        Loads in the order of measurement.
    series : array of int, shape (N,)
        The series of each row; each has its own course.

    Returns
    -------
    array of bool, shape (N,), or None
        None if the loads of a series rise and fall in no order.

    Examples
    --------
    >>> load = np.array([1.0, 5.0, 9.0, 10.0, 6.0, 2.0])
    >>> is_unloading(load, np.zeros(6, dtype=int))
    array([False, False, False, False,  True,  True])
    >>> is_unloading(np.array([3.0, 9.0, 1.0, 8.0, 2.0, 7.0]), np.zeros(6, dtype=int)) is None
    True
    """
    falls = np.zeros(load.size, dtype=bool)
    order = np.argsort(series, kind="stable")
    ends = np.flatnonzero(np.diff(series[order])) + 1
    for rows in np.split(order, ends):
        of_series = _falls(load[rows])
        if of_series is None:
            return None
        falls[rows] = of_series
    return falls


def _falls(load: FloatArray) -> BoolArray | None:
    """Return which loads of one series belong to unloading."""
    falls = np.zeros(load.size, dtype=bool)
    turns = _turning_points(load)
    if load.size < _ROWS_PER_TURN * len(turns):
        return None
    any_loading = False
    for before, last in pairwise([-1, *turns, load.size - 1]):
        if last - before < _FEWEST:
            continue
        if load[last] < load[max(before, 0)]:
            falls[before + 1 : last + 1] = True
        else:
            any_loading = True
    # A table in falling order of loads, or several of them, says nothing of unloading.
    return falls & any_loading


def _turning_points(load: FloatArray) -> list[int]:
    """Return the rows of peaks and troughs in turn, without the ends."""
    values, turns = load.tolist(), []
    noise = _NOISE * (max(values) - min(values))
    high = low = 0
    is_rising: bool | None = None
    for row, value in enumerate(values):
        high = row if value >= values[high] else high
        low = row if value <= values[low] else low
        if is_rising is not False and value < values[high] - noise:
            turns += [high] if is_rising else []
            is_rising, low = False, row
        elif is_rising is not True and value > values[low] + noise:
            turns += [low] if is_rising is False else []
            is_rising, high = True, row
    return turns
