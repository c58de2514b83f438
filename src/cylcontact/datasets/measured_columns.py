"""The columns of a measured data set in mm, N and MPa, from a table and constants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from pydantic import Field

from cylcontact.arrays import FloatArray
from cylcontact.datasets.measured_table import MeasuredTable, read_table
from cylcontact.errors import InputError
from cylcontact.materials import MaterialRow, known_materials, shipped_materials
from cylcontact.pair import Contact
from cylcontact.spec import Spec
from cylcontact.units import LABELS, column_named, spellings

__all__ = ["Constants", "MeasuredData", "read_measured"]

Constants = Mapping[str, float | str]
_BODIES = ("i", "j")


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


def read_measured(
    path: Path | str,
    contact: Contact,
    constants: Constants | None = None,
    materials: Path | None = None,
    ignored: Sequence[str] = (),
) -> MeasuredData:
    """Read a table of measurements into columns.

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
        If the table or a constant is wrong, a quantity is given twice or not at all, or a material
        is unknown.
    """
    table = read_table(path, ignored)
    numbers = {
        c.quantity: table.numbers[c.quantity] * c.factor
        for c in table.columns
        if c.quantity in table.numbers
    }
    labels = {name: list(words) for name, words in table.labels.items()}
    total = {c.quantity for c in table.columns if c.is_total}
    _add_constants(table, constants or {}, numbers, labels, total)
    notes = _add_materials(table.source, numbers, labels, materials)
    _divide_by_length(table.source, numbers, total)
    return MeasuredData(
        source=Path(table.source).name,
        sha256=table.sha256,
        contact=contact,
        row_word=table.row_word,
        lines=list(table.lines),
        numbers={name: [float(v) for v in np.atleast_1d(c)] for name, c in numbers.items()},
        labels=labels,
        notes=notes,
    )


def _add_constants(
    table: MeasuredTable,
    constants: Constants,
    numbers: dict[str, FloatArray],
    labels: dict[str, list[str]],
    total: set[str],
) -> None:
    """Add the constants as columns of one row."""
    for name, value in constants.items():
        column = column_named(name)
        if column is None or column.quantity in ("load", "penetration", "weight", "group"):
            raise InputError(
                table.source,
                f"constants.{name}",
                value,
                "is not a known constant",
                "give e.g. E_GPa, nu, material, dR_um, R_i_mm, length_mm",
            )
        if column.quantity in numbers or column.quantity in labels:
            raise InputError(
                table.source,
                f"constants.{name}",
                value,
                f"{column.quantity} is given twice, here and as a column or constant",
                "keep one of them",
            )
        if isinstance(value, str) != (column.quantity in LABELS) or isinstance(value, bool):
            rule = "must be a name" if column.quantity in LABELS else "must be a number"
            raise InputError(table.source, f"constants.{name}", value, rule, "correct it")
        if isinstance(value, str):
            labels[column.quantity] = [value]
        else:
            numbers[column.quantity] = np.array([value * column.factor])
            total |= {column.quantity} if column.is_total else set()


def _divide_by_length(source: str, numbers: dict[str, FloatArray], total: set[str]) -> None:
    """Turn total forces into loads per unit length."""
    for quantity in sorted(total):
        if "length" not in numbers:
            raise InputError(
                source,
                quantity,
                None,
                "is a total force, and the axial length is not given",
                f"add {spellings('length')}, or give the load per unit length",
            )
        with np.errstate(divide="ignore", invalid="ignore"):  # a length of 0 is refused later
            numbers[quantity] = numbers[quantity] / numbers["length"]


def _add_materials(
    source: str,
    numbers: dict[str, FloatArray],
    labels: dict[str, list[str]],
    materials: Path | None,
) -> list[str]:
    """Add E and ν of both bodies; return notes on the provenance of named materials."""
    rows: dict[str, MaterialRow] = {}
    if any(name in labels for name in ("material", "material_i", "material_j")):
        rows = known_materials(materials)
    moduli = [_one_body(source, body, numbers, labels, rows, materials) for body in _BODIES]
    for body, (E, nu) in zip(_BODIES, moduli, strict=True):
        numbers[f"E_{body}"], numbers[f"nu_{body}"] = E, nu
    for quantity in ("E", "nu"):
        numbers.pop(quantity, None)
    if not rows:
        return []
    used = {word for name in labels if name.startswith("material") for word in labels[name]}
    shipped = shipped_materials()
    return [
        f"E and ν of {name} are from {_table_of(name in shipped, materials)}: "
        f"E {rows[name].provenance['E_GPa']}, ν {rows[name].provenance['nu']}"
        for name in rows
        if name in used
    ]


def _table_of(ships: bool, own: Path | None) -> str:
    """Return the name of a material's table in notes and errors."""
    return "the table that ships" if ships or own is None else own.name


def _one_body(
    source: str,
    body: str,
    numbers: Mapping[str, FloatArray],
    labels: Mapping[str, list[str]],
    rows: Mapping[str, MaterialRow],
    materials: Path | None,
) -> tuple[FloatArray, FloatArray]:
    """Return E in MPa and ν of one body, given exactly once."""
    by_name = [name for name in (f"material_{body}", "material") if name in labels]
    by_number = [(f"E{b}", f"nu{b}") for b in (f"_{body}", "") if {f"E{b}", f"nu{b}"} & {*numbers}]
    if len(by_name) + len(by_number) != 1:
        given = ", ".join([*by_name, *(key for keys in by_number for key in keys)]) or "nothing"
        raise InputError(
            source,
            f"body {body}",
            None,
            f"must get E and ν from exactly one place, and {given} is given",
            f"give material, material_{body}, E and nu, or E_{body} and nu_{body}",
        )
    if by_number:
        for key in by_number[0]:
            if key not in numbers:
                raise InputError(source, key, None, "is required", f"add {spellings(key)}")
        return numbers[by_number[0][0]], numbers[by_number[0][1]]
    for name in labels[by_name[0]]:
        if name not in rows:
            raise InputError(
                source,
                by_name[0],
                name,
                f"is not in {_table_of(materials is None, materials)}",
                f"choose {', '.join(rows)}, or name a table of your own with --materials",
            )
    bodies = [rows[name].material for name in labels[by_name[0]]]
    return np.array([m.E for m in bodies], float), np.array([m.nu for m in bodies], float)
