"""The table of materials: values with, beside each, where it comes from."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

from cylcontact.errors import InputError
from cylcontact.materials import Material

PROVENANCES = ("paper", "derived", "assumed")
NUMBER_COLUMNS = {"E_GPa": "E_provenance", "nu": "nu_provenance"}
YIELD_COLUMNS = {"yield_stress_MPa": "yield_provenance"}
COLUMNS = (
    "name",
    *(c for pair in (NUMBER_COLUMNS | YIELD_COLUMNS).items() for c in pair),
    "note",
)


@dataclass(frozen=True)
class MaterialRow:
    """One row of the table: a material and the provenance of each of its numbers."""

    material: Material
    provenance: dict[str, str]
    note: str


def read_materials(path: Path | str) -> dict[str, MaterialRow]:
    """Read a table of materials.

    Parameters
    ----------
    path : path
        A CSV file with the columns `COLUMNS`: E in GPa, yield stress in MPa (may be empty),
        and for each number "paper", "derived" or "assumed".

    Returns
    -------
    dict
        From the material's name to its row, in the order of the file.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing or unknown, a row is too short or too
        long, a number is not one, a provenance is not among the three, or a name stands twice.
    """
    source = str(path)
    rows: dict[str, MaterialRow] = {}
    for line, row in _read_csv(source):
        parsed = _parse_row(f"{source}, line {line}", row)
        if parsed.material.name in rows:
            raise InputError(
                f"{source}, line {line}",
                "name",
                parsed.material.name,
                "stands twice",
                "give each material a name of its own",
            )
        rows[parsed.material.name] = parsed
    if not rows:
        raise InputError(source, "", None, "holds no material", "give it at least one row")
    return rows


def _read_csv(source: str) -> list[tuple[int, dict[str, str]]]:
    """Read the rows as text cells by column, each with the number of its line."""
    try:
        with Path(source).open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, strict=True)
            table = [(reader.line_num, cells) for cells in reader if any(cells)]
    except (OSError, ValueError, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(
            source, "", None, f"cannot be read ({reason})", "give a CSV table of materials"
        ) from error
    columns = table[0][1] if table else []
    if sorted(columns) != sorted(COLUMNS):
        raise InputError(
            source,
            "columns",
            columns,
            f"must be {', '.join(COLUMNS)}",
            "correct the first line",
        )
    return [(line, _cells(f"{source}, line {line}", columns, cells)) for line, cells in table[1:]]


def _cells(source: str, columns: list[str], cells: list[str]) -> dict[str, str]:
    """Return the cells of a row by column."""
    if len(cells) != len(columns):
        raise InputError(
            source,
            "",
            None,
            f"has {len(cells)} cells for {len(columns)} columns",
            'add commas for empty cells; put a text with commas in "quotes"',
        )
    return {column: cell.strip() for column, cell in zip(columns, cells, strict=True)}


def _parse_row(source: str, row: dict[str, str]) -> MaterialRow:
    """Turn the text cells of one row into a material with its provenance."""
    if not row["name"]:
        raise InputError(source, "name", None, "is required", "name the material")
    numbers = {
        column: _number(source, column, row[column])
        for column in (*NUMBER_COLUMNS, *YIELD_COLUMNS)
        if column in NUMBER_COLUMNS or row[column]
    }
    provenance = {
        column: _provenance(source, (NUMBER_COLUMNS | YIELD_COLUMNS)[column], row)
        for column in numbers
    }
    try:
        material = Material(
            row["name"], numbers["E_GPa"] * 1e3, numbers["nu"], numbers.get("yield_stress_MPa")
        )
    except InputError as error:
        column = {"E": "E_GPa", "yield_stress": "yield_stress_MPa"}.get(error.key, error.key)
        raise InputError(
            source, column, row[column], error.rule, "mind the unit in the column's name"
        ) from error
    return MaterialRow(material, provenance, row["note"])


def _number(source: str, column: str, text: str) -> float:
    """Return the cell as a number."""
    try:
        return float(text)
    except ValueError:
        raise InputError(
            source, column, text, "must be a number", "write it with a decimal point"
        ) from None


def _provenance(source: str, column: str, row: dict[str, str]) -> str:
    """Return the cell as one of the three provenances."""
    if row[column] not in PROVENANCES:
        raise InputError(
            source, column, row[column], f"must be one of {', '.join(PROVENANCES)}", "say which"
        )
    return row[column]
