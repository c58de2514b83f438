"""Columns of a table as words, numbers and times: marks of decimals and of thousands."""

from __future__ import annotations

import math
import re
from typing import Any

from cylcontact.files.cells import THOUSANDS
from cylcontact.files.reading import plain_number
from cylcontact.files.sheet import Sheet
from cylcontact.files.units import LETTER, meaning_of

_GROUPED = re.compile(r"[+\-−]?[1-9]\d{0,2}[.,]\d{3}")
_GROUPS = re.compile(r"([+\-−]?[1-9]\d{0,2})(?:([\u00a0\u202f '’.,])\d{3}(?:\2\d{3})*)?")
_NOT_MARKS = str.maketrans("", "", "0123456789+-−eE")
_CLOCK = r"\d+:\d\d:\d\d(\.\d+)?"


def words(sheet: Sheet, k: int) -> list[str]:
    """Return a column as words: a number without a fraction as an integer, a day without a time."""
    _require_filled(sheet, k)
    cells = [int(c) if isinstance(c, float) and c.is_integer() else c for c in sheet.columns[k]]
    return [str(cell).removesuffix(" 00:00:00") for cell in cells]


def numbers(sheet: Sheet, k: int, decimal: str | None = None) -> list[float]:
    """Return a column as finite numbers, whose decimals are marked as the column itself shows.

    If `decimal` gives their mark, other marks between groups of three digits are of thousands.
    """
    cells, mark = sheet.columns[k], decimal or _decimal_mark(sheet, k)
    if decimal:
        cells = [_ungrouped(cell, decimal) if isinstance(cell, str) else cell for cell in cells]
    values = [_number(cell, mark) for cell in cells]
    wrong = next((row for row, value in enumerate(values) if not math.isfinite(value)), None)
    if wrong is not None:
        _require_filled(sheet, k)
        rule, remedy = "must be a finite number", "write it with a decimal point, without its unit"
        meaning = meaning_of(str(cells[wrong]))
        if meaning is not None and meaning.rank < LETTER:
            remedy = f"remove it, or read only what is below with --header {sheet.lines[wrong]}"
        if decimal and re.search(r"\d[.,]\d", str(cells[wrong])):
            rule = f"does not have its decimals marked by {decimal!r}"
            remedy = "correct it, or give the other mark with --decimal"
        raise sheet.error(rule, remedy, wrong, k)
    note = "decimals marked by commas"
    sheet.notes += [note] if mark == "," and note not in sheet.notes else []
    return values


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


def _decimal_mark(sheet: Sheet, k: int) -> str:
    """Return what marks the decimals of a column; refuse marks that may be of thousands.

    "1,234" alone may be a thousand; with "0,206" or "1,5" in the same column it is not.
    """
    texts = [(row, cell) for row, cell in enumerate(sheet.columns[k]) if isinstance(cell, str)]
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


def _require_filled(sheet: Sheet, k: int) -> None:
    """Raise `InputError` for the first empty cell of a column."""
    if None in sheet.columns[k]:
        rule, remedy = "is empty", "fill it in, or remove the row"
        if sheet.separator == "":
            rule = "is empty, or a formula without a stored value"
            remedy += ", or save the workbook in a spreadsheet program"
        raise sheet.error(rule, remedy, sheet.columns[k].index(None), k)
