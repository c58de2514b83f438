"""Readings of a table: columns as numbers, signs that are turned, rows that are left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from cylcontact.datasets.columns import MEASURED, column_at, given_columns, named_columns
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


class TableSpec(Spec):
    """How a table is read."""

    columns: dict[str, str] | None = Field(
        None, description='a table [columns] of what columns are, e.g. load_N = "Kraft"'
    )
    group: str | None = Field(
        None, description="the column that names the series, which have errors of their own"
    )
    ignore: tuple[str, ...] = Field((), strict=False, description="a list of columns to leave out")
    sheet: str | None = Field(None, description="the name of a sheet of a workbook")
    header: int | None = Field(None, ge=0, description="the line of the names, 0 for none")
    decimal: Literal[".", ","] | None = Field(None, description='"." or ","')
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

    @property
    def unread(self) -> list[int]:
        """The columns that are not read."""
        others = ((k, x) for k, x in enumerate(self.sheet.columns) if k not in self.columns)
        return [k for k, x in others if self.sheet.name(k) or any(c is not None for c in x)]

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


def read_readings(data: Path | str | pd.DataFrame, spec: TableSpec) -> Readings:
    """Read the measurements of a table."""
    given = spec.columns or {}
    wanted = {*given.values()} | ({spec.group} if spec.group is not None else set())
    sheet = read_sheet(data, wanted, spec.sheet, spec.header)
    skipped = {column_at(sheet, "ignore", name) for name in spec.ignore}
    columns = given_columns(sheet, given)
    explicit = {column.quantity for column in columns.values()}
    group = None if spec.group is None else column_at(sheet, "group", spec.group)
    if group is not None:
        explicit.add("group")
    others, unclear = named_columns(sheet, skipped | {*columns}, explicit)
    columns |= others
    _drop_empty(sheet, {*columns} | ({group} if group is not None else set()))
    optional = {k for k, c in others.items() if c.quantity in ("time", "group")}
    readings = Readings(sheet, columns, {}, {}, unclear)
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
        _keep_loads(readings, spec.loads)
    return readings


def _rank(quantity: str) -> int:
    return [*MEASURED, quantity].index(quantity)


def _values(sheet: Sheet, k: int, column: Column, decimal: str | None) -> FloatArray:
    clock = seconds(sheet, k) if column.quantity == "time" else None
    if clock is not None:
        return np.array(clock)
    return np.array([value * column.factor for value in numbers(sheet, k, decimal)])


# --- rows ---------------------------------------------------------------------------------------


def _drop_empty(sheet: Sheet, columns: set[int]) -> None:
    """Leave out rows without a cell in what is read, as where a longer series is beside it."""
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


def _keep_loads(readings: Readings, text: str | None) -> None:
    """Leave out the rows with loads outside a range LOW:HIGH in the unit of the table."""
    sheet = readings.sheet
    k, column = next((k, c) for k, c in readings.columns.items() if c.quantity == "load")
    values, unit = readings.numbers["load"] / column.factor, column.symbol
    low, high = _ends(sheet, text or ":")
    keeps = (values >= low) & (values <= high)
    below = np.flatnonzero(keeps & (values < 0))
    if below.size:
        more = f", {below.size - 1} more like it" if below.size > 1 else ""
        remedy = f"leave such rows out with --loads 0: (in {unit}{more}), or correct the row"
        raise sheet.error("must be positive", remedy, int(below[0]), k)
    if not keeps.any():
        remedy = f"give a range in {unit}: its loads are {values.min():.6g} to {values.max():.6g}"
        raise InputError(sheet.source, "loads", text, "leaves no row", remedy)
    out = [*compress(sheet.lines, ~keeps)]
    if out:
        rows = f"{counted(out, 'row')} with loads outside {text} {unit}"
        sheet.left_out.append(f"{rows} ({sheet.numbered(out)})")
    sheet.lines = [*compress(sheet.lines, keeps)]
    readings.numbers = {name: cells[keeps] for name, cells in readings.numbers.items()}
    readings.labels = {name: [*compress(cells, keeps)] for name, cells in readings.labels.items()}


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
