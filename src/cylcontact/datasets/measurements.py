"""Measurements: from a table of loads and penetrations to checked arrays in mm, N and MPa.

`read_measured` reads the cells of a table, converts the columns from their units, adds constants
and the moduli of named materials, and divides total forces by the axial length. A result stores
the columns that come out. `measurements_of` checks them row by row and returns the arrays.
"""

from __future__ import annotations

import csv
import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from cylcontact import limits
from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.choices import TABLE_SUFFIXES
from cylcontact.errors import InputError
from cylcontact.materials import (
    MaterialRow,
    known_materials,
    material_in_MPa,
    shipped_materials,
)
from cylcontact.pair import Contact, CylinderPair
from cylcontact.spec import Spec
from cylcontact.units import LABELS, Column, column_named, spellings

__all__ = [
    "MAX_ROWS",
    "Constants",
    "Indices",
    "MeasuredData",
    "Measurements",
    "measurements_of",
    "read_measured",
    "yield_notes",
]

# All rows are held in memory and stored in the result.
MAX_ROWS = 200_000
Constants = Mapping[str, float | str]
Indices = NDArray[np.intp]
# Of each row of a table its position in the file, a CSV's line or a Parquet's row, and its cells.
_Rows = Sequence[tuple[int, Sequence[object]]]
_Numbers = dict[str, FloatArray]
_Labels = dict[str, list[str]]
_Materials = dict[str, MaterialRow]
_SHIPPED = "the table that ships"
_GROUPINGS = ("rows", "material", "dR", "pair", "group", "branch")


class _Range(NamedTuple):
    """The values that a row may have of a quantity."""

    rule: str
    allows: Callable[[FloatArray], BoolArray]


_POSITIVE = _Range("must be positive and finite", lambda values: values > 0)
_RATIO = _Range("must lie in [0, 0.5]", lambda values: (values >= 0) & (values <= 0.5))
# What a row may have of each quantity, in the unit in which it is kept, in the order of checks.
_RANGES = {
    "load": _POSITIVE,  # N/mm
    "penetration": _POSITIVE,  # mm
    "E_i": _POSITIVE,  # MPa
    "E_j": _POSITIVE,  # MPa
    "dR": _POSITIVE,  # mm
    "R_i": _POSITIVE,  # mm
    "R_j": _POSITIVE,  # mm
    "length": _POSITIVE,  # mm
    "load_std": _POSITIVE,  # N/mm
    "penetration_std": _POSITIVE,  # mm
    "weight": _POSITIVE,
    "nu_i": _RATIO,
    "nu_j": _RATIO,
}
_REQUIRED = ("load", "penetration", "E_i", "E_j", "nu_i", "nu_j")


class MeasuredData(Spec):
    """Measurements as stored in a result: columns in mm, N and MPa with N rows or one."""

    source: str = Field(description="the table they came from")
    sha256: str = Field(description="the hash of its bytes")
    contact: Contact = Field(description='"internal" or "external"')
    row_word: str = Field("line", description='"line" or "row"')
    lines: list[int] = Field(description="the position of each row in the table")
    numbers: dict[str, list[float]] = Field(description="columns of numbers")
    labels: dict[str, list[str]] = Field(description="columns of words")
    notes: list[str] = Field(description="remarks for the report")


@dataclass(frozen=True, eq=False)
class Measurements:
    """N measured points, each a load and a penetration of a known pair.

    Attributes
    ----------
    data : MeasuredData
        The columns they were made from.
    rows : array of int, shape (N,)
        Indices of the rows in `data`, possibly repeated.
    columns : dict of str to array of float, shape (N,)
        Columns in mm, N and MPa.
    """

    data: MeasuredData
    rows: Indices
    columns: dict[str, FloatArray]

    def __len__(self) -> int:
        return self.rows.size

    @property
    def contact(self) -> Contact:
        """Pin in hole, or two rollers."""
        return self.data.contact

    @property
    def load(self) -> FloatArray:
        """Loads in N/mm."""
        return self.columns["load"]

    @property
    def penetration(self) -> FloatArray:
        """Penetrations in mm."""
        return self.columns["penetration"]

    @property
    def weight(self) -> FloatArray:
        """Weights of the squared residuals, with mean 1."""
        weight = self.columns.get("weight", np.ones(len(self)))
        return np.asarray(weight / weight.mean())

    @cached_property
    def pair(self) -> CylinderPair:
        """The pair of each row."""
        columns = self.columns
        body_i = material_in_MPa("i", columns["E_i"], columns["nu_i"])
        body_j = material_in_MPa("j", columns["E_j"], columns["nu_j"])
        R_i, R_j = columns.get("R_i"), columns.get("R_j")
        # Laws broadcast a length like all other arguments, although its type is a single number.
        length = cast("float | None", columns.get("length"))
        return CylinderPair(self.contact, columns["dR"], body_i, body_j, R_i, R_j, length)

    def take(self, rows: Indices) -> Measurements:
        """Return the measurements with these indices, possibly repeated."""
        columns = {name: column[rows] for name, column in self.columns.items()}
        return Measurements(self.data, self.rows[rows], columns)

    def with_values(self, **columns: FloatArray) -> Measurements:
        """Return the same rows with other loads, penetrations or deviations."""
        return replace(self, columns=self.columns | columns)

    def line(self, row: int) -> int:
        """Return the position of a row in the table."""
        return self.data.lines[int(self.rows[row])]

    def groups(self, over: str) -> tuple[list[str], Indices]:
        """Return the names of the groups, and the group of each row.

        Parameters
        ----------
        over : {"rows", "material", "dR", "pair", "group"}
            The criterion of the grouping.

        Raises
        ------
        InputError
            If the grouping is unknown, or the table has no column `group`.
        """
        if over not in _GROUPINGS:
            remedy = f"choose {', '.join(_GROUPINGS)}"
            raise InputError("grouping", "over", over, "is unknown", remedy)
        if over == "group" and "group" not in self.data.labels:
            rule = "is not a column of the table"
            remedy = "add a column group, or choose rows, material, dR or pair"
            raise InputError(self.data.source, "group", None, rule, remedy)
        names = [self._group_name(over, k) for k in range(len(self))]
        index = {name: number for number, name in enumerate(dict.fromkeys(names))}
        return list(index), np.array([index[name] for name in names], dtype=np.intp)

    def duplicates(self) -> list[list[int]]:
        """Return the positions of identical rows, one list for each group of them."""
        positions: dict[tuple[float, ...], list[int]] = {}
        stacked = np.column_stack(list(self.columns.values()))
        for k, row in enumerate(map(tuple, stacked.tolist())):
            positions.setdefault(row, []).append(self.line(k))
        return [lines for lines in positions.values() if len(lines) > 1]

    def replicates(self) -> list[Indices]:
        """Return the rows of each load that was repeated."""
        _, pair = self.groups("pair")
        sets: dict[tuple[int, float], list[int]] = {}
        for k, key in enumerate(zip(pair.tolist(), self.load.tolist(), strict=True)):
            sets.setdefault(key, []).append(k)
        return [np.array(rows) for rows in sets.values() if len(rows) > 1]

    def _group_name(self, over: str, k: int) -> str:
        """Return the name of the group that row k belongs to."""
        if over == "rows":
            return f"{self.data.row_word} {self.line(k)}"
        if over == "dR":
            return f"ΔR = {self.columns['dR'][k]:.6g} mm"
        if over == "pair":
            return f"{self._group_name('material', k)}, {self._group_name('dR', k)}"
        words = [words for name, words in self.data.labels.items() if name.startswith(over)]
        if words:
            row = int(self.rows[k])
            return " on ".join(column[row % len(column)] for column in words)
        E_i, E_j = self.columns["E_i"][k], self.columns["E_j"][k]
        return f"E = {E_i:.6g} MPa" if E_i == E_j else f"E = {E_i:.6g} and {E_j:.6g} MPa"


# --- from a table to columns --------------------------------------------------------------------


def read_measured(
    path: Path | str,
    contact: Contact,
    constants: Constants | None = None,
    materials: Path | None = None,
    ignored: Sequence[str] = (),
) -> MeasuredData:
    r"""Read a table of measurements into columns.

    Parameters
    ----------
    path : path
        A CSV or Parquet file with the units in the column names (`cylcontact.units`).
    contact : {"internal", "external"}
        Pin in hole, or two rollers.
    constants : mapping, optional
        Values for all rows, by column name: {"E_GPa": 207, "dR_um": 50}.
    materials : path, optional
        Your own table of materials, in addition to that of the package.
    ignored : sequence of str
        Columns to leave out.

    Returns
    -------
    MeasuredData
        Unchecked; `measurements_of` checks it.

    Raises
    ------
    InputError
        If the file cannot be read or is of another kind, has an unknown or repeated column, a cell
        that is empty or not a number, no rows or too many; or a constant is wrong, a quantity is
        given twice or not at all, or a material is unknown.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "mine.csv")
    ...     _ = path.write_text("load_kN,penetration_um\n0.2,0.206\n0.5,0.454\n")
    ...     pair = {"E_GPa": 207, "nu": 0.3, "dR_um": 30, "length_mm": 20}
    ...     data = read_measured(path, "internal", pair)
    >>> data.numbers["load"], data.numbers["E_i"], data.lines
    ([10.0, 25.0], [207000.0], [2, 3])
    """
    source = str(path)
    row_word = "row" if source.lower().endswith(".parquet") else "line"
    sha256, names, rows = _read_table(source)
    lines = [line for line, _ in rows]
    columns = _recognised(source, names, ignored)
    values = _values(f"{source}, {row_word}", columns, names, rows)
    del rows  # their text takes more memory than the numbers
    columns += _add_constants(source, constants or {}, values)
    labels = {c.quantity: values[c.quantity] for c in columns if c.quantity in LABELS}
    numbers = {
        c.quantity: np.array([value * c.factor for value in values[c.quantity]])
        for c in columns
        if c.quantity not in LABELS
    }
    notes = _add_moduli(source, numbers, labels, materials)
    _divide_by_length(source, numbers, sorted(c.quantity for c in columns if c.is_total))
    return MeasuredData(
        source=Path(source).name,
        sha256=sha256,
        contact=contact,
        row_word=row_word,
        lines=lines,
        numbers={name: column.tolist() for name, column in numbers.items()},
        labels=labels,
        notes=notes,
    )


def _read_table(source: str) -> tuple[str, list[str], _Rows]:
    """Return the hash of a file's bytes, the names of its columns, and its rows."""
    suffix = Path(source).suffix.lower()
    if suffix not in TABLE_SUFFIXES:
        raise InputError(source, "", None, "is neither .csv nor .parquet", "name a table")
    try:
        sha256 = hashlib.sha256(Path(source).read_bytes()).hexdigest()
        names, rows = _read_csv(source) if suffix == ".csv" else _read_parquet(source)
    except OSError as error:
        rule = f"cannot be read ({error.strerror or error})"
        raise InputError(source, "", None, rule, "check the path") from error
    if not rows:
        raise InputError(source, "", None, "holds no rows", "give it at least one below the names")
    if len(rows) > MAX_ROWS:
        rule = f"has {len(rows)} rows (at most {MAX_ROWS})"
        raise InputError(source, "", None, rule, "thin or average them")
    return sha256, names, rows


def _read_csv(source: str) -> tuple[list[str], _Rows]:
    """Return the names of the columns, and the rows of text, without empty ones.

    pandas would count lines otherwise, and fill rows that lack cells.
    """
    try:
        with Path(source).open(encoding="utf-8-sig", newline="") as file:
            # A comment becomes an empty line, so that the lines below it keep their numbers.
            reader = csv.reader(("\n" if x.startswith("#") else x for x in file), strict=True)
            rows = [(reader.line_num, c) for row in reader if any(c := [*map(str.strip, row)])]
    except (UnicodeDecodeError, csv.Error) as error:
        rule = f"is not a CSV table ({error})"
        raise InputError(source, "", None, rule, "save it as CSV in UTF-8") from error
    if not rows:
        raise InputError(source, "", None, "is empty", "give it a line of column names, then rows")
    names = rows.pop(0)[1]
    if any(";" in name for name in names):
        remedy = "save it with commas, points in numbers"
        raise InputError(source, "", None, "is separated by semicolons", remedy)
    for line, row in rows:
        if len(row) != len(names):
            rule = f"has {len(row)} cells for {len(names)} columns"
            remedy = "give every row a cell for each column, separated by commas"
            raise InputError(f"{source}, line {line}", "", None, rule, remedy)
    return names, rows


def _read_parquet(source: str) -> tuple[list[str], _Rows]:
    """Return the names of the columns, and the rows, whose cells may be of any type."""
    import pyarrow as pa
    import pyarrow.parquet

    try:
        table = pyarrow.parquet.read_table(source)
    except pa.ArrowException as error:
        rule = f"is not a Parquet table ({error})"
        raise InputError(source, "", None, rule, "write it anew, or use CSV") from error
    cells = (column.to_pylist() for column in table.columns)
    return table.column_names, list(enumerate(zip(*cells, strict=True), start=1))


def _recognised(source: str, names: Sequence[str], ignored: Sequence[str]) -> list[Column]:
    """Return the parsed names of the columns that are not ignored."""
    for name in ignored:
        if name not in names:
            rule, remedy = "is not a column of the table", f"it has {', '.join(names)}"
            raise InputError(source, "ignore", name, rule, remedy)
    columns: dict[str, Column] = {}
    for name in (name for name in names if name not in ignored):
        column = column_named(name)
        if column is None:
            remedy = (
                "give the quantity and its unit, e.g. load_N_per_mm, penetration_um, E_GPa, nu, "
                "dR_um, or list it under ignore"
            )
            raise InputError(source, "columns", name, "is not a known column", remedy)
        if column.quantity in columns:
            rule = f"gives the same quantity as {columns[column.quantity].name}"
            raise InputError(source, "columns", name, rule, "keep one of them")
        columns[column.quantity] = column
    return list(columns.values())


def _values(
    where: str, columns: Sequence[Column], names: Sequence[str], rows: _Rows
) -> dict[str, list[Any]]:
    """Return the columns by quantity, those of numbers first, still in their units."""
    values: dict[str, list[Any]] = {}
    for column in sorted(columns, key=lambda column: column.quantity in LABELS):
        k = names.index(column.name)
        values[column.quantity] = [_value(where, column, line, row[k]) for line, row in rows]
    return values


def _value(where: str, column: Column, line: int, cell: object) -> float | str:
    """Return a cell as a word or a finite number."""
    if cell is None or cell == "":
        remedy = "fill it in, or remove the row"
        raise InputError(f"{where} {line}", column.name, None, "is empty", remedy)
    if column.quantity in LABELS:
        return str(cell)
    try:
        number = float(cell)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        remedy = "write it with a decimal point, without its unit"
        raise InputError(f"{where} {line}", column.name, cell, "must be a finite number", remedy)
    return number


def _add_constants(source: str, constants: Constants, values: dict[str, list[Any]]) -> list[Column]:
    """Add the constants as columns of one row; return their parsed names."""
    columns = []
    for name, value in constants.items():
        key, column = f"constants.{name}", column_named(name)
        if column is None or column.quantity in ("load", "penetration", "weight", "group"):
            remedy = "give e.g. E_GPa, nu, material, dR_um, R_i_mm, length_mm"
            raise InputError(source, key, value, "is not a known constant", remedy)
        if column.quantity in values:
            rule = f"{column.quantity} is given twice, here and as a column or constant"
            raise InputError(source, key, value, rule, "keep one of them")
        if isinstance(value, str) != (column.quantity in LABELS) or isinstance(value, bool):
            rule = "must be a name" if column.quantity in LABELS else "must be a number"
            raise InputError(source, key, value, rule, "correct it")
        values[column.quantity] = [value]
        columns.append(column)
    return columns


def _add_moduli(source: str, numbers: _Numbers, labels: _Labels, own: Path | None) -> list[str]:
    """Replace E and ν by those of each body; return notes on the provenance of materials."""
    used = {word for name in labels if name.startswith("material") for word in labels[name]}
    rows = known_materials(own) if used else {}
    table = _SHIPPED if own is None else own.name
    moduli = {body: _moduli(body, source, numbers, labels, rows, table) for body in "ij"}
    for body, (E, nu) in moduli.items():
        numbers |= {f"E_{body}": E, f"nu_{body}": nu}
    for quantity in {"E", "nu"} & {*numbers}:
        del numbers[quantity]
    shipped = shipped_materials() if used else {}
    return [
        f"E and ν of {name} are from {_SHIPPED if name in shipped else table}: "
        f"E {row.provenance['E_GPa']}, ν {row.provenance['nu']}"
        for name, row in rows.items()
        if name in used
    ]


def yield_notes(measured: Measurements, own: Path | None) -> list[str]:
    """Return a note if loads are above first yield, where materials and radii are known."""
    labels = measured.data.labels
    of_both = labels.get("material")
    holes, pins = labels.get("material_i", of_both), labels.get("material_j", of_both)
    if holes is None or pins is None or "R_i" not in measured.columns:
        return []
    size = len(measured)
    names = np.stack([np.broadcast_to(words, size) for words in (holes, pins)], axis=1)
    rows, above = known_materials(own), 0
    for words in np.unique(names, axis=0):
        part = measured.take(np.flatnonzero((names == words).all(axis=1)))
        hole, pin = (rows[word].material for word in words)
        if hole.yield_stress is not None and pin.yield_stress is not None:
            pair = replace(part.pair, material_i=hole, material_j=pin)
            above += int(np.count_nonzero(part.load > limits.yield_load(pair)))
    if not above:
        return []
    return [
        f"{above} of {size} loads are above first yield by von Mises, with the yield "
        "stresses of the table of materials, and the law is elastic"
    ]


def _moduli(
    body: str, source: str, numbers: _Numbers, labels: _Labels, rows: _Materials, table: str
) -> tuple[FloatArray, FloatArray]:
    """Return E in MPa and ν of one body, given exactly once, by name or by number."""
    named = [name for name in (f"material_{body}", "material") if name in labels]
    pairs = [(f"E{b}", f"nu{b}") for b in (f"_{body}", "") if {f"E{b}", f"nu{b}"} & {*numbers}]
    if len(named) + len(pairs) != 1:
        given = ", ".join([*named, *(name for pair in pairs for name in pair)]) or "nothing"
        rule = f"must get E and ν from exactly one place, and {given} is given"
        remedy = f"give material, material_{body}, E and nu, or E_{body} and nu_{body}"
        raise InputError(source, f"body {body}", None, rule, remedy)
    if pairs:
        _require_given(source, pairs[0], numbers)
        E, nu = pairs[0]
        return numbers[E], numbers[nu]
    for word in labels[named[0]]:
        if word not in rows:
            remedy = f"choose {', '.join(rows)}, or name a table of your own with --materials"
            raise InputError(source, named[0], word, f"is not in {table}", remedy)
    materials = [rows[word].material for word in labels[named[0]]]
    return np.array([m.E for m in materials], float), np.array([m.nu for m in materials], float)


def _divide_by_length(source: str, numbers: _Numbers, totals: Sequence[str]) -> None:
    """Turn total forces into loads per unit length."""
    for quantity in totals:
        if "length" not in numbers:
            rule = "is a total force, and the axial length is not given"
            remedy = f"add {spellings('length')}, or give the load per unit length"
            raise InputError(source, quantity, None, rule, remedy)
        with np.errstate(divide="ignore", invalid="ignore"):  # the length may be 0
            numbers[quantity] = numbers[quantity] / numbers["length"]


# --- from columns to checked arrays -------------------------------------------------------------


def measurements_of(data: MeasuredData, source: str) -> Measurements:
    """Check columns row by row and return the measurements.

    Parameters
    ----------
    data : MeasuredData
        From `read_measured`, or from a result.
    source : str
        Its name in errors.

    Returns
    -------
    Measurements

    Raises
    ------
    InputError
        If a column is missing or has another number of rows, or a row has an impossible value;
        the message names the row.

    Examples
    --------
    >>> data = MeasuredData(
    ...     source="made up", sha256="", contact="internal", lines=[2, 3], labels={}, notes=[],
    ...     numbers={"load": [10.0, 100.0], "penetration": [2e-4, 1.6e-3], "dR": [0.05],
    ...              "E_i": [207e3], "E_j": [207e3], "nu_i": [0.3], "nu_j": [0.3]})
    >>> measured = measurements_of(data, "example")
    >>> len(measured), measured.pair.E_star.shape
    (2, (2,))
    """
    size = len(data.lines)
    _require_shapes(data, size, source)
    columns = {
        name: np.broadcast_to(np.array(values, dtype=np.float64), size).copy()
        for name, values in data.numbers.items()
    }
    _require_given(source, _REQUIRED, columns)
    for name, allowed in _RANGES.items():
        if name in columns:
            _require(data, source, name, columns[name], allowed)
    _complete_geometry(data, columns, source)
    return Measurements(data, np.arange(size), columns)


def _require_shapes(data: MeasuredData, size: int, source: str) -> None:
    """Raise `InputError` for columns of a damaged result: unknown ones or another length."""
    for name, values in data.numbers.items():
        if name not in _RANGES or len(values) not in (1, size):
            rule = f"is not a known column of 1 or {size} rows"
            raise InputError(source, f"numbers.{name}", None, rule, "redo the fit")
    for name, words in data.labels.items():
        if len(words) not in (1, size):
            rule = f"is not a column of 1 or {size} rows"
            raise InputError(source, f"labels.{name}", None, rule, "redo the fit")
    if not size:
        raise InputError(source, "lines", [], "must hold at least one row", "redo the fit")


def _require_given(source: str, names: Sequence[str], columns: _Numbers) -> None:
    """Raise `InputError` for the first column that is missing."""
    for name in names:
        if name not in columns:
            raise InputError(source, name, None, "is required", f"add {spellings(name)}")


def _require(
    data: MeasuredData, source: str, name: str, values: FloatArray, allowed: _Range
) -> None:
    """Raise `InputError` for the first row with a value that is not allowed."""
    wrong = np.flatnonzero(~(allowed.allows(values) & np.isfinite(values)))
    if wrong.size:
        first = int(wrong[0])
        where = f"{source}, {data.row_word} {data.lines[first]}"
        more = f" ({wrong.size - 1} more like it)" if wrong.size > 1 else ""
        remedy = f"correct the row, or remove it; mind the unit in the column's name{more}"
        raise InputError(where, name, float(values[first]), allowed.rule, remedy)


def _complete_geometry(data: MeasuredData, columns: _Numbers, source: str) -> None:
    """Add the one of ΔR, R_i and R_j that follows from the two others."""
    given = [name for name in ("dR", "R_i", "R_j") if name in columns]
    if given not in (["dR"], ["dR", "R_i"], ["dR", "R_j"], ["R_i", "R_j"]):
        rule = "must be ΔR, ΔR and one radius, or both radii"
        remedy = f"give {spellings('dR')}, or R_i and R_j in the same units"
        raise InputError(source, "dR, R_i, R_j", given, rule, remedy)
    if given == ["dR"]:
        return
    sign = 1.0 if data.contact == "internal" else -1.0
    if "R_j" not in given:
        name, values = "R_j", sign * (columns["R_i"] - columns["dR"])
    elif "R_i" not in given:
        name, values = "R_i", columns["dR"] + sign * columns["R_j"]
    else:
        name, values = "dR", columns["R_i"] - sign * columns["R_j"]
    rule = f"comes out not positive for {data.contact} contact (given {', '.join(given)})"
    _require(data, source, name, values, _POSITIVE._replace(rule=rule))
    columns[name] = values
