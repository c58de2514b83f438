"""Which rows of a table are fitted: loads above zero, of loading, of unloading or of both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from cylcontact.arrays import BoolArray, FloatArray, IndexArray
from cylcontact.choices import BRANCHES, Branch
from cylcontact.errors import InputError
from cylcontact.tables import Table

# What tells pairs apart.
PAIR_COLUMNS = ("dR", "R_i", "R_j", "E_i", "E_j", "nu_i", "nu_j", "length")
# Positions of rows that a step lists.
_LISTED = 8
# The part of its range by which a load turns: less is noise.
_NOISE = 0.05
# A branch of fewer rows is a jump to the start of the next one.
_FEWEST = 2
# With fewer rows per turn the loads are in no order.
_ROWS_PER_TURN = 3


def kept_rows(
    table: Table,
    numbers: Mapping[str, FloatArray],
    labels: dict[str, list[str]],
    branch: Branch | None,
) -> IndexArray:
    """Return the rows to keep, and add to the labels the branch of each row if loads fall.

    Rows of zero load are left out; they help to find the branches before.
    """
    load = numbers["load"]
    falls = is_unloading(load, _series(numbers, labels, load.size))
    zero = load == 0
    if zero.any():
        table.steps.append(f"{_rows(zero)} of zero load left out ({_at(table, zero)})")
    if zero.all():
        raise InputError(table.source, "load", 0.0, "is zero in all rows", "give loads above zero")
    keeps = ~zero
    if falls is None and branch is not None:
        rule = "cannot be told: the loads rise and fall in no order"
        remedy = "keep the order of measurement, name the series with --group, or leave it out"
        raise InputError(table.source, "branch", branch, rule, remedy)
    if falls is not None and (falls & ~zero).any():
        labels["branch"] = [BRANCHES[fall] for fall in falls.astype(int)]
    keeps &= _of_branch(table, np.zeros_like(zero) if falls is None else falls, zero, branch)
    return np.flatnonzero(keeps)


def _of_branch(table: Table, falls: BoolArray, zero: BoolArray, branch: Branch | None) -> BoolArray:
    """Return which rows are of a branch, all without one; say how many there are of each."""
    fall, rise = falls & ~zero, ~(falls | zero)
    kept, other = (fall, rise) if branch == "unloading" else (rise, fall)
    if branch is None:
        if fall.any():
            counts = f"{_rows(rise)} of loading and {_rows(fall)} of unloading"
            table.steps.append(f"{counts}, all kept (--branch loading keeps the first)")
        return np.ones_like(falls)
    if not kept.any():
        rule, remedy = f"has no rows of {branch}", "leave it out"
        raise InputError(table.source, "branch", branch, rule, remedy)
    name = "loading" if branch == "unloading" else "unloading"
    table.steps.append(f"{_rows(other)} of {name} left out (--branch {branch})")
    return kept


def _series(
    numbers: Mapping[str, FloatArray], labels: dict[str, list[str]], size: int
) -> IndexArray:
    """Return the series of each row: its group and pair."""
    pair = [numbers[name] for name in PAIR_COLUMNS if name in numbers]
    group = labels.get("group", [""])
    codes = {word: code for code, word in enumerate(dict.fromkeys(group))}
    keys = [*pair, np.array([codes[word] for word in group], dtype=np.float64)]
    return equal_rows([key for key in keys if key.size > 1], size)


def _rows(chosen: BoolArray) -> str:
    """Return how many rows are chosen, in words."""
    count = int(np.count_nonzero(chosen))
    return "1 row" if count == 1 else f"{count} rows"


def _at(table: Table, chosen: BoolArray) -> str:
    """Return the positions of chosen rows in the file, the first few of many."""
    lines = [str(table.lines[k]) for k in np.flatnonzero(chosen)]
    word = table.row_word if len(lines) == 1 else f"{table.row_word}s"
    return f"{word} {', '.join(lines[:_LISTED])}{', …' if len(lines) > _LISTED else ''}"


def equal_rows(columns: Sequence[FloatArray], size: int) -> IndexArray:
    """Return a number for each of N rows, the same for rows that are equal in all columns."""
    if not columns:
        return np.zeros(size, dtype=np.intp)
    return np.unique(np.column_stack(columns), axis=0, return_inverse=True)[1].reshape(-1)


def is_unloading(load: FloatArray, series: IndexArray) -> BoolArray | None:
    """Return which rows belong to unloading.

    A turning point is where the load turns by more than 5 % of its range. The loads from a peak
    down to the next turning point are unloading, if there are at least two: one alone is where
    the next loading starts. Where loads only fall, in all series, none is unloading.
    """
    course = np.zeros(load.size, dtype=np.intp)
    order = np.argsort(series, kind="stable")
    ends = np.flatnonzero(np.diff(series[order])) + 1
    for rows in np.split(order, ends):
        of_series = _course(load[rows])
        if of_series is None:
            return None
        course[rows] = of_series
    # A table in falling order of loads says nothing of unloading.
    return (course < 0) & (course > 0).any()


def _course(load: FloatArray) -> IndexArray | None:
    """Return of each load of a series whether it belongs to a rise (1), a fall (-1) or a jump."""
    course = np.zeros(load.size, dtype=np.intp)
    turns = _turning_points(load)
    if load.size < _ROWS_PER_TURN * len(turns):
        return None
    for before, last in pairwise([-1, *turns, load.size - 1]):
        if last - before >= _FEWEST:
            first = load[max(before, 0)]
            course[before + 1 : last + 1] = int(load[last] > first) - int(load[last] < first)
    return course


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
