"""The table of materials: values with, beside each, where it comes from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

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
        If the file cannot be read, a column is missing or unknown, a number is not one, a
        provenance is not among the three, or a name stands twice.
    """
    source = str(path)
    table = _read_csv(source)
    missing = [column for column in COLUMNS if column not in table.columns]
    if missing:
        raise InputError(
            source, ", ".join(missing), None, "missing columns", f"give {', '.join(COLUMNS)}"
        )
    rows: dict[str, MaterialRow] = {}
    for number, (_, row) in enumerate(table.iterrows(), start=2):
        parsed = _parse_row(f"{source}, line {number}", row.to_dict())
        if parsed.material.name in rows:
            raise InputError(
                f"{source}, line {number}",
                "name",
                parsed.material.name,
                "stands twice",
                "give each material a name of its own",
            )
        rows[parsed.material.name] = parsed
    return rows


def _read_csv(source: str) -> pd.DataFrame:
    """Read the file as text cells, blank cells as empty strings."""
    try:
        return pd.read_csv(source, dtype=str, keep_default_na=False)
    except (OSError, UnicodeDecodeError, pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(
            source, "", None, f"cannot be read ({reason})", "give a CSV table of materials"
        ) from error


def _parse_row(source: str, row: dict[Any, Any]) -> MaterialRow:
    """Turn the text cells of one row into a material with its provenance."""
    numbers = {column: _number(source, column, row[column]) for column in NUMBER_COLUMNS}
    yield_text = row["yield_stress_MPa"].strip()
    yield_stress = _number(source, "yield_stress_MPa", yield_text) if yield_text else None
    provenance = {}
    for column, origin in (NUMBER_COLUMNS | YIELD_COLUMNS).items():
        if row[column].strip():
            provenance[column] = _provenance(source, origin, row[origin])
    try:
        material = Material(row["name"], numbers["E_GPa"] * 1e3, numbers["nu"], yield_stress)
    except InputError as error:
        raise InputError(
            source, error.key, error.value, error.rule, "mind the unit in the column's name"
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


def _provenance(source: str, column: str, text: str) -> str:
    """Return the cell as one of the three provenances."""
    if text not in PROVENANCES:
        raise InputError(
            source, column, text, f"must be one of {', '.join(PROVENANCES)}", "say which"
        )
    return text
