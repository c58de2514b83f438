"""Linear elastic, isotropic materials, and tables of them."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cylcontact.arrays import (
    FloatArray,
    as_floats,
    as_numbers,
    own_arrays,
    require,
    require_one_shape,
    same_fields,
)
from cylcontact.errors import InputError
from cylcontact.html_repr import table_html
from cylcontact.reading import SPEC_BYTES, plain_number, read_text
from cylcontact.units import QUANTITIES

__all__ = [
    "COLUMNS",
    "PROVENANCES",
    "SHIPPED",
    "Material",
    "MaterialRow",
    "known_materials",
    "material_in_MPa",
    "modulus_in_MPa",
    "read_materials",
    "shipped_materials",
]

PROVENANCES = ("paper", "derived", "assumed")
_NUMBER_COLUMNS = {"E_GPa": "E_provenance", "nu": "nu_provenance"}
_YIELD_COLUMNS = {"yield_stress_MPa": "yield_provenance"}
COLUMNS = (
    "name",
    *(c for pair in (_NUMBER_COLUMNS | _YIELD_COLUMNS).items() for c in pair),
    "note",
)
# A smaller bare number was probably meant in GPa; stiff plastics begin here.
_SMALLEST_BARE = 1000.0  # MPa
# The table of the package; a table of the user adds to it.
SHIPPED = Path(__file__).parent / "data" / "materials.csv"


@dataclass(frozen=True, eq=False)
class Material:
    """A linear elastic, isotropic material with an optional yield stress.

    Parameters
    ----------
    name : str
        Its name in reports.
    E : float, str or array_like
        Young's modulus in MPa, at least 1000, or a text with its unit, "207 GPa" or "200 MPa";
        kept in MPa. An array describes a family of materials and broadcasts with the other
        arguments.
    nu : float or array_like
        Poisson's ratio, from 0 to 0.5.
    yield_stress : float, optional
        Yield stress (tensile strength for brittle materials) in MPa.

    Raises
    ------
    InputError
        If a modulus or yield stress is not positive and finite, a bare modulus is below 1000,
        which is hardly meant in MPa, a unit is not known, or ν is outside [0, 0.5].

    Examples
    --------
    >>> steel = Material("steel", E=207e3, nu=0.3, yield_stress=250)
    >>> print(f"{steel.plane_strain_modulus:.1f} MPa")
    227472.5 MPa
    >>> Material("LDPE", E="200 MPa", nu=0.45).E
    200.0
    """

    name: str
    E: float | FloatArray
    nu: float | FloatArray
    yield_stress: float | None = None

    if TYPE_CHECKING:

        def __init__(
            self,
            name: str,
            E: float | str | FloatArray,
            nu: float | FloatArray,
            yield_stress: float | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        E = modulus_in_MPa(self.E, f"Material {self.name!r}")
        object.__setattr__(self, "E", E)
        self._check()

    def _check(self) -> None:
        """Raise `InputError` for a value out of its range; own the arrays."""
        source = f"Material {self.name!r}"
        ratio = as_numbers(self.nu, source, "nu")
        require_one_shape(source, E=as_numbers(self.E, source, "E"), nu=ratio)
        _require_modulus(self.E, source, "E")
        require(
            (ratio >= 0) & (ratio <= 0.5),
            source,
            "nu",
            self.nu,
            "Poisson's ratio must lie in [0, 0.5]",
            "give e.g. 0.3 for steel",
        )
        if self.yield_stress is not None:
            stress = as_numbers(self.yield_stress, source, "yield_stress")
            require(
                (stress > 0) & np.isfinite(stress),
                source,
                "yield_stress",
                self.yield_stress,
                "yield stress must be positive and finite",
                "give it in MPa, or leave it out",
            )
        own_arrays(self)

    @classmethod
    def named(cls, name: str) -> Material:
        """Return a material of the package's table.

        Parameters
        ----------
        name : str
            Its name in the table; `shipped_materials` lists the names, with the provenance of
            each number.

        Returns
        -------
        Material

        Raises
        ------
        InputError
            If the table has no such material.

        Examples
        --------
        >>> Material.named("low-carbon steel")
        Material(name='low-carbon steel', E=200000.0, nu=0.3, yield_stress=250.0)
        """
        rows = shipped_materials()
        if name not in rows:
            raise InputError(
                "Material.named",
                "name",
                name,
                "no material that ships has this name",
                f"choose {', '.join(rows)}, or give Material(name, E, nu)",
            )
        return rows[name].material

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other)

    __hash__ = None  # type: ignore[assignment]

    def _repr_html_(self) -> str:
        rows = {"E (MPa)": self.E, "ν (-)": self.nu, "yield stress (MPa)": self.yield_stress}
        return table_html(f"Material {self.name}", rows)

    @property
    def plane_strain_modulus(self) -> FloatArray:
        """E/(1 − ν²) in MPa."""
        modulus, ratio = as_floats(self.E), as_floats(self.nu)
        return modulus / (1 - ratio**2)


def material_in_MPa(
    name: str,
    E: float | FloatArray,
    nu: float | FloatArray,
    yield_stress: float | None = None,
) -> Material:
    """Return a material whose modulus is known to be in MPa, however small.

    For values from tables and files that name their unit, and for normalised pairs with E* = 1.

    Examples
    --------
    >>> material_in_MPa("of unit modulus", 1.0, 0.0).plane_strain_modulus
    np.float64(1.0)
    """
    material = object.__new__(Material)
    fields = {"name": name, "E": E, "nu": nu, "yield_stress": yield_stress}
    for field, value in fields.items():
        object.__setattr__(material, field, value)
    material._check()
    return material


def modulus_in_MPa(E: float | str | FloatArray, source: str, key: str = "E") -> float | FloatArray:
    """Return Young's modulus in MPa from a number in MPa, or from a text with a unit.

    Parameters
    ----------
    E : float, str or array of float
        A number, "207 GPa", or "207000", which is a bare number too.
    source, key : str
        For errors.

    Raises
    ------
    InputError
        If a bare number is below 1000 MPa, or the text is not a positive number with a unit.

    Examples
    --------
    >>> modulus_in_MPa("207 GPa", "example")
    207000.0
    """
    unit = ""
    number: float | FloatArray
    if isinstance(E, str):
        number, unit = _with_unit(E, source, key)
    else:
        number = E
    _require_modulus(number, source, key, E)
    if unit:
        return number * QUANTITIES["E"][unit]
    smallest = np.min(as_floats(number))
    meant = f'did you mean "{smallest:g} GPa"? For a material as soft as that write'
    require(
        smallest >= _SMALLEST_BARE,
        source,
        key,
        E,
        "a bare number is in MPa",
        f'{meant} "{smallest:g} MPa"' + (", one Material each" if np.ndim(number) else ""),
    )
    return number


def _with_unit(text: str, source: str, key: str) -> tuple[float, str]:
    """Return the number and the unit of a text; no unit for a bare number."""
    match = re.fullmatch(r"\s*(\S+?)\s*([GM]?Pa)?\s*", text)
    try:
        return plain_number(match[1] if match else text), (match[2] or "" if match else "")
    except ValueError:
        raise InputError(
            source, key, text, "must be a number with a unit", 'write e.g. "207 GPa" or "200 MPa"'
        ) from None


def _require_modulus(E: float | FloatArray, source: str, key: str, given: object = None) -> None:
    """Raise `InputError` unless E is positive and finite."""
    modulus = as_numbers(E, source, key)
    require(
        (modulus > 0) & np.isfinite(modulus),
        source,
        key,
        E if given is None else given,
        "Young's modulus must be positive and finite",
        "give it in MPa, e.g. 207e3 for steel",
    )


@dataclass(frozen=True)
class MaterialRow:
    """One row of the table: a material and the provenance of each of its numbers."""

    material: Material
    provenance: dict[str, str]
    note: str


def shipped_materials() -> dict[str, MaterialRow]:
    """Return the package's table of materials.

    Examples
    --------
    >>> shipped_materials()["aluminium alloy"].provenance["E_GPa"]
    'derived'
    """
    return read_materials(SHIPPED)


def known_materials(own: Path | str | None = None) -> dict[str, MaterialRow]:
    """Return the package's materials together with those of your own table.

    Parameters
    ----------
    own : path, optional
        A table as `read_materials` reads it.

    Returns
    -------
    dict
        Rows by the name of the material, those of the package first.

    Raises
    ------
    InputError
        If the table is wrong, or one of its names is already in the package's table.
    """
    rows = shipped_materials()
    if own is None:
        return rows
    added = read_materials(own)
    for name in added:
        if name in rows:
            raise InputError(
                str(own),
                "name",
                name,
                "is the name of a material that ships with the package",
                "choose another name",
            )
    return rows | added


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
        Rows by the name of the material, in the order of the file.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing or unknown, a row is too short or too
        long, a cell is not a number, a provenance is not one of the three, or a name is repeated.
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
                "is used twice",
                "give each material a name of its own",
            )
        rows[parsed.material.name] = parsed
    if not rows:
        raise InputError(source, "", None, "holds no material", "give it at least one row")
    return rows


def _read_csv(source: str) -> list[tuple[int, dict[str, str]]]:
    """Return each row as its line number and its text cells by column."""
    wanted = "give a CSV table of materials"
    text = read_text(source, SPEC_BYTES, wanted, wanted)
    try:
        reader = csv.reader(io.StringIO(text, newline=""), strict=True)
        table = [(reader.line_num, cells) for cells in reader if any(cells)]
    except csv.Error as error:
        raise InputError(source, "", None, f"cannot be read ({error})", wanted) from error
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
        for column in (*_NUMBER_COLUMNS, *_YIELD_COLUMNS)
        if column in _NUMBER_COLUMNS or row[column]
    }
    provenance = {
        column: _provenance(source, (_NUMBER_COLUMNS | _YIELD_COLUMNS)[column], row)
        for column in numbers
    }
    try:
        material = material_in_MPa(
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
        return plain_number(text)
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
