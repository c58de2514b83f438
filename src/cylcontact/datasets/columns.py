"""Which columns of a table are of which quantity and unit: by their names, or as options say."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping
from contextlib import suppress

from cylcontact.files.numbers import seconds
from cylcontact.files.sheet import Sheet
from cylcontact.files.units import (
    LABELS,
    LETTER,
    QUANTITIES,
    Column,
    Meaning,
    meaning_of,
    spellings,
    symbol,
    unit_in,
    unit_of,
    units_of,
)
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import brief

# Without these there is no fit; any other column may be odd.
MEASURED = ("load", "penetration")
_UNITS_LISTED = 10
# Masses whose weight is a unit of force.
_WEIGHTS = {"kg": "kgf", "lb": "lbf"}


def option_for(sheet: Sheet, quantity: str, k: int) -> str:
    """Return the option that says which column is a quantity, as a shell takes it.

    If neither the name nor the row of units has its unit, UNIT is left open: any would be wrong.
    """
    name = sheet.names[k] if sheet.names else str(k + 1)
    is_known = _unit_in_table(sheet, k, quantity)[0] in QUANTITIES[quantity]
    key = quantity if is_known else f"{quantity}_UNIT"
    return f"--columns {shlex.quote(f'{key}={name}')}"


def _unit_in_table(sheet: Sheet, k: int, quantity: str) -> tuple[str, str]:
    """Return the unit of a column by its name or the row of units, plain and as it is written."""
    in_name = unit_in(sheet.names[k], quantity) if sheet.names else ""
    known = {unit_of(u): u for u in (sheet.units[k], in_name) if unit_of(u) in units_of(quantity)}
    written = " and ".join(filter(None, known.values())) or in_name or sheet.units[k]
    return unit_of(written), written


def column_at(sheet: Sheet, key: str, name: str) -> int:
    """Return the column of a name or, if there is no such name, of a position."""
    name = " ".join(str(name).split())
    if sheet.names.count(name) > 1:
        rule = f"is the name of {sheet.names.count(name)} columns"
        remedy = f"give each its own name, or give a position, as {sheet.names.index(name) + 1}"
        raise InputError(sheet.source, key, name, rule, remedy)
    with suppress(ValueError):
        return sheet.names.index(name)
    if name.isdecimal() and 0 < int(name) <= len(sheet.columns):
        return int(name) - 1
    without = f"{len(sheet.columns)} columns without names: give a position, as 1"
    remedy = f"it has {', '.join(sheet.names) or without}"
    raise InputError(sheet.source, key, name, "is not a column of the table", remedy)


def given_columns(sheet: Sheet, given: Mapping[str, str]) -> dict[int, Column]:
    """Return the columns that options name, by quantity and unit."""
    columns: dict[int, Column] = {}
    for key, name in given.items():
        where = f"columns.{key}"
        meaning, k = meaning_of(key), column_at(sheet, where, name)
        if meaning is None or meaning.rank:
            rule, remedy = "is not a known quantity", "give e.g. load_N, penetration_um, time_s"
            if key == "weight":
                rule, remedy = "is gone", "give the deviations instead, e.g. penetration_std_um"
            elif (quantity := key.removesuffix("_UNIT")) in QUANTITIES:
                rule, remedy = "needs its unit", f"write one of {spellings(quantity)}"
            raise InputError(sheet.source, where, name, rule, remedy)
        quantity = meaning.quantity
        in_table, written = _unit_in_table(sheet, k, quantity)
        unit = unit_of(meaning.unit) if meaning.unit else in_table
        unit = "" if quantity in LABELS else unit
        unit = "s" if quantity == "time" and not unit and seconds(sheet, k) else unit
        if unit not in units_of(quantity):
            remedy = f"name it by one of {spellings(quantity)}"
            raise InputError(sheet.source, where, name, "has no unit that is known", remedy)
        column = Column(sheet.name(k), quantity, unit)
        if k in columns:
            rule = f"is {columns[k].quantity} already"
            raise InputError(sheet.source, where, name, rule, "keep one of them")
        for other, before in columns.items():
            if before.quantity == quantity:
                raise _twice(sheet, column.name, before, other)
        if written and in_table != unit:
            note = f"column {column.name!r} is taken in {symbol(unit)}, not in {brief(written)}"
            sheet.notes.append(note)
        columns[k] = column
    return columns


def named_columns(
    sheet: Sheet, taken: Iterable[int], quantities: set[str]
) -> tuple[dict[int, Column], dict[str, InputError]]:
    """Return the columns whose names say what they are, of each quantity the most explicit.

    Beside them the errors for further columns, by quantity, without a unit that is known.
    """
    ranked: dict[str, list[tuple[int, int, Column]]] = {}
    unclear: dict[str, InputError] = {}
    for k, name in enumerate(sheet.names):
        meaning = None if k in taken else meaning_of(name)
        if meaning is None or meaning.quantity in quantities:
            continue
        quantity = meaning.quantity
        unit = _unit_of(sheet, k, meaning)
        if unit in units_of(quantity):
            ranked.setdefault(quantity, []).append((meaning.rank, k, Column(name, quantity, unit)))
        elif quantity != "time" and meaning.rank < LETTER:
            error = _unclear(sheet, k, quantity, meaning.unit or sheet.units[k])
            unclear.setdefault(quantity, error)
    unclear = {quantity: error for quantity, error in unclear.items() if quantity not in ranked}
    for quantity in MEASURED:
        if quantity in unclear:
            raise unclear[quantity]
    for quantity in unclear:
        sheet.left_out.append(f"{unclear[quantity].value!r}, whose unit is not known")
    columns: dict[int, Column] = {}
    for candidates in ranked.values():
        columns |= _most_explicit(sheet, candidates)
    return dict(sorted(columns.items())), unclear


def _unit_of(sheet: Sheet, k: int, meaning: Meaning) -> str:
    """Return the unit of a column by its name or the row of units, which must agree."""
    quantity, below = meaning.quantity, sheet.units[k]
    if quantity in LABELS:
        return ""
    if quantity == "time" and seconds(sheet, k):
        return "s"
    unit = unit_of(meaning.unit or below)
    if meaning.unit and unit_of(below) not in ("", unit) and quantity != "time":
        rule, remedy = f"has {below!r} below its name", "correct one of the two units"
        raise InputError(sheet.source, "columns", sheet.names[k], rule, remedy)
    return unit


def _most_explicit(sheet: Sheet, ranked: list[tuple[int, int, Column]]) -> dict[int, Column]:
    """Return the one column of the best rank; of times, which a fit can lack, none if several."""
    best = min(rank for rank, *_ in ranked)
    (k, first), *others = [(k, column) for rank, k, column in ranked if rank == best]
    if others and first.quantity != "time":
        raise _twice(sheet, others[0][1].name, first, k)
    if others:
        sheet.left_out.append(f"times, which {len(others) + 1} columns have")
    return {} if others else {k: first}


def _unclear(sheet: Sheet, k: int, quantity: str, unit: str) -> InputError:
    """Return the error for a column without a unit, or with one that is not known."""
    name, known = sheet.names[k], [*QUANTITIES[quantity]][:_UNITS_LISTED]
    units = ", ".join(map(symbol, known))
    if not unit:
        rule = "has no unit"
        remedy = f"say what it is with {option_for(sheet, quantity, k)}, UNIT being one of {units}"
    else:
        rule = f"has a unit that is not known, {unit!r}"
        remedy = f"convert its numbers to one of {units}, and name that"
    if quantity == "load" and (force := _WEIGHTS.get(unit)):
        option = shlex.quote(f"load_{force}={name}")
        remedy = f"if it is the force in {force}, add --columns {option}"
    remedy += f", or leave it out with --ignore {shlex.quote(name)}"
    return InputError(sheet.source, "columns", name, rule, remedy)


def _twice(sheet: Sheet, name: str, first: Column, k: int) -> InputError:
    """Return the error for a second column of a quantity."""
    remedy = f"keep one of them: leave the other out with --ignore {shlex.quote(name)}"
    if first.name == name:
        option = f"--columns {first.quantity}={k + 1}"
        remedy = f"give each column a name of its own, or take the first with {option}"
    rule = f"gives the same quantity as {first.name}"
    return InputError(sheet.source, "columns", name, rule, remedy)
