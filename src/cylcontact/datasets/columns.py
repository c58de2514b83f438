"""Which columns of a table are of which quantity and unit: by their names, or as options say."""

from __future__ import annotations

import math
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
    Unit,
    meaning_of,
    read_unit,
    spellings,
    symbol,
    unit_in,
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
    unit = _unit_in_sheet(sheet, k, quantity)
    is_known = unit.name in QUANTITIES[quantity] and unit.is_clear
    return _option(quantity if is_known else f"{quantity}_UNIT", sheet, k)


def _option(key: str, sheet: Sheet, k: int) -> str:
    name = sheet.names[k] if sheet.names else str(k + 1)
    if sheet.names.count(name) > 1:
        name = str(k + 1)
    return f"--columns {shlex.quote(f'{key}={name}')}"


def _unit_in_sheet(sheet: Sheet, k: int, quantity: str) -> Unit:
    """Return the unit of a column by its name or the row of units."""
    in_name = unit_in(sheet.names[k], quantity) if sheet.names else Unit()
    both = [read_unit(sheet.units[k]), in_name]
    known = [unit for unit in both if unit.text and unit.name in units_of(quantity)]
    if len(known) == 2:
        text = " and ".join(dict.fromkeys(unit.text for unit in known))
        agree = known[0].name == known[1].name
        return _merged(*known)._replace(text=text) if agree else Unit(text, text)
    if known:
        # A factor in the name counts for the unit below it.
        return known[0] if known[0] is in_name else _merged(known[0], in_name)
    return in_name if in_name.text else both[0]


def _merged(below: Unit, in_name: Unit) -> Unit:
    """Return the unit below a name with the factors of both, which are one if they are equal."""
    if in_name.factors in ((1.0,), below.factors):
        return below
    if below.factors == (1.0,):
        return below._replace(factors=in_name.factors, text=f"{in_name.text} {below.text}".strip())
    text = f"{in_name.text} and {below.text}"
    return below._replace(factors=(*below.factors, *in_name.factors), text=text)


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


def has_column(sheet: Sheet, name: str) -> bool:
    """Return whether a table has a column of a name, or at a position."""
    name = " ".join(str(name).split())
    return name in sheet.names or (name.isdecimal() and 0 < int(name) <= len(sheet.columns))


def given_columns(sheet: Sheet, given: Mapping[str, str]) -> dict[int, Column]:
    """Return the columns that options name, by quantity and unit."""
    columns: dict[int, Column] = {}
    for key, name in given.items():
        where = f"columns.{key}"
        meaning, k = meaning_of(key), column_at(sheet, where, name)
        if meaning is None or meaning.rank:
            rule, remedy = "is not a known quantity", "give e.g. load_N, penetration_um, time_s"
            if (quantity := key.removesuffix("_UNIT")) in QUANTITIES:
                rule, remedy = "needs its unit", f"write one of {spellings(quantity)}"
            raise InputError(sheet.source, where, name, rule, remedy)
        quantity = meaning.quantity
        column = _given_column(sheet, k, where, meaning)
        if k in columns:
            rule = f"is {columns[k].quantity} already"
            raise InputError(sheet.source, where, name, rule, "keep one of them")
        for other, before in columns.items():
            if before.quantity == quantity:
                raise _twice(sheet, column.name, before, other)
        columns[k] = column
    return columns


def _given_column(sheet: Sheet, k: int, where: str, meaning: Meaning) -> Column:
    """Return the column that an option names, in its unit or else in that of the table."""
    quantity, in_sheet = meaning.quantity, _unit_in_sheet(sheet, k, meaning.quantity)
    unit = _unit_of_key(meaning.unit) if meaning.unit.text else in_sheet
    if quantity in LABELS:
        return Column(sheet.name(k), quantity)
    if quantity == "time" and not unit.text and seconds(sheet, k):
        unit = Unit("s", "s")
    if unit.name not in units_of(quantity):
        remedy = f"name it by one of {spellings(quantity)}"
        name = sheet.name(k)
        raise InputError(sheet.source, where, name, "has no unit that is known", remedy)
    if not unit.is_clear:
        raise _ambiguous(sheet, k, quantity, unit)
    column = Column(sheet.name(k), quantity, unit.name, unit.factors[0])
    if in_sheet.text and in_sheet[1:] != unit[1:]:
        written = brief(in_sheet.text)
        sheet.notes.append(f"column {column.name!r} is taken in {column.symbol}, not in {written}")
    return column


def _unit_of_key(unit: Unit) -> Unit:
    """Return the unit in an option, where a number before it is a multiple of it: load [10 N]."""
    return unit._replace(factors=unit.factors[:1]) if 1.0 in unit.factors else unit


def named_columns(
    sheet: Sheet, taken: Iterable[int], quantities: set[str]
) -> tuple[dict[int, Column], dict[str, InputError]]:
    """Return the columns whose names say what they are, of each quantity the most explicit.

    Beside them the errors for further columns, by quantity, without a unit that is known.
    """
    ranked: dict[str, list[tuple[float, int, Column]]] = {}
    unclear: dict[str, InputError] = {}
    for k, name in enumerate(sheet.names):
        meaning = None if k in taken else meaning_of(name)
        if meaning is None or meaning.quantity in quantities:
            continue
        quantity = meaning.quantity
        unit = _unit_of(sheet, k, meaning)
        is_known = unit.name in units_of(quantity)
        if is_known and unit.is_clear:
            column = Column(name, quantity, unit.name, unit.factors[0])
            ranked.setdefault(quantity, []).append((meaning.rank, k, column))
        elif quantity != "time" and meaning.rank < LETTER:
            error = _ambiguous if is_known else _unclear
            unclear.setdefault(quantity, error(sheet, k, quantity, unit))
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


def _unit_of(sheet: Sheet, k: int, meaning: Meaning) -> Unit:
    """Return the unit of a column by its name or the row of units, which must agree."""
    quantity, in_name, below = meaning.quantity, meaning.unit, read_unit(sheet.units[k])
    if quantity in LABELS:
        return Unit()
    if quantity == "time" and seconds(sheet, k):
        return Unit("s", "s")
    if not below.name:
        return in_name if in_name.text else below
    # A bracket without a unit is a part of the name.
    if in_name.name not in ("", below.name) and quantity != "time":
        rule, remedy = f"has {sheet.units[k]!r} below its name", "correct one of the two units"
        raise InputError(sheet.source, "columns", sheet.names[k], rule, remedy)
    return in_name if in_name.name not in ("", below.name) else _merged(below, in_name)


def _most_explicit(sheet: Sheet, ranked: list[tuple[float, int, Column]]) -> dict[int, Column]:
    """Return the one column of the best rank; of times, which a fit can lack, none if several."""
    best = min(rank for rank, *_ in ranked)
    (k, first), *others = [(k, column) for rank, k, column in ranked if rank == best]
    if others and first.quantity != "time":
        raise _twice(sheet, others[0][1].name, first, k)
    if others:
        sheet.left_out.append(f"times, which {len(others) + 1} columns have")
    further = [k for rank, k, _ in ranked if best < rank < LETTER]
    if further and first.quantity in MEASURED:
        options = ", ".join(option_for(sheet, first.quantity, k) for k in further)
        sheet.notes.append(f"to take another column for the {first.quantity}: {options}")
    return {} if others else {k: first}


def _unclear(sheet: Sheet, k: int, quantity: str, unit: Unit) -> InputError:
    """Return the error for a column without a unit, or with one that is not known."""
    name, known = sheet.names[k], [*QUANTITIES[quantity]][:_UNITS_LISTED]
    units = ", ".join(map(symbol, known))
    option = _option(f"{quantity}_UNIT", sheet, k)
    if not unit.text:
        rule, remedy = "has no unit", f"say what it is with {option}, UNIT being one of {units}"
    else:
        rule = f"has a unit that is not known, {unit.text!r}"
        remedy = f"convert its numbers to one of {units}, and name that"
        if not unit.name:
            remedy += f"; if {unit.text!r} is a part of its name, say its unit with {option}"
    if quantity == "load" and (force := _WEIGHTS.get(unit.name)):
        remedy = f"if it is the force in {force}, add {_option(f'load_{force}', sheet, k)}"
    remedy += f", or leave it out with --ignore {shlex.quote(name)}"
    return InputError(sheet.source, "columns", name, rule, remedy)


def _ambiguous(sheet: Sheet, k: int, quantity: str, unit: Unit) -> InputError:
    """Return the error for a column whose name has a factor that may mean several things."""
    choices = [
        f"{_option(_key(quantity, unit.name, times), sheet, k)} if it is "
        f"{Column('', quantity, unit.name, times).symbol}"
        for times in unit.factors
        if math.isfinite(times)
    ]
    rule = "does not say clearly what a cell of 1 is"
    remedy = f"add {', or '.join(choices)}"
    return InputError(sheet.source, "columns", sheet.name(k), rule, remedy)


def _key(quantity: str, unit: str, times: float) -> str:
    """Return the key of an option: load_N, load [10 N]."""
    return f"{quantity}_{unit}" if times == 1 else f"{quantity} [{times:.12g} {symbol(unit)}]"


def _twice(sheet: Sheet, name: str, first: Column, k: int) -> InputError:
    """Return the error for a second column of a quantity."""
    remedy = f"keep one of them: leave the other out with --ignore {shlex.quote(name)}"
    if first.name == name:
        option = f"--columns {first.quantity}={k + 1}"
        remedy = f"give each column another name, or take the first with {option}"
    rule = f"gives the same quantity as {first.name}"
    return InputError(sheet.source, "columns", name, rule, remedy)
