"""What the columns of a table are, by their names or a row of units, and which rows are fitted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from cylcontact.files.table import Table, require_rows
from cylcontact.files.units import (
    LABELS,
    Column,
    is_unit,
    named_quantity,
    quantity_and_unit,
    spellings,
    unit_in,
)
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray
from cylcontact.support.choices import BRANCHES, Branch, first_of
from cylcontact.support.errors import InputError

# Names of columns that a step or an error lists.
_LISTED = 8


@dataclass(frozen=True)
class Mapped:
    """A table, and what its columns are."""

    table: Table
    columns: dict[int, Column]
    group: int | None
    left_out: list[str]

    def indices(self, *, of_words: bool) -> list[int]:
        """Return the indices of the columns of words, or of those of numbers."""
        return [k for k, c in self.columns.items() if (c.quantity in LABELS) == of_words]


def mapped(
    table: Table, given: Mapping[str, str], group: str | None, ignored: Sequence[str]
) -> Mapped:
    """Return what the columns of a table are."""
    for name in ignored:
        _require_there(table, "ignore", name)
    if group is not None:
        _require_one(table, "group", group)
    units, table = _units_below(table)
    columns = _given_columns(table, given, units)
    explicit = {column.quantity for column in columns.values()}
    if group is not None:
        explicit.add("group")
    left_out: list[str] = []
    for k, name in enumerate(table.names):
        if k in columns or name in ignored:
            continue
        column = _column(table, name, units[k])
        if column is not None and column.quantity not in explicit:
            _require_once(table, column, columns)
            columns[k] = column
        elif name != group and (name or any(cell is not None for cell in table.columns[k])):
            left_out.append(name)
    if left_out:
        count = "1 column" if len(left_out) == 1 else f"{len(left_out)} columns"
        table.steps.append(f"{count} left out: {first_of(map(repr, left_out), _LISTED)}")
    return Mapped(table, columns, None if group is None else table.names.index(group), left_out)


def require_found(found: Mapped, quantity: str) -> None:
    """Raise `InputError` if no column is of a quantity, and list those left out."""
    if quantity in {column.quantity for column in found.columns.values()}:
        return
    others = (
        f", or name one of {first_of(map(repr, found.left_out), _LISTED)} with "
        f"{option_for(quantity, found.left_out)}"
    )
    remedy = f"add {spellings(quantity)}{others if found.left_out else ''}"
    rule = f"is required{found.table.header_rule}"
    raise InputError(found.table.source, quantity, None, rule, remedy)


def _units_below(table: Table) -> tuple[list[str], Table]:
    """Return the units in the first row, if it holds no number but the 1 of a pure number."""
    cells = ["" if column[0] is None else str(column[0]) for column in table.columns]
    if not any(map(is_unit, cells)) or any(_is_number(cell) for cell in cells if cell != "1"):
        return [""] * len(cells), table
    steps = [*table.steps, f"{table.row_word} {table.lines[0]} is read as units"]
    below = [column[1:] for column in table.columns]
    without = replace(table, lines=table.lines[1:], columns=below, steps=steps)
    require_rows(without)
    return cells, without


def _is_number(text: str) -> bool:
    """Return whether a cell is a number, with either decimal mark."""
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True


def _given_columns(
    table: Table, given: Mapping[str, str], units: Sequence[str]
) -> dict[int, Column]:
    columns: dict[int, Column] = {}
    for key, name in given.items():
        where = f"columns.{key}"
        _require_one(table, where, name)
        k = table.names.index(name)
        parsed = quantity_and_unit(key)
        if parsed is None:
            remedy = "give e.g. load_N, penetration_um, dR_um, time_s"
            raise InputError(table.source, where, name, "is not a known quantity", remedy)
        quantity, unit = parsed
        in_table = unit_in(name, quantity) or units[k]
        column = named_quantity(name, quantity, unit or in_table)
        if column is None:
            remedy = f"name it by one of {spellings(quantity)}"
            raise InputError(table.source, where, name, "has no unit that is known", remedy)
        if k in columns:
            rule = f"is {columns[k].quantity} already"
            raise InputError(table.source, where, name, rule, "keep one of them")
        _require_once(table, column, columns)
        stated = named_quantity(name, quantity, in_table)
        if stated is not None and stated.unit not in ("", column.unit):
            table.steps.append(f"column {name!r} is taken in {column.symbol}, not in {in_table}")
        columns[k] = column
    return columns


def _column(table: Table, name: str, unit_below: str) -> Column | None:
    """Return what a column is by its name; None if it is none of a measurement's."""
    parsed = quantity_and_unit(name)
    if parsed is None:
        return None
    quantity, unit = parsed
    if quantity in LABELS:
        return Column(name, quantity)
    column = named_quantity(name, quantity, unit or unit_below)
    if column is None and quantity != "time":
        rule = "has a unit that is not known" if unit or unit_below else "has no unit"
        others = f"leave it out with --ignore {name!r} (in a campaign under ignore)"
        remedy = f"say what it is with {_option(quantity, name)}, or {others}"
        raise InputError(table.source, "columns", name, rule, remedy)
    below = named_quantity(name, quantity, unit_below) if column and unit_below else column
    if column and (below is None or below.unit != column.unit):
        rule, remedy = f"has {unit_below!r} below its name", "correct one of the two units"
        raise InputError(table.source, "columns", name, rule, remedy)
    return column


def option_for(quantity: str, names: Sequence[str]) -> str:
    """Return the option that says which column is a quantity; of one whose unit its name says."""
    named = next((name for name in names if unit_in(name, quantity)), "")
    return f"--columns {quantity}={named!r}" if named else _option(quantity)


def _option(quantity: str, name: str = "COLUMN") -> str:
    plain = spellings(quantity).split(", ")
    best = next((key for key in (f"{quantity}_N", f"{quantity}_um") if key in plain), plain[0])
    return f"--columns {best}={name} (in a campaign {best} under [columns])"


def _require_there(table: Table, key: str, name: str) -> None:
    """Raise `InputError` for a column that is not in the table."""
    if name not in table.names:
        rule, remedy = "is not a column of the table", f"it has {', '.join(table.names)}"
        raise InputError(table.source, key, name, rule, remedy)


def _require_one(table: Table, key: str, name: str) -> None:
    """Raise `InputError` for a name that no column has, or several."""
    _require_there(table, key, name)
    if table.names.count(name) > 1:
        rule = f"is the name of {table.names.count(name)} columns"
        raise InputError(table.source, key, name, rule, "give each column a name of its own")


def _require_once(table: Table, column: Column, columns: Mapping[int, Column]) -> None:
    """Raise `InputError` for a quantity that has a column already."""
    for other in columns.values():
        if other.quantity == column.quantity:
            rule = f"gives the same quantity as {other.name}"
            remedy = f"keep one of them: leave the other out with --ignore {column.name!r}"
            if other.name == column.name:
                remedy = "give each column a name of its own"
            raise InputError(table.source, "columns", column.name, rule, remedy)


# What tells pairs apart.
PAIR_COLUMNS = ("dR", "R_i", "R_j", "E_i", "E_j", "nu_i", "nu_j", "length")
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
    """Return the rows to keep, without those of zero load, and label those of branches."""
    load = numbers["load"]
    codes = np.unique(labels.get("group", [""]), return_inverse=True)[1].astype(np.float64)
    keys = [codes, *(numbers[name] for name in PAIR_COLUMNS if name in numbers)]
    series = equal_rows([key for key in keys if key.size > 1], load.size)
    falls, zero = is_unloading(load, series), load == 0
    if zero.any():
        lines = [str(table.lines[k]) for k in np.flatnonzero(zero)]
        word = table.row_word if len(lines) == 1 else f"{table.row_word}s"
        named = f"{word} {', '.join(lines[:_LISTED])}{', …' if len(lines) > _LISTED else ''}"
        table.steps.append(f"{_rows(zero)} of zero load left out ({named})")
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


def _rows(chosen: BoolArray) -> str:
    """Return how many rows are chosen, in words."""
    count = int(np.count_nonzero(chosen))
    return "1 row" if count == 1 else f"{count} rows"


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
