"""Readings of a table: columns as numbers, signs that are turned, rows that are left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from cylcontact.datasets.columns import (
    MEASURED,
    column_at,
    given_columns,
    has_column,
    named_columns,
)
from cylcontact.files.cells import is_number
from cylcontact.files.numbers import numbers, seconds, words
from cylcontact.files.reading import plain_number
from cylcontact.files.sheet import Sheet, counted, read_sheet
from cylcontact.files.spec import Spec
from cylcontact.files.units import LABELS, Column
from cylcontact.support.arrays import FloatArray
from cylcontact.support.choices import Branch, first_of
from cylcontact.support.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

_LISTED = 8  # names of columns in a line
# What each choice of a sign turns.
_TURNED = {"load": MEASURED[:1], "penetration": MEASURED[1:], "both": MEASURED, "neither": ()}
# Spearman's correlation of load and travel where travel certainly falls, or probably.
_FALLS, _MAY_FALL = -0.9, -0.5
# The largest share of travel in the other direction where its sign is certain.
_OTHER_WAY = 0.01
# A load below zero shows the noise around it; loads of so many times that are measured.
_OVER_NOISE = 3.0


class TableSpec(Spec):
    """How a table is read."""

    columns: dict[str, str] | None = Field(
        None, description='a table [columns] of what columns are, e.g. load_N = "Kraft"'
    )
    group: str | None = Field(
        None, description="the column that names the series, which have their own errors"
    )
    ignore: tuple[str, ...] = Field((), strict=False, description="a list of columns to leave out")
    sheet: str | None = Field(None, description="the name of a sheet of a workbook")
    header: int | None = Field(None, ge=0, description="the line of the names, 0 for none")
    separator: Literal["comma", "semicolon", "tab", "bar", "space"] | None = Field(
        None, description='"comma", "semicolon", "tab", "bar" or "space"'
    )
    encoding: str | None = Field(None, description='the encoding of a text, e.g. "cp1251"')
    decimal: Literal[".", ","] | None = Field(None, description='"." or ","')
    exclude: tuple[str, ...] | None = Field(
        None, strict=False, description='a list of rows to leave out, e.g. "38" or "b.csv:12"'
    )
    loads: str | None = Field(
        None, description='a range of loads in the unit of the table, e.g. "5:400" or "5:"'
    )
    sign: Literal["load", "penetration", "both", "neither"] | None = Field(
        None, description='what is counted negative: "load", "penetration", "both" or "neither"'
    )
    branch: Branch | None = Field(None, description='"loading" or "unloading"')


@dataclass
class Readings:
    """What is read of a table: numbers in mm, N or N/mm, MPa and s, and words.

    `unclear` has the errors for columns that are left out since their unit is not known.
    """

    sheet: Sheet
    columns: dict[int, Column]
    numbers: dict[str, FloatArray]
    labels: dict[str, list[str]]
    unclear: dict[str, InputError]
    warnings: list[str] = field(default_factory=list)
    turned: set[str] = field(default_factory=set)  # quantities whose sign was turned
    absent: set[str] = field(default_factory=set)  # columns that options name in other tables
    ignored: set[int] = field(default_factory=set)

    @property
    def unread(self) -> list[int]:
        """The columns that are not read."""
        others = ((k, x) for k, x in enumerate(self.sheet.columns) if k not in self.columns)
        return [k for k, x in others if self.sheet.name(k) or any(c is not None for c in x)]

    def unused(self, rows: Sequence[int]) -> list[str]:
        """Return the columns of words that would divide some rows into series."""
        names = []
        for k in self.unread:
            cells = [self.sheet.columns[k][row] for row in rows]
            words = k not in self.ignored and all(isinstance(x, str) for x in cells)
            if words and not any(map(is_number, cells)) and 1 < len({*cells}) <= len(cells) / 2:
                names.append(self.sheet.name(k))
        return names

    def block(self, rows: Sequence[int]) -> list[str]:
        """Return the lines that say what was read, left out and decided; `rows` are the kept."""
        sheet, lines = self.sheet, [self.sheet.lines[row] for row in rows]
        read = []
        for column in sorted(self.columns.values(), key=lambda c: _rank(c.quantity)):
            unit = f" in {column.symbol}" if column.unit else ""
            by = ", divided by the length" if column.is_total else ""
            read.append(f"{column.quantity} from {column.name!r}{unit}{by}")
        left, unread = list(sheet.left_out), [repr(sheet.name(k)) for k in self.unread]
        if unread:
            left.append(f"{counted(unread, 'column')}: {first_of(unread, _LISTED)}")
        where = f"{Path(sheet.source).name!r}, {sheet.numbered(lines)}"
        return [
            f"read {counted(lines, 'row')} of {where}: {'; '.join(read)}",
            *([f"left out: {'; '.join(left)}"] if left else []),
            *(["; ".join(sheet.notes)] if sheet.notes else []),
            *(f"! {warning}" for warning in self.warnings),
        ]


def read_readings(
    data: Path | str | pd.DataFrame, spec: TableSpec, may_lack: bool = False
) -> Readings:
    """Read the measurements of a table, of all loads; `keep_loads` takes those of a range.

    With `may_lack`, the table may be without columns that options name, as one of several is.
    """
    given = spec.columns or {}
    wanted = {*given.values()} | ({spec.group} if spec.group is not None else set())
    sheet = read_sheet(data, wanted, spec.sheet, spec.header, spec.separator, spec.encoding)
    _exclude(sheet, spec.exclude or ())
    absent = set()
    if may_lack:
        named = {*given.values(), *spec.ignore}
        absent = {name for name in named if not has_column(sheet, name)}
    skipped = {column_at(sheet, "ignore", name) for name in spec.ignore if name not in absent}
    present = {key: name for key, name in given.items() if name not in absent}
    columns = given_columns(sheet, present)
    explicit = {column.quantity for column in columns.values()}
    group = None if spec.group is None else column_at(sheet, "group", spec.group)
    if group is not None:
        explicit.add("group")
    others, unclear = named_columns(sheet, skipped | {*columns}, explicit)
    columns |= others
    _drop_empty(sheet, {*columns} | ({group} if group is not None else set()))
    optional = {k for k, c in others.items() if c.quantity in ("time", "group")}
    readings = Readings(sheet, columns, {}, {}, unclear, absent=absent, ignored=skipped)
    for k, column in list(columns.items()):
        try:
            if column.quantity in LABELS:
                readings.labels[column.quantity] = words(sheet, k)
            else:
                values = _values(sheet, k, column, spec.decimal)
                readings.numbers[column.quantity] = values
        except InputError as error:
            if k not in optional:
                raise
            where = error.source.removeprefix(f"{sheet.source}, ")
            sheet.left_out.append(f"the {column.quantity} ({where} {error.rule})")
            del columns[k]
    if group is not None:
        readings.labels["group"] = words(sheet, group)
        columns.setdefault(group, Column(sheet.name(group), "group"))
    if {*MEASURED} <= {*readings.numbers}:
        _turn(readings, spec.sign)
    return readings


def _rank(quantity: str) -> int:
    return [*MEASURED, quantity].index(quantity)


def _values(sheet: Sheet, k: int, column: Column, decimal: str | None) -> FloatArray:
    clock = seconds(sheet, k) if column.quantity == "time" else None
    if clock is not None:
        return np.array(clock)
    return column.factor * np.array(numbers(sheet, k, decimal))


# --- rows ---------------------------------------------------------------------------------------


def _exclude(sheet: Sheet, texts: Sequence[str]) -> None:
    """Leave out the rows that the user names by their lines, or by file and line."""
    out = set()
    for text in texts:
        file, _, line = text.rpartition(":")
        if not line.isdecimal() or int(line) not in sheet.lines:
            rule = f"is no {sheet.row_word} of the rows"
            remedy = f"they are {sheet.numbered(sheet.lines)}"
            raise InputError(sheet.source, "exclude", text, rule, remedy)
        if file not in ("", Path(sheet.source).name):
            rule, remedy = "is of another file", f"give {line}"
            raise InputError(sheet.source, "exclude", text, rule, remedy)
        out.add(int(line))
    if not out:
        return
    keeps = [line not in out for line in sheet.lines]
    if not any(keeps):
        raise InputError(sheet.source, "exclude", None, "leaves no row", "exclude fewer")
    sheet.left_out.append(f"{counted([*out], 'row')} excluded ({sheet.numbered(sorted(out))})")
    sheet.lines = [*compress(sheet.lines, keeps)]
    sheet.columns = [[*compress(column, keeps)] for column in sheet.columns]


def _drop_empty(sheet: Sheet, columns: set[int]) -> None:
    """Leave out rows without a cell in what is read, as where a longer series is beside it."""
    if not all(None in sheet.columns[k] for k in columns):
        return
    cells = zip(*(sheet.columns[k] for k in columns), strict=True)
    keeps = [any(cell is not None for cell in row) for row in cells]
    if all(keeps) or not any(keeps):
        return
    out = [line for line, keep in zip(sheet.lines, keeps, strict=True) if not keep]
    rows = f"{counted(out, 'row')} empty in these columns"
    sheet.left_out.append(f"{rows} ({sheet.numbered(out)})")
    sheet.lines = [*compress(sheet.lines, keeps)]
    sheet.columns = [[*compress(column, keeps)] for column in sheet.columns]


def _turn(readings: Readings, sign: str | None) -> None:
    """Turn the sign of what is counted the other way: compression and approach are positive."""
    values, notes = readings.numbers, readings.sheet.notes
    if sign is not None:
        turned = dict.fromkeys(_TURNED[sign], "")
    else:
        load, depth = values["load"], values["penetration"]
        turned = {"load": ", as most is below zero"} if -load.min() > load.max() else {}
        slope = _correlation_up_to_peak(np.abs(load), depth)
        if slope < _FALLS and depth.max() <= _OTHER_WAY * -depth.min():
            turned["penetration"] = ", as it falls while the load rises"
        elif slope < _MAY_FALL:
            readings.warnings.append(
                "the penetration falls as the load rises: if travel is counted the other way, "
                "add --sign penetration"
            )
    for name, why in turned.items():
        values[name] = -values[name]
        readings.turned.add(name)
        notes.append(f"sign of the {name} turned{why}{' (else --sign neither)' if why else ''}")


def _correlation_up_to_peak(load: FloatArray, depth: FloatArray) -> float:
    """Return Spearman's correlation up to the largest load; 0 for a constant column.

    Behind it a specimen may be broken. Where the table has less than three rows up to there, all
    its rows count.
    """
    rows = int(np.argmax(load)) + 1
    rows = rows if rows >= 3 else load.size
    first, second = (np.argsort(np.argsort(values[:rows])) for values in (load, depth))
    if rows < 3 or not (np.ptp(load[:rows]) and np.ptp(depth[:rows])):
        return 0.0
    return float(np.corrcoef(first, second)[0, 1])


def load_column(readings: Readings) -> tuple[int, Column] | None:
    """Return the column of the loads and where it is, if both measured quantities are there."""
    if not {*MEASURED} <= {*readings.numbers}:
        return None
    return next((k, column) for k, column in readings.columns.items() if column.quantity == "load")


def keep_loads(readings: Readings, text: str | None) -> None:
    """Leave out the rows with loads outside a range LOW:HIGH in the unit of the table.

    Raises
    ------
    InputError
        If a load that is kept is below zero, or none is.
    """
    sheet, found = readings.sheet, load_column(readings)
    if found is None:
        return
    k, column = found
    values, unit = readings.numbers["load"] / column.factor, column.symbol
    low, high = _ends(sheet, text or ":")
    keeps = (values >= low) & (values <= high)
    below = np.flatnonzero(keeps & (values < 0))
    if below.size:
        rule = "must be positive"
        if "load" in readings.turned:
            rule = "has the other sign than the loads, whose sign was turned"
        remedy = _above_noise(values[keeps], unit)
        more = f" ({below.size - 1} more like it)" if below.size > 1 else ""
        raise sheet.error(rule + more, remedy, int(below[0]), k)
    if not keeps.any():
        remedy = f"give a range in {unit}: its loads are {values.min():.6g} to {values.max():.6g}"
        raise InputError(sheet.source, "loads", text, "leaves no row", remedy)
    out = [*compress(sheet.lines, ~keeps)]
    if out:
        ends = f"outside {low:g} to {high:g}"
        if not np.isfinite(high):
            ends = f"below {low:g}"
        elif not np.isfinite(low):
            ends = f"above {high:g}"
        rows = f"{counted(out, 'row')} with loads {ends} {unit}"
        sheet.left_out.append(f"{rows} ({sheet.numbered(out)})")
    sheet.lines = [*compress(sheet.lines, keeps)]
    readings.numbers = {name: cells[keeps] for name, cells in readings.numbers.items()}
    readings.labels = {name: [*compress(cells, keeps)] for name, cells in readings.labels.items()}


def _above_noise(loads: FloatArray, unit: str) -> str:
    """Return the remedy for loads below zero: a range above the noise around zero."""
    least = _OVER_NOISE * float(-loads.min())
    power = 10.0 ** np.floor(np.log10(least))
    low = float(next(step * power for step in (1, 2, 5, 10) if step * power >= 0.999 * least))
    if np.count_nonzero(loads >= low) >= 0.5 * loads.size:
        return f"leave out what is in the noise around zero with --loads {low:g}: (in {unit})"
    if np.count_nonzero(loads < 0) > 0.5 * loads.size:
        return "if compression is counted negative, add --sign load"
    return "correct the row, or leave such rows out with --exclude"


def _ends(sheet: Sheet, text: str) -> tuple[float, float]:
    """Return the ends of a range, either of which may be left out."""
    low, colon, high = text.partition(":")
    try:
        ends = (plain_number(low) if low else -np.inf, plain_number(high) if high else np.inf)
    except ValueError:
        ends = (np.nan, np.nan)
    if not (colon and ends[0] < ends[1]):
        rule = "must be a range of loads, the lower end first"
        raise InputError(sheet.source, "loads", text, rule, "write e.g. 5:400, 5: or :400")
    return ends
