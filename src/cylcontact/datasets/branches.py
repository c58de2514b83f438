"""Loading and unloading: which rows of a table belong to which, by the course of the load."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from cylcontact.files.sheet import Sheet
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray, equal_rows
from cylcontact.support.choices import BRANCHES, Branch
from cylcontact.support.errors import InputError

# What tells pairs apart.
PAIR_COLUMNS = ("dR", "R_i", "R_j", "E_i", "E_j", "nu_i", "nu_j", "length")
# The part of its range by which a load turns: less is noise.
_NOISE = 0.05
# A branch of fewer rows is a jump to the start of the next one.
_FEWEST = 2
# With fewer rows per turn the loads are in no order.
_ROWS_PER_TURN = 3


def kept_rows(
    sheet: Sheet,
    numbers: Mapping[str, FloatArray],
    labels: dict[str, list[str]],
    branch: Branch | None,
) -> IndexArray:
    """Return the rows to keep, without those of zero load, and label those of branches."""
    load = numbers["load"]
    codes = np.unique(labels.get("group", [""]), return_inverse=True)[1].astype(np.float64)
    keys = [codes, *(numbers[name] for name in PAIR_COLUMNS if name in numbers)]
    series = equal_rows([key for key in keys if key.size > 1], load.size)
    falls, zero = is_unloading(load, series, branch is not None), load == 0
    if zero.all():
        raise InputError(sheet.source, "load", 0.0, "is zero in all rows", "give loads above zero")
    if zero.any():
        lines = [sheet.lines[k] for k in np.flatnonzero(zero)]
        sheet.left_out.append(f"{_rows(zero)} of zero load ({sheet.numbered(lines)})")
    if falls is None:
        if branch is not None:
            rule = "cannot be told: the loads rise and fall in no order"
            remedy = "keep the order of measurement, name the series with --group, or leave it out"
            raise InputError(sheet.source, "branch", branch, rule, remedy)
        return np.flatnonzero(~zero)
    fall, rise = falls & ~zero, ~(falls | zero)
    if fall.any():
        labels["branch"] = [BRANCHES[int(falling)] for falling in fall]
    if branch is None:
        if fall.any():
            counts = f"{_rows(rise)} of loading and {_rows(fall)} of unloading"
            sheet.notes.append(f"{counts}, all kept (--branch loading keeps the first)")
        return np.flatnonzero(~zero)
    kept, other = (fall, rise) if branch == "unloading" else (rise, fall)
    if not kept.any():
        rule, remedy = f"has no rows of {branch}", "leave it out"
        raise InputError(sheet.source, "branch", branch, rule, remedy)
    if other.any():
        name = "loading" if branch == "unloading" else "unloading"
        sheet.left_out.append(f"{_rows(other)} of {name} (--branch {branch})")
    return np.flatnonzero(kept)


def _rows(chosen: BoolArray) -> str:
    """Return how many rows are chosen, in words."""
    count = int(np.count_nonzero(chosen))
    return "1 row" if count == 1 else f"{count} rows"


def is_unloading(load: FloatArray, series: IndexArray, in_order: bool = False) -> BoolArray | None:
    """Return which rows belong to unloading.

    A turning point is where the load turns by more than 5 % of its range. The loads from a peak
    down to the next turning point are unloading, if there are at least two: one alone is where
    the next loading starts. Where loads only fall, in all series, all are unloading if the rows are
    certainly in the order of measurement, else none.
    """
    course = np.zeros(load.size, dtype=np.intp)
    order = np.argsort(series, kind="stable")
    ends = np.flatnonzero(np.diff(series[order])) + 1
    for rows in np.split(order, ends):
        of_series = _course(load[rows])
        if of_series is None:
            return None
        course[rows] = of_series
    # A table may be sorted by falling loads.
    return (course < 0) & (in_order or (course > 0).any())


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
