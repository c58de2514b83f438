"""From the names of a table's columns, and a row of units below them, to quantities and units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from cylcontact.choices import first_of
from cylcontact.errors import InputError
from cylcontact.tables import Table, require_rows
from cylcontact.units import (
    LABELS,
    Column,
    is_unit,
    named_quantity,
    quantity_and_unit,
    spellings,
    unit_in,
)

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
        f", or name one of {first_of(map(repr, found.left_out), _LISTED)} with {_option(quantity)}"
    )
    remedy = f"add {spellings(quantity)}{others if found.left_out else ''}"
    raise InputError(found.table.source, quantity, None, "is required", remedy)


def _units_below(table: Table) -> tuple[list[str], Table]:
    """Return the units in the first row, empty without such a row, and the other rows.

    A row is one of units if it holds a unit and no number but the 1 of a pure number.
    """
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
    """Return the columns that the user names."""
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


def _option(quantity: str, name: str = "COLUMN") -> str:
    """Return the option that names a column."""
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
