"""Read tables of measurements, CSV or Parquet, into columns of numbers and text."""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.choices import TABLE_SUFFIXES
from cylcontact.errors import InputError
from cylcontact.units import LABELS, Column, column_named

__all__ = ["MAX_ROWS", "MeasuredTable", "read_table"]

# All rows are held in memory and stored in the result.
MAX_ROWS = 200_000


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """A table as read, in the units of its columns.

    Attributes
    ----------
    source : str
        The file.
    sha256 : str
        The hash of its bytes.
    columns : tuple of Column
        The parsed names of the columns.
    numbers : mapping of str to array of float, shape (N,)
        By quantity, still in the column's unit.
    labels : mapping of str to tuple of str
        The columns of text, by quantity.
    lines : tuple of int
        Position of each row in the file: the line of a CSV, or the row of a Parquet file from 1.
    """

    source: str
    sha256: str
    columns: tuple[Column, ...]
    numbers: Mapping[str, FloatArray]
    labels: Mapping[str, tuple[str, ...]]
    lines: tuple[int, ...]

    @property
    def row_word(self) -> str:
        """The word for a row in errors: "line" for CSV, "row" for Parquet."""
        return "row" if self.source.lower().endswith(".parquet") else "line"


def read_table(path: Path | str, ignored: Sequence[str] = ()) -> MeasuredTable:
    """Read a table with units in its column names.

    Parameters
    ----------
    path : path
        A .csv file with a line of column names, or a .parquet file.
    ignored : sequence of str
        Columns to leave out.

    Returns
    -------
    MeasuredTable

    Raises
    ------
    InputError
        If the file cannot be read or is of another kind, has an unknown or repeated column, a
        cell that is empty or not a number, no rows or too many.
    """
    source = str(path)
    suffix = Path(path).suffix.lower()
    if suffix not in TABLE_SUFFIXES:
        raise InputError(source, "", None, "is neither .csv nor .parquet", "name a table")
    try:
        digest = hashlib.sha256(Path(path).read_bytes()).hexdigest()
        names, cells, lines = (_read_csv if suffix == ".csv" else _read_parquet)(source)
    except OSError as error:
        raise InputError(
            source, "", None, f"cannot be read ({error.strerror or error})", "check the path"
        ) from error
    if not lines:
        raise InputError(source, "", None, "holds no rows", "give it at least one below the names")
    if len(lines) > MAX_ROWS:
        raise InputError(
            source, "", None, f"has {len(lines)} rows (at most {MAX_ROWS})", "thin or average them"
        )
    columns = _known_columns(source, names, ignored)
    by_name = dict(zip(names, cells, strict=True))
    word = "row" if suffix == ".parquet" else "line"
    numbers = {
        c.quantity: _numbers(f"{source}, {word}", c.name, by_name[c.name], lines)
        for c in columns
        if c.quantity not in LABELS
    }
    labels = {
        c.quantity: _words(f"{source}, {word}", c.name, by_name[c.name], lines)
        for c in columns
        if c.quantity in LABELS
    }
    return MeasuredTable(source, digest, columns, numbers, labels, tuple(lines))


def _read_csv(source: str) -> tuple[list[str], list[list[object]], list[int]]:
    """Return names, columns of text cells, and the line of each row."""
    try:
        with Path(source).open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(_without_comments(file), strict=True)
            table = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(
            source, "", None, f"is not a CSV table ({error})", "save it as CSV in UTF-8"
        ) from error
    if not table:
        raise InputError(source, "", None, "is empty", "give it a line of column names, then rows")
    names = [cell.strip() for cell in table[0][1]]
    if any(";" in name for name in names):
        raise InputError(
            source, "", None, "is separated by semicolons", "save it with commas, points in numbers"
        )
    for line, row in table[1:]:
        if len(row) != len(names):
            raise InputError(
                f"{source}, line {line}",
                "",
                None,
                f"has {len(row)} cells for {len(names)} columns",
                "give every row a cell for each column, separated by commas",
            )
    cells: list[list[object]] = [
        [row[k].strip() for _, row in table[1:]] for k in range(len(names))
    ]
    return names, cells, [line for line, _ in table[1:]]


def _without_comments(lines: Iterable[str]) -> Iterator[str]:
    """Blank the lines that begin with #, so that the other line numbers do not change."""
    return ("\n" if line.startswith("#") else line for line in lines)


def _read_parquet(source: str) -> tuple[list[str], list[list[object]], list[int]]:
    """Return names, columns of cells, and the number of each row from 1."""
    import pyarrow as pa
    import pyarrow.parquet

    try:
        table = pyarrow.parquet.read_table(source)
    except pa.ArrowException as error:
        raise InputError(
            source, "", None, f"is not a Parquet table ({error})", "write it anew, or use CSV"
        ) from error
    cells = [column.to_pylist() for column in table.columns]
    return list(table.column_names), cells, list(range(1, table.num_rows + 1))


def _known_columns(source: str, names: Sequence[str], ignored: Sequence[str]) -> tuple[Column, ...]:
    """Return the parsed column names; raise `InputError` for unknown and repeated ones."""
    for name in ignored:
        if name not in names:
            raise InputError(
                source, "ignore", name, "is not a column of the table", f"it has {', '.join(names)}"
            )
    columns: dict[str, Column] = {}
    for name in names:
        if name in ignored:
            continue
        column = column_named(name)
        if column is None:
            raise InputError(
                source,
                "columns",
                name,
                "is not a known column",
                "give the quantity and its unit, e.g. load_N_per_mm, penetration_um, E_GPa, nu, "
                "dR_um, or list it under ignore",
            )
        if column.quantity in columns:
            raise InputError(
                source,
                "columns",
                name,
                f"gives the same quantity as {columns[column.quantity].name}",
                "keep one of them",
            )
        columns[column.quantity] = column
    return tuple(columns.values())


def _numbers(source: str, name: str, cells: Sequence[object], lines: Sequence[int]) -> FloatArray:
    """Return a column's cells as finite numbers."""
    values = np.empty(len(cells))
    for k, (cell, line) in enumerate(zip(cells, lines, strict=True)):
        if cell is None or cell == "":
            raise InputError(
                f"{source} {line}", name, None, "is empty", "fill it in, or remove the row"
            )
        try:
            values[k] = float(cell)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            values[k] = np.nan
        if not np.isfinite(values[k]):
            raise InputError(
                f"{source} {line}",
                name,
                cell,
                "must be a finite number",
                "write it with a decimal point, without its unit",
            )
    return values


def _words(
    source: str, name: str, cells: Sequence[object], lines: Sequence[int]
) -> tuple[str, ...]:
    """Return a column's cells as text."""
    for cell, line in zip(cells, lines, strict=True):
        if cell is None or cell == "":
            raise InputError(
                f"{source} {line}", name, None, "is empty", "fill it in, or remove the row"
            )
    return tuple(str(cell) for cell in cells)
