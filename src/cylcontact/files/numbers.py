"""Columns of a table as words, numbers and times: marks of decimals and of thousands."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from cylcontact.files.cells import SCIENTIFIC, THOUSANDS
from cylcontact.files.reading import plain_number
from cylcontact.files.sheet import Sheet
from cylcontact.files.units import LETTER, SUPERSCRIPTS, Unit, meaning_of, read_unit, unit_after
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError

_GROUPED = re.compile(r"[+\-−]?[1-9]\d{0,2}[.,]\d{3}")
_GROUPS = re.compile(r"([+\-−]?[1-9]\d{0,2})(?:([\u00a0\u202f '’.,])\d{3}(?:\2\d{3})*)?")
_NOT_MARKS = str.maketrans("", "", "0123456789+-−eE")
_USUAL = set("0123456789.,+-eE")
_CLOCK = r"\d+:\d\d:\d\d(\.\d+)?"


def words(sheet: Sheet, k: int) -> list[str]:
    """Return a column as words: a number without a fraction as an integer, a day without a time."""
    if None in sheet.columns[k]:
        raise _wrong(sheet, k, sheet.columns[k].index(None), None)
    cells = [int(c) if isinstance(c, float) and c.is_integer() else c for c in sheet.columns[k]]
    return [str(cell).removesuffix(" 00:00:00") for cell in cells]


def numbers(sheet: Sheet, k: int, decimal: str | None = None) -> list[float]:
    """Return a column as finite numbers, whose decimals are marked as the column itself shows.

    If `decimal` gives their mark, other marks between groups of three digits are of thousands.
    """
    values, wrong = _read(sheet, k, decimal)
    if wrong:
        raise wrong[min(wrong)]
    return values


def quantity(
    sheet: Sheet,
    name: str,
    units: Mapping[str, float],
    decimal: str | None = None,
    wrong: dict[int, InputError] | None = None,
) -> FloatArray | None:
    """Return the numbers of a column that is named by its words and its unit.

    Parameters
    ----------
    sheet : Sheet
        The table.
    name : str
        The words, as pin_diameter. The table may write Pin diameter [mm], or have the unit below.
    units : mapping
        Units with the factor of each, as `LENGTHS`; {"": 1.0} for a number without a unit.
    decimal : str, optional
        The mark of decimals; by default as the column itself shows.
    wrong : dict, optional
        Is given the error of each row whose cell is no number. By default the first is raised.

    Returns
    -------
    N numbers times their factor, NaN where a cell is empty or wrong; None without such a column.

    Raises
    ------
    InputError
        If two columns have the name, or a unit is missing, unknown or not clear.

    Examples
    --------
    >>> import pandas as pd
    >>> from cylcontact.files.sheet import read_sheet
    >>> from cylcontact.files.units import FORCES, LENGTHS
    >>> sheet = read_sheet(pd.DataFrame({"Pin diameter [cm]": [2.0, None], "load_kN": [4.5, 6.0]}))
    >>> quantity(sheet, "pin_diameter", LENGTHS), quantity(sheet, "load", FORCES)
    (array([20., nan]), array([4500., 6000.]))
    >>> quantity(sheet, "length", LENGTHS) is None
    True
    """
    found = {k: unit_after(each, name, units) for k, each in enumerate(sheet.names)}
    at = [k for k, unit in found.items() if unit is not None]
    if not at:
        return None
    if len(at) > 1:
        rule = f"gives the same quantity as {sheet.names[at[0]]}"
        raise InputError(sheet.source, "columns", sheet.names[at[1]], rule, "keep one of them")
    (k,) = at
    factor = _factor(sheet, k, found[k] or Unit(), name, units)
    values, errors = _read(sheet, k, decimal, may_lack=True)
    if wrong is not None:
        wrong.update({row: error for row, error in errors.items() if row not in wrong})
    elif errors:
        raise errors[min(errors)]
    return factor * np.array(values)


def _factor(sheet: Sheet, k: int, unit: Unit, name: str, units: Mapping[str, float]) -> float:
    """Return the factor of a column's unit, by its name or the row of units."""
    below = read_unit(sheet.units[k])
    written = [each for each in (unit, below) if each.text]
    taken = written[0] if written else Unit()
    usual = next(iter(units))
    remedy = f"name it e.g. {name}_{usual}" if usual else f"name it {name}"
    if len(written) == 2 and unit[1:] != below[1:]:
        rule, remedy = f"has {below.text!r} below its name", "correct one of the two units"
    elif taken.name not in units:
        rule = f"has a unit that is not known, {taken.text!r}" if taken.text else "has no unit"
    elif not taken.is_clear:
        rule = "does not say clearly what a cell of 1 is"
    else:
        return taken.factors[0] * units[taken.name]
    raise InputError(sheet.source, "columns", sheet.names[k], rule, remedy)


def _read(
    sheet: Sheet, k: int, decimal: str | None, *, may_lack: bool = False
) -> tuple[list[float], dict[int, InputError]]:
    """Return a column as numbers, NaN for what is none, and the errors of such rows."""
    if (plain := _plain_column(sheet, k, decimal)) is not None:
        return plain, {}
    cells = [_scientific(cell) if isinstance(cell, str) else cell for cell in sheet.columns[k]]
    mark = decimal or _decimal_mark(sheet, k, cells)
    if decimal:
        cells = [_ungrouped(cell, decimal) if isinstance(cell, str) else cell for cell in cells]
    values = [_number(cell, mark) for cell in cells]
    _note_mark(sheet, mark)
    rows = (row for row, value in enumerate(values) if not math.isfinite(value))
    wrong = {}
    for row in rows:
        values[row] = math.nan
        if not (may_lack and cells[row] is None):
            wrong[row] = _wrong(sheet, k, row, decimal)
    return values, wrong


def _plain_column(sheet: Sheet, k: int, decimal: str | None) -> list[float] | None:
    """Return a column of numbers in the usual notation, all at once; None for any other.

    Tables may have a million rows, for which each step of `_read` takes seconds.
    """
    cells = sheet.columns[k]
    try:
        letters = set("".join(cells))
    except TypeError:  # numbers of a workbook, or an empty cell
        return None
    marks = letters & {".", ","}
    if not letters <= _USUAL or len(marks) > 1 or (decimal and marks - {decimal}):
        return None
    mark = next(iter(marks), ".")
    is_given = decimal is not None or (mark, sheet.separator) == (".", ",")
    if marks and not is_given and all(_GROUPED.fullmatch(c) for c in cells if mark in c):
        return None
    try:
        texts = "\n".join(cells).replace(",", ".").split("\n")
        values: FloatArray = np.array(texts, dtype=np.float64)
    except ValueError:
        return None
    if not np.isfinite(values).all():
        return None
    _note_mark(sheet, mark)
    numbers: list[float] = values.tolist()
    return numbers


def _note_mark(sheet: Sheet, mark: str) -> None:
    note = "decimals marked by commas"
    sheet.notes += [note] if mark == "," and note not in sheet.notes else []


def _wrong(sheet: Sheet, k: int, row: int, decimal: str | None) -> InputError:
    """Return the error for a cell that is no number."""
    cell = sheet.columns[k][row]
    if cell is None:
        rule, remedy = "is empty", "fill it in, or remove the row"
        if sheet.separator == "":
            rule = "is empty, or a formula without a stored value"
            remedy += ", or save the workbook in a spreadsheet program"
        return sheet.error(rule, remedy, row, k)
    rule, remedy = "must be a finite number", "write it with a decimal point, without its unit"
    meaning = meaning_of(str(cell))
    if meaning is not None and meaning.rank < LETTER:
        remedy = f"remove it, or read only what is below with --header {sheet.lines[row]}"
    if decimal and re.search(r"\d[.,]\d", str(cell)):
        rule = f"does not have its decimals marked by {decimal!r}"
        remedy = "correct it, or give the other mark with --decimal"
    return sheet.error(rule, remedy, row, k)


def _scientific(cell: str) -> str:
    """Return a number with a power of ten as 1.5e-6, and any other cell unchanged.

    >>> _scientific("1.5×10-6"), _scientific("1,5·10⁻⁶"), _scientific("0.207 E-03")
    ('1.5e-6', '1,5e-6', '0.207e-03')
    """
    if not (found := SCIENTIFIC.fullmatch(cell)):
        return cell
    exponent = (found["power"] or found["raised"] or found["exponent"]).translate(SUPERSCRIPTS)
    return f"{found['number']}e{exponent}"


def _number(cell: Any, mark: str) -> float:
    """Return a cell as a number; NaN if it is none."""
    try:
        if isinstance(cell, str):
            plain = cell if mark == "." else cell.replace(".", "?").replace(mark, ".")
            return plain_number(plain.replace("−", "-"))
        return math.nan if isinstance(cell, bool) else float(cell)
    except (TypeError, ValueError):
        return math.nan


def _ungrouped(cell: str, decimal: str) -> str:
    """Return a number without the marks of its thousands, none of which may be that of decimals."""
    whole, point, rest = cell.partition(decimal)
    groups = _GROUPS.fullmatch(whole)
    return whole.replace(groups[2], "") + point + rest if groups and groups[2] else cell


def _decimal_mark(sheet: Sheet, k: int, cells: list[Any]) -> str:
    """Return what marks the decimals of a column; refuse marks that may be of thousands.

    "1,234" alone may be a thousand; with "0,206" or "1,5" in the same column it is not.
    """
    texts = [(row, cell) for row, cell in enumerate(cells) if isinstance(cell, str)]
    for row, cell in texts:
        if cell.translate(_NOT_MARKS) not in ("", ".", ",") and THOUSANDS.fullmatch(cell):
            last = (re.findall(r"[.,]", cell) or ["."])[-1]
            decimal = last if cell.count(last) < 2 else {",": ".", ".": ","}[last]
            remedy = f"write it without them, or add --decimal '{decimal}'"
            raise sheet.error("has separators of thousands", remedy, row, k)
    by_mark = {mark: [(row, cell) for row, cell in texts if mark in cell] for mark in ",."}
    marked = {mark: cells for mark, cells in by_mark.items() if cells}
    if not marked:
        return "."
    grouped = {m: all(_GROUPED.fullmatch(cell) for _, cell in cells) for m, cells in marked.items()}
    # Of two marks the wrong one may be of thousands, or else has fewer cells.
    mark = min(marked, key=lambda m: (not grouped[m], len(marked[m])))
    row, cell = marked[mark][0]
    if len(marked) == 2:
        this, other = ("a comma", "a point") if mark == "," else ("a point", "a comma")
        remedy = f"write it as the others{', without thousands' if grouped[mark] else ''}"
        raise sheet.error(f"has {this}, and other numbers of the column {other}", remedy, row, k)
    # Between commas a point marks decimals.
    if grouped[mark] and (mark, sheet.separator) != (".", ","):
        rule = "has a mark that may be of thousands or of decimals, as in the whole column"
        other = "." if mark == "," else ","
        whole, value = cell.replace(mark, ""), float(cell.replace(mark, ".").replace("−", "-"))
        remedy = f"add --decimal '{other}' if it is {whole}, --decimal '{mark}' if it is {value:g}"
        raise sheet.error(rule, remedy, row, k)
    return mark


def seconds(sheet: Sheet, k: int) -> list[float] | None:
    """Return a column of clock times, or of dates from the first one, in seconds; else None."""
    if ":" not in str(sheet.columns[k][0]):
        return None
    import pandas as pd

    texts = pd.Series([str(cell).replace(",", ".") for cell in sheet.columns[k]])
    if texts.str.fullmatch(_CLOCK).all():
        return pd.to_timedelta(texts).dt.total_seconds().tolist()
    if texts.str.fullmatch(r"\d{4}-\d\d-\d\d[ T]\d.*").all():
        times = pd.to_datetime(texts, format="ISO8601", errors="coerce")
        return None if times.isna().any() else (times - times[0]).dt.total_seconds().tolist()
    return None
