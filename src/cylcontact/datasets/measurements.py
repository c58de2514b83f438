"""Measurements: from a table of loads and penetrations to checked arrays in mm, N and MPa.

`read_measured` adds constants and the moduli of named materials to the readings of a table, and
divides total forces by the axial length. A result stores the columns that come out.
`measurements_of` checks them row by row and returns the arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import AliasChoices, Field

from cylcontact import limits
from cylcontact.bodies.material import (
    LARGEST_MODULUS,
    MaterialRow,
    find_material,
    known_materials,
    material_in_MPa,
    shipped_materials,
)
from cylcontact.bodies.pair import Contact, CylinderPair, roles, unusual_lengths
from cylcontact.datasets.branches import kept_rows
from cylcontact.datasets.columns import MEASURED, option_for
from cylcontact.datasets.reading import (
    Readings,
    TableSpec,
    keep_loads,
    load_column,
    read_readings,
)
from cylcontact.files.spec import Spec
from cylcontact.files.units import LABELS, Column, column_named, spellings
from cylcontact.laws import Housing
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats, equal_rows
from cylcontact.support.choices import BRANCHES, first_of, listed
from cylcontact.support.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

Constants = Mapping[str, float | str]
# A table of measurements: a path or a DataFrame.
Source: TypeAlias = "Path | str | pd.DataFrame"
Indices = NDArray[np.intp]
_Numbers = dict[str, FloatArray]
_Labels = dict[str, list[str]]
_Materials = dict[str, MaterialRow]
_SHIPPED = "the table that ships"
# Columns that an error names.
_LISTED = 8
# A column whose unit is not known is needed if nothing else of its group is given.
_ALTERNATIVES = (
    {"dR", "R_i", "R_j"},
    {f"{name}{body}" for name in ("E", "nu", "material") for body in ("", "_i", "_j")},
)
_DEFAULT = TableSpec()
# The label of each row's file where there are several.
_FILE = "file"
_GROUPINGS = ("rows", "material", "dR", "pair", "group", "branch")


class _Range(NamedTuple):
    """The values that a row may have of a quantity."""

    rule: str
    allows: Callable[[FloatArray], BoolArray]


_POSITIVE = _Range("must be positive and finite", lambda values: values > 0)
_MODULUS = _Range(
    f"must be positive, and at most {LARGEST_MODULUS:g} MPa",
    lambda values: (values > 0) & (values <= LARGEST_MODULUS),
)
_FINITE = _Range("must be finite", np.isfinite)
_RATIO = _Range("must lie in [0, 0.5]", lambda values: (values >= 0) & (values <= 0.5))
# What a row may have of each quantity, in the unit in which it is kept, in the order of checks.
_RANGES = {
    "length": _POSITIVE,  # mm; before the loads that it has divided
    "load": _POSITIVE,  # N/mm
    "penetration": _FINITE,  # mm; a reading that is not zeroed may be negative
    "E_i": _MODULUS,  # MPa
    "E_j": _MODULUS,  # MPa
    "dR": _POSITIVE,  # mm
    "R_i": _POSITIVE,  # mm
    "R_j": _POSITIVE,  # mm
    "load_std": _POSITIVE,  # N/mm
    "penetration_std": _POSITIVE,  # mm
    "time": _FINITE,  # s
    "nu_i": _RATIO,
    "nu_j": _RATIO,
}
_REQUIRED = ("load", "penetration", "E_i", "E_j", "nu_i", "nu_j")


class MeasuredData(Spec):
    """Measurements as stored in a result: columns in mm, N and MPa with N rows or one."""

    source: str
    sha256: str
    contact: Contact
    row_word: str = "line"
    # Positions in the table; of several tables with the file, as b.csv:12.
    lines: list[int | str]
    numbers: dict[str, list[float]]
    labels: dict[str, list[str]]
    notes: list[str]
    # What was read of the table, and its units of load and penetration.
    read: list[str] = Field([], validation_alias=AliasChoices("read", "steps"))
    units: dict[str, str] = Field({})
    # Columns of words that were not read; they may name series.
    unused: list[str] = Field([])


@dataclass(frozen=True, eq=False)
class Measurements:
    """N measured points, each a load and a penetration of a known pair."""

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
    def read(self) -> list[str]:
        """Lines that say what was read of the table, left out and decided."""
        return self.data.read

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

    def line(self, row: int) -> int | str:
        """Return the position of a row in the table, with its file if there are several."""
        return self.data.lines[int(self.rows[row])]

    def groups(self, over: str) -> tuple[list[str], Indices]:
        """Return the names of the groups, and the group of each row."""
        if over not in _GROUPINGS:
            remedy = f"choose {', '.join(_GROUPINGS)}"
            raise InputError("grouping", "over", over, "is unknown", remedy)
        if over == "group" and "group" not in self.data.labels:
            rule = "is not a column of the table"
            remedy = (
                "add a column group or name one with --group, or choose rows, material, dR or pair"
            )
            raise InputError(self.data.source, "group", None, rule, remedy)
        if over not in self._groups:
            self._groups[over] = self._grouped(over)
        return self._groups[over]

    @cached_property
    def _groups(self) -> dict[str, tuple[list[str], Indices]]:
        """The groups that have been asked for."""
        return {}

    def _grouped(self, over: str) -> tuple[list[str], Indices]:
        """Return groups in the order of their first rows; rows that are alike are named once."""
        alike = equal_rows(self._keys(over), len(self))
        _, first = np.unique(alike, return_index=True)
        names = [self._group_name(over, int(k)) for k in first]
        in_order = dict.fromkeys(names[k] for k in np.argsort(first))  # some have the same name
        number = {name: k for k, name in enumerate(in_order)}
        return [*number], np.array([number[name] for name in names], dtype=np.intp)[alike]

    def _keys(self, over: str) -> list[FloatArray]:
        """Return numbers that are equal in rows of one group, each of shape (N,)."""
        if over == "rows":
            return [as_floats(self.rows)]
        if over == "dR":
            return [self.columns["dR"]]
        if over == "pair":
            return [*self._keys("material"), self.columns["dR"]]
        keys = []
        for words in (words for name, words in self.data.labels.items() if name.startswith(over)):
            number = {word: k for k, word in enumerate(dict.fromkeys(words))}
            keys.append(as_floats([number[word] for word in words])[self.rows % len(words)])
        return keys or [self.columns["E_i"], self.columns["E_j"]]

    def duplicates(self) -> list[list[int | str]]:
        """Return the positions of identical rows, one list for each group of them."""
        alike = sorted(self._alike(*self.columns), key=lambda rows: int(rows[0]))
        return [[self.line(k) for k in rows] for rows in alike]

    def _alike(self, *names: str) -> list[Indices]:
        """Return the indices of rows that are equal in some columns, two or more of them."""
        keys = [self.columns[name] for name in names if name in self.columns]
        alike = equal_rows(keys, len(self))
        order = np.argsort(alike, kind="stable")
        parts = np.split(order, np.flatnonzero(np.diff(alike[order])) + 1)
        return [rows for rows in parts if rows.size > 1]

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
    data: Source | Sequence[Source],
    contact: Contact,
    constants: Constants | None = None,
    materials: Path | None = None,
    spec: TableSpec = _DEFAULT,
) -> MeasuredData:
    """Read files or DataFrames of measurements into columns; `measurements_of` checks them.

    Several tables have each their own layout and units, and the label `file` names them.
    """
    tables = [*data] if isinstance(data, list | tuple) else [cast("Source", data)]
    if len(tables) == 1:
        return _measured_of(read_readings(tables[0], spec), contact, constants, materials, spec)
    names = file_names(tables)
    specs = _specs(spec, names)
    every = [_one_of_several(*each) for each in zip(tables, specs, strict=True)]
    for name in set[str].intersection(*(readings.absent for readings in every)):
        rule, remedy = "is a column of none of the tables", "check its name"
        raise InputError(", ".join(names), "columns", name, rule, remedy)
    units = {
        name: c[1].symbol for name, x in zip(names, every, strict=True) if (c := load_column(x))
    }
    if spec.loads is not None and len({*units.values()}) > 1:
        of_each = ", ".join(f"{name} in {unit}" for name, unit in units.items())
        rule, remedy = f"has no one unit: loads of {of_each}", "leave it out, and --exclude rows"
        raise InputError("--loads", "", spec.loads, rule, remedy)
    parts = [
        _measured_of(readings, contact, constants, materials, each)
        for readings, each in zip(every, specs, strict=True)
    ]
    return _joined(dict(zip(names, parts, strict=True)), spec)


def _one_of_several(table: Source, spec: TableSpec) -> Readings:
    """Return the readings of one of several tables.

    A sheet is that of workbooks. A mark of decimals is that of tables which need it: one whose
    numbers show another mark by themselves has that.
    """
    if isinstance(table, str | Path) and not str(table).lower().endswith((".xlsx", ".xlsm")):
        spec = spec.model_copy(update={"sheet": None})
    try:
        return read_readings(table, spec, may_lack=True)
    except InputError:
        if spec.decimal is not None:
            with suppress(InputError):
                by_itself = spec.model_copy(update={"decimal": None})
                return read_readings(table, by_itself, may_lack=True)
        raise


def file_names(tables: Sequence[Source]) -> list[str]:
    """Return a name for each of several tables: that of its file, or its whole path.

    Raises
    ------
    InputError
        If a file is given twice.
    """
    is_file = [isinstance(table, str | Path) for table in tables]
    short = [
        Path(str(table)).name if known else f"DataFrame {k}"
        for k, (table, known) in enumerate(zip(tables, is_file, strict=True), start=1)
    ]
    names = [
        str(table) if known and short.count(name) > 1 else name
        for table, known, name in zip(tables, is_file, short, strict=True)
    ]
    for name in names:
        if names.count(name) > 1:
            raise InputError(name, "", None, "is given twice", "give each table once")
    return names


def _specs(spec: TableSpec, names: Sequence[str]) -> list[TableSpec]:
    """Return what is to be read of each of several tables: rows are excluded of one of them."""
    excluded: dict[str, list[str]] = {name: [] for name in names}
    for text in spec.exclude or ():
        file, _, line = text.rpartition(":")
        if file not in names:
            rule = f"is not a row of {' or of '.join(names)}"
            remedy = f"name the file and the line, as {names[-1]}:{line or 12}"
            raise InputError("exclude", "", text, rule, remedy)
        excluded[file].append(line)
    group = None if spec.group == _FILE else spec.group
    return [
        spec.model_copy(update={"exclude": tuple(excluded[name]), "group": group}) for name in names
    ]


def _joined(parts: Mapping[str, MeasuredData], spec: TableSpec) -> MeasuredData:
    """Return several tables as one, whose quantities must be the same."""
    names, every = [*parts], [*parts.values()]
    notes = list(dict.fromkeys(note for part in every for note in part.notes))
    read = [line for part in every for line in part.read]
    numbers, labels = {*every[0].numbers}, {*every[0].labels}
    for name, part in parts.items():
        differ = (numbers ^ {*part.numbers}) - {"time"}
        differ |= {"group"} & (labels ^ {*part.labels})
        if differ:
            quantity = min(differ)
            has = quantity in part.numbers or quantity in part.labels
            lacking, other = (names[0], name) if has else (name, names[0])
            remedy = "add it, or leave it out of the others with --ignore"
            raise InputError(lacking, quantity, None, f"is not given, and {other} has it", remedy)
    if any("time" in part.numbers for part in every) and not all(
        "time" in part.numbers for part in every
    ):
        read.append("left out: the times, which not all files have")
    files = [name for name, part in parts.items() for _ in part.lines]
    in_all = set[str].intersection(*({*part.labels} for part in every))
    words = {key: _stacked(every, [part.labels[key] for part in every]) for key in in_all}
    if any("branch" in part.labels for part in every):
        branches = [part.labels.get("branch", [BRANCHES[0]]) for part in every]
        words["branch"] = _stacked(every, branches)
    words[_FILE] = files
    if spec.group == _FILE:
        words["group"] = files
    else:
        read.append(f"{len(names)} files (--group {_FILE} takes each as a series)")
    row_words = {part.row_word for part in every}
    return MeasuredData(
        source=", ".join(names),
        sha256=", ".join(part.sha256 for part in every),
        contact=every[0].contact,
        row_word=row_words.pop() if len(row_words) == 1 else "row",
        lines=[f"{name}:{line}" for name, part in parts.items() for line in part.lines],
        numbers={
            key: _stacked(every, [part.numbers[key] for part in every])
            for key in every[0].numbers
            if all(key in part.numbers for part in every)
        },
        labels=words,
        notes=notes,
        read=read,
        unused=[name for name in every[0].unused if all(name in part.unused for part in every)],
        units={
            quantity: unit
            for quantity, unit in every[0].units.items()
            if all(part.units.get(quantity) == unit for part in every)
        },
    )


def _stacked(parts: Sequence[MeasuredData], columns: Sequence[list[Any]]) -> list[Any]:
    """Return a column of all parts; a single value if it is the same in all."""
    if all(len(column) == 1 and column == columns[0] for column in columns):
        return columns[0]
    return [
        value
        for part, column in zip(parts, columns, strict=True)
        for value in (column * len(part.lines) if len(column) == 1 else column)
    ]


def _measured_of(
    readings: Readings,
    contact: Contact,
    constants: Constants | None,
    materials: Path | None,
    spec: TableSpec,
) -> MeasuredData:
    """Return the readings of one table with its constants, without the rows that are not kept."""
    keep_loads(readings, spec.loads)
    sheet, source = readings.sheet, readings.sheet.source
    numbers, labels = readings.numbers, readings.labels
    columns = [*readings.columns.values()]
    columns += _add_constants(source, constants or {}, numbers, labels)
    _require_all(readings, contact)
    notes = _add_moduli(source, numbers, labels, materials, contact)
    _divide_by_length(numbers, sorted(c.quantity for c in columns if c.is_total))
    for name, column in numbers.items():
        wrong = np.flatnonzero(~np.isfinite(column))
        if wrong.size:
            line = f", {sheet.row_word} {sheet.lines[wrong[0]]}" if column.size > 1 else ""
            remedy = "correct it, and check the unit in the column's name"
            raise InputError(f"{source}{line}", name, None, "is too large", remedy)
    kept = kept_rows(sheet, numbers, labels, spec.branch)
    return MeasuredData(
        source=Path(source).name,
        sha256=sheet.sha256,
        contact=contact,
        row_word=sheet.row_word,
        lines=np.array(sheet.lines)[kept].tolist(),
        numbers={name: _taken(column, kept).tolist() for name, column in numbers.items()},
        labels={
            name: _taken(np.array(column, object), kept).tolist() for name, column in labels.items()
        },
        notes=notes,
        read=readings.block(kept.tolist()),
        unused=readings.unused(kept.tolist()),
        units={c.quantity: c.unit for c in columns if c.quantity in MEASURED},
    )


def _taken(column: NDArray[Any], kept: Indices) -> NDArray[Any]:
    """Return some rows of a column, which may be one of a single value for all rows."""
    return column if column.size == 1 else column[kept]


# --- constants, materials and lengths -----------------------------------------------------------


def _add_constants(
    source: str, constants: Constants, numbers: _Numbers, labels: _Labels
) -> list[Column]:
    """Add the constants as columns of one row; return their columns."""
    columns = []
    for name, value in constants.items():
        key, column = f"constants.{name}", column_named(name)
        if column is None or column.quantity in (*MEASURED, "time", "group"):
            remedy = "give e.g. E_GPa, nu, material, dR_um, R_i_mm, length_mm"
            raise InputError(source, key, value, "is not a known constant", remedy)
        quantity = column.quantity
        if quantity in numbers or quantity in labels:
            rule = f"{quantity} is given twice, here and as a column or constant"
            remedy = "keep one of them; --ignore leaves a column out"
            raise InputError(source, key, value, rule, remedy)
        if isinstance(value, str) != (quantity in LABELS) or isinstance(value, bool):
            rule = "must be a name" if quantity in LABELS else "must be a number"
            raise InputError(source, key, value, rule, "correct it")
        if isinstance(value, str):
            labels[quantity] = [value]
        else:
            allowed = _RANGES[f"{quantity}_i" if quantity in ("E", "nu") else quantity]
            numbers[quantity] = np.array([value * column.factor])
            if not (allowed.allows(numbers[quantity]) & np.isfinite(numbers[quantity])).all():
                raise InputError(source, key, value, allowed.rule, "correct it; mind its unit")
        columns.append(column)
    return columns


class MissingInputError(InputError):
    """What a table and the options lack, all at once.

    Parameters
    ----------
    source : str
        The table.
    lacks : mapping
        What is missing, with an option that gives it.
    more : str
        What else would help.
    """

    def __init__(self, source: str, lacks: Mapping[str, str], more: str) -> None:
        self.lacks, self.more = dict(lacks), more
        options = " ".join(filter(None, lacks.values()))
        rule, remedy = f"lacks {listed(lacks, 'and')}", f"add your own, e.g. {options}{more}"
        super().__init__(source, "", None, rule, remedy)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle what it was made of."""
        return (type(self), (self.source, self.lacks, self.more))


def _require_all(readings: Readings, contact: Contact) -> None:
    """Raise `InputError` for what is given nowhere, all at once if it is more than a column."""
    sheet, given = readings.sheet, {*readings.numbers, *readings.labels}
    for quantity, error in readings.unclear.items():
        alternatives = next((group for group in _ALTERNATIVES if quantity in group), {quantity})
        if quantity != "length" and not alternatives & given:
            raise error
    missing = [quantity for quantity in MEASURED if quantity not in given]
    offered = _options(readings, missing)
    if missing and not sheet.names:
        remedy = f"say what its {len(sheet.columns)} columns are, e.g. {' '.join(offered)}"
        rule = "has no row of names"
        raise InputError(sheet.source, "", None, rule, f"{remedy}, or give it a line of names")
    names = [repr(sheet.name(k)) for k in readings.unread]
    named = f"name {'one of ' if len(names) > 1 else ''}{first_of(names, _LISTED)}"
    lacks = dict(zip((f"the {quantity}" for quantity in missing), offered, strict=False))
    lacks |= dict.fromkeys((f"the {quantity}" for quantity in missing[len(offered) :]), "")
    of_pair = _lacks_of_pair(readings, contact)
    if len(missing) == 1 and not of_pair:
        others = f", or {named} with {offered[0]}" if offered else ""
        remedy = f"add {spellings(missing[0])}{others}"
        raise InputError(sheet.source, missing[0], None, "is required", remedy)
    if not lacks | of_pair:
        return
    unread = f"; not read: {first_of(names, _LISTED)}" if lacks and names else ""
    examples = {"the length": "length_mm", "the radii": "dR_um", "the other radius": "R_j_mm"}
    columns = [examples.get(what, "material_i, material_j") for what in of_pair]
    more = f", or columns or [constants] {', '.join(columns)}" if columns else ""
    raise MissingInputError(sheet.source, lacks | of_pair, more + unread)


def _lacks_of_pair(readings: Readings, contact: Contact) -> dict[str, str]:
    """Return what is not given of the pair, with options that give it."""
    given, numbers = {*readings.numbers, *readings.labels}, readings.numbers
    lacks = {}
    bodies = [
        body
        for body in "ij"
        if not {f"{name}{of}" for name in ("E", "nu", "material") for of in ("", f"_{body}")}
        & given
    ]
    if len(bodies) == 2:
        lacks["the materials"] = "--material 'low-carbon steel'"
    for body in bodies if len(bodies) == 1 else ():
        role = roles(contact)["ij".index(body)]
        option = f"--{role}" if contact == "internal" else f"--material-{body}"
        lacks[f"the material of the {role}"] = f"{option} 'low-carbon steel'"
    radii = [name for name in ("dR", "R_i", "R_j") if name in numbers]
    if not radii:
        lacks["the radii"] = f"--Ri 10 --Rj {9.97 if contact == 'internal' else 20}"
    elif radii == ["R_i"]:
        share = 0.997 if contact == "internal" else 2
        lacks["the other radius"] = f"--Rj {share * float(np.min(numbers['R_i'])):.4g}"
    elif radii == ["R_j"]:
        share = 1.003 if contact == "internal" else 2
        lacks["the other radius"] = f"--Ri {share * float(np.max(numbers['R_j'])):.4g}"
    if "length" not in given and any(c.is_total for c in readings.columns.values()):
        lacks["the length"] = "--length 20"
    return lacks


def _options(readings: Readings, missing: Sequence[str]) -> list[str]:
    """Return options that name a column for each missing quantity, of its unit if there is one."""
    options, free = [], readings.unread
    for quantity in missing if free else ():
        offers = {k: option_for(readings.sheet, quantity, k) for k in free}
        k = min(free, key=lambda k: "_UNIT=" in offers[k])
        options.append(offers[k])
        free = [other for other in free if other != k] or free
    return options


def _add_moduli(
    source: str, numbers: _Numbers, labels: _Labels, own: Path | None, contact: Contact
) -> list[str]:
    """Replace E and ν by those of each body; return notes on the provenance of materials."""
    of_materials = [name for name in labels if name.startswith("material")]
    rows = known_materials(own) if of_materials else {}
    table = _SHIPPED if own is None else own.name
    for name in of_materials:
        spelt = {
            word: find_material(word, rows, source, name, table).material.name
            for word in set(labels[name])
        }
        labels[name] = [spelt[word] for word in labels[name]]
    used = {word for name in of_materials for word in labels[name]}
    moduli = {body: _moduli(body, source, numbers, labels, rows, contact) for body in "ij"}
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


def pair_notes(measured: Measurements, own: Path | None, housing: Housing | None) -> list[str]:
    """Return what is to be noted on the pairs: lengths hardly meant, and loads above yield."""
    return [*unusual_lengths(measured.pair), *_yield_notes(measured, own, housing)]


def _yield_notes(measured: Measurements, own: Path | None, housing: Housing | None) -> list[str]:
    """Return a note if loads are above first yield, where materials and radii are known."""
    labels = measured.data.labels
    of_both = labels.get("material")
    holes, pins = labels.get("material_i", of_both), labels.get("material_j", of_both)
    layers = [] if housing is None else [material.yield_stress for material, _ in housing.layers]
    if holes is None or pins is None or "R_i" not in measured.columns or None in layers:
        return []
    size = len(measured)
    names = np.stack([np.broadcast_to(words, size) for words in (holes, pins)], axis=1)
    rows, above = known_materials(own), 0
    for words in np.unique(names, axis=0):
        part = measured.take(np.flatnonzero((names == words).all(axis=1)))
        hole, pin = (rows[word].material for word in words)
        if hole.yield_stress is not None and pin.yield_stress is not None:
            sizes = [part.columns[name] for name in ("dR", "R_i", "R_j")]
            alike = equal_rows(sizes, len(part))
            _, first = np.unique(alike, return_index=True)
            pair = replace(part.take(first).pair, material_i=hole, material_j=pin)
            largest = limits.yield_load(pair, housing=housing)
            above += int(np.count_nonzero(part.load > largest[alike]))
    if not above:
        return []
    return [
        f"{above} of {size} loads are above first yield by von Mises, with the yield "
        "stresses of the table of materials, and the law is elastic"
    ]


def _moduli(
    body: str, source: str, numbers: _Numbers, labels: _Labels, rows: _Materials, contact: Contact
) -> tuple[FloatArray, FloatArray]:
    """Return E in MPa and ν of one body, given exactly once, by name or by number."""
    named = [name for name in (f"material_{body}", "material") if name in labels]
    pairs = [(f"E{b}", f"nu{b}") for b in (f"_{body}", "") if {f"E{b}", f"nu{b}"} & {*numbers}]
    if len(named) + len(pairs) != 1:
        role, given = roles(contact)["ij".index(body)], [*named, *chain.from_iterable(pairs)]
        rule = f"must be given once, and {', '.join(given)} are given"
        remedy = "keep one of them; --ignore leaves a column out"
        raise InputError(source, f"material of the {role}", None, rule, remedy)
    if pairs:
        _require_given(source, pairs[0], numbers)
        E, nu = pairs[0]
        return numbers[E], numbers[nu]
    materials = [rows[word].material for word in labels[named[0]]]
    return np.array([m.E for m in materials], float), np.array([m.nu for m in materials], float)


def _divide_by_length(numbers: _Numbers, totals: Sequence[str]) -> None:
    """Turn total forces into loads per unit length."""
    for quantity in totals:
        # A length of 0 is refused later, with the row that has it.
        length = np.where(numbers["length"] == 0, 1.0, numbers["length"])
        numbers[quantity] = numbers[quantity] / length


# --- from columns to checked arrays -------------------------------------------------------------


def measurements_of(data: MeasuredData, source: str) -> Measurements:
    """Check columns row by row and return the measurements."""
    size = len(data.lines)
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


def _require_given(source: str, names: Sequence[str], columns: _Numbers) -> None:
    """Raise `InputError` for the first column that is missing."""
    for name in names:
        if name not in columns:
            raise InputError(source, name, None, "is required", f"add {spellings(name)}")


def _require(
    data: MeasuredData,
    source: str,
    name: str,
    values: FloatArray,
    allowed: _Range,
    remedy: str = "correct or remove the row, and check the unit in the column's name",
) -> None:
    """Raise `InputError` for the first row with a value that is not allowed."""
    wrong = np.flatnonzero(~(allowed.allows(values) & np.isfinite(values)))
    if wrong.size:
        first = int(wrong[0])
        where = f"{source}, {data.row_word} {data.lines[first]}"
        more = f" ({wrong.size - 1} more like it)" if wrong.size > 1 else ""
        raise InputError(where, name, float(values[first]), allowed.rule, f"{remedy}{more}")


def require_positive_penetration(measured: Measurements, source: str, remedy: str) -> None:
    """Raise `InputError` for the first row whose penetration is not positive."""
    _require(measured.data, source, "penetration", measured.penetration, _POSITIVE, remedy)


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
    wrong = np.flatnonzero(~(values > 0))
    if wrong.size:
        k = int(wrong[0])
        first, second = roles(data.contact)
        words = {"dR": "ΔR", "R_i": f"the {first}'s radius", "R_j": f"the {second}'s radius"}
        texts = [f"{words[key]} = {columns[key][k]:g} mm" for key in given]
        if name == "dR":
            rule, remedy = " is not above ".join(texts), "exchange them, or correct one"
        else:
            rule = f"{' and '.join(texts)} leave {words[name]} = {values[k]:g} mm"
            remedy = "correct one of them"
        of_all = all(len(data.numbers[key]) == 1 for key in given)
        where = source if of_all else f"{source}, {data.row_word} {data.lines[k]}"
        remedy += "; both are radii in mm, no diameters"
        raise InputError(where, ", ".join(given), None, rule, remedy)
    columns[name] = values
