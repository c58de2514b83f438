"""Linear elastic, isotropic materials, and tables of them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cylcontact.files.numbers import numbers
from cylcontact.files.reading import beside_or_above, plain_number
from cylcontact.files.sheet import read_sheet
from cylcontact.files.units import QUANTITIES
from cylcontact.support.arrays import (
    FloatArray,
    OfArrays,
    as_floats,
    as_numbers,
    require,
    require_one_shape,
    require_positive,
)
from cylcontact.support.errors import InputError
from cylcontact.support.html_repr import table_html

Number = float | FloatArray

# The largest modulus that is taken, ten times diamond's: what is above was given in Pa.
LARGEST_MODULUS = 1e7  # MPa
# A smaller bare number was probably meant in GPa; stiff plastics begin here.
_SMALLEST_BARE = 1000.0  # MPa
PROVENANCES = ("paper", "derived", "assumed")
# Columns of numbers, and those that say where the numbers come from.
_ORIGINS = {
    "E_GPa": "E_provenance",
    "nu": "nu_provenance",
    "yield_stress_MPa": "yield_provenance",
}
_REQUIRED = ("name", "E_GPa", "nu")
_EXPANSION = "thermal_expansion_per_K"
_MAY_BE_EMPTY = ("yield_stress_MPa", _EXPANSION)
COLUMNS = (
    "name", *(column for pair in _ORIGINS.items() for column in pair), "note", _EXPANSION
)  # fmt: skip
# The table of the package; a table of the user adds to it, by default the one in `_OWN`.
SHIPPED = Path(__file__).parent / "data" / "materials.csv"
_OWN = "datasets/materials.csv"


@dataclass(frozen=True, eq=False)
class Material(OfArrays):
    """A linear elastic, isotropic material with an optional yield stress.

    Parameters
    ----------
    name : str
        Its name in reports.
    E : float, str or array_like
        Young's modulus in MPa, from 1000 to 1e7, or a text with its unit, "207 GPa" or "200 MPa";
        kept in MPa. An array describes a family of materials and broadcasts with the other
        arguments.
    nu : float or array_like
        Poisson's ratio, from 0 to 0.5.
    yield_stress : float, optional
        Yield stress (tensile strength for brittle materials) in MPa.
    thermal_expansion : float, optional
        Coefficient of linear expansion in 1/K, 12e-6 for steel.

    Raises
    ------
    InputError
        If a modulus, yield stress or expansion is not positive and finite, a bare modulus is below
        1000 MPa or any modulus above 1e7 MPa, a unit is unknown, or ν is outside
        [0, 0.5].

    Examples
    --------
    >>> steel = Material("steel", E=207e3, nu=0.3, yield_stress=250)
    >>> print(f"{steel.plane_strain_modulus:.1f} MPa")
    227472.5 MPa
    >>> Material("LDPE", E="200 MPa", nu=0.45).E
    200.0
    """

    name: str
    E: Number
    nu: Number
    yield_stress: float | None = None
    thermal_expansion: float | None = None

    if TYPE_CHECKING:

        def __init__(
            self,
            name: str,
            E: Number | str,
            nu: Number,
            yield_stress: float | None = None,
            thermal_expansion: float | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        object.__setattr__(self, "E", modulus_in_MPa(self.E, f"Material {self.name!r}"))
        self._check()

    def _check(self) -> None:
        """Raise `InputError` for ν or a yield stress out of range; own the arrays."""
        source = f"Material {self.name!r}"
        nu = as_numbers(self.nu, source, "nu")
        require_one_shape(source, E=self.E, nu=nu)
        rule, remedy = "Poisson's ratio must lie in [0, 0.5]", "give e.g. 0.3 for steel"
        require((nu >= 0) & (nu <= 0.5), source, "nu", self.nu, rule, remedy)
        if self.yield_stress is not None:
            key, rule = "yield_stress", "yield stress must be positive and finite"
            remedy = "give it in MPa, or leave it out"
            require_positive(self.yield_stress, source, key, remedy, rule)
        if self.thermal_expansion is not None:
            key, value = "thermal_expansion", self.thermal_expansion
            rule, remedy = "is beyond any material", "give it in 1/K, 12e-6 for steel"
            expansion = require_positive(value, source, key, remedy)
            require(expansion < 1e-3, source, key, value, rule, remedy)
        self._own_arrays()

    @property
    def title(self) -> str:
        """The name, or the modulus of a body without one."""
        if self.name or np.ndim(self.E):
            return self.name
        return f"{float(self.E) / 1e3:.4g} GPa"

    @classmethod
    def named(cls, name: str) -> Material:
        """Return a material of the package's table.

        Parameters
        ----------
        name : str
            Its name in the table, in small or capital letters; `shipped_materials` lists the names,
            with the provenance of each number.

        Raises
        ------
        InputError
            If the table has no such material.

        Examples
        --------
        >>> steel = Material.named("low-carbon steel")
        >>> steel.E, steel.nu, steel.yield_stress, steel.thermal_expansion
        (200000.0, 0.3, 250.0, 1.2e-05)
        """
        table, others = "the table that ships", ", or give Material(name, E, nu)"
        rows = shipped_materials()
        return find_material(name, rows, "Material.named", "name", table, others).material

    def _repr_html_(self) -> str:
        rows = {"E (MPa)": self.E, "ν (-)": self.nu, "yield stress (MPa)": self.yield_stress}
        return table_html(f"Material {self.name}", rows)

    @property
    def plane_strain_modulus(self) -> FloatArray:
        """E/(1 − ν²) in MPa."""
        modulus, ratio = as_floats(self.E), as_floats(self.nu)
        return modulus / (1 - ratio**2)


def material_in_MPa(
    name: str, E: Number, nu: Number, yield_stress: float | None = None
) -> Material:
    """Return a material whose modulus is known to be in MPa, however small."""
    _require_modulus(E, f"Material {name!r}", "E")
    material = object.__new__(Material)
    material.__dict__.update(name=name, E=E, nu=nu, yield_stress=yield_stress)
    material._check()
    return material


def changed(material: Material, **numbers: Number | str | None) -> Material:
    """Return a material with other numbers; a modulus is in MPa, however small."""
    copy = object.__new__(Material)
    copy.__dict__.update(material.__dict__ | numbers)
    copy._check()
    return copy


def scaled(material: Material, factor: Number) -> Material:
    """Return a material whose modulus is that of another times a factor."""
    return changed(material, E=material.E * factor)


def modulus_in_MPa(E: Number | str, source: str, key: str = "E") -> Number:
    """Return Young's modulus in MPa from a number in MPa, or from a text with a unit.

    Refused are bare numbers below 1000 MPa, and all above 1e7 MPa.

    >>> modulus_in_MPa("207 GPa", "example")
    207000.0
    """
    unit = ""
    if isinstance(E, str):
        match = re.fullmatch(r"\s*(\S+?)\s*([GM]?Pa)?\s*", E)
        try:
            number: Number = plain_number(match[1] if match else E)
        except ValueError:
            rule, remedy = "must be a number with a unit", 'write e.g. "207 GPa" or "200 MPa"'
            raise InputError(source, key, E, rule, remedy) from None
        unit = (match and match[2]) or ""
    else:
        number = E
    _require_modulus(number, source, key)
    if unit:
        number = number * QUANTITIES["E"][unit]
    smallest, largest = float(np.min(number)), float(np.max(number))
    if largest > LARGEST_MODULUS:
        rule = "is beyond any material, diamond has 1.2e6 MPa"
        meant = f'did you mean "{largest * 1e-9:g} GPa"? Give it in MPa'
        raise InputError(source, key, E, rule, "mind the unit" if unit else meant)
    if not unit and smallest < _SMALLEST_BARE:
        remedy = f'did you mean "{smallest:g} GPa"? For a material as soft as that write '
        remedy += f'"{smallest:g} MPa"' + (", one Material each" if np.ndim(number) else "")
        raise InputError(source, key, E, "a bare number is in MPa", remedy)
    return number


def _require_modulus(E: Number, source: str, key: str) -> None:
    rule = "Young's modulus must be positive and finite"
    require_positive(E, source, key, "give it in MPa, e.g. 207e3 for steel", rule)


@dataclass(frozen=True)
class MaterialRow:
    """One row of the table: a material and the provenance of each of its numbers."""

    material: Material
    provenance: dict[str, str]
    note: str


def shipped_materials() -> dict[str, MaterialRow]:
    """Return the package's table of materials."""
    return dict(_read_once(SHIPPED, 0))


@lru_cache(maxsize=8)
def _read_once(path: Path, changed: int) -> dict[str, MaterialRow]:  # noqa: ARG001
    """Return a table of materials, read again when it has changed."""
    return read_materials(path)


def known_materials(own: Path | str | None = None) -> dict[str, MaterialRow]:
    """Return the package's materials, followed by those of a user's table."""
    rows = shipped_materials()
    shipped = {_plain(name) for name in rows}
    added = {} if own is None else _read_once(Path(own), Path(own).stat().st_mtime_ns)
    for name in added:
        if _plain(name) in shipped:
            rule = "is the name of a material that ships with the package"
            raise InputError(str(own), "name", name, rule, "choose another name")
    return rows | added


def find_material(
    name: str,
    rows: Mapping[str, MaterialRow],
    source: str,
    key: str,
    table: str,
    others: str = ", or name your table with --materials",
) -> MaterialRow:
    """Return the row of a material, whether its name is in small or capital letters."""
    row = rows.get(name) or {_plain(known): row for known, row in rows.items()}.get(_plain(name))
    if row is None:
        remedy = f"choose {', '.join(rows)}{others}"
        raise InputError(source, key, name, f"is not in {table}", remedy)
    return row


# Their table values hold at room temperature.
POLYMERS = ("PEEK", "PTFE", "POM", "PA 6")


def is_known_at(body: Material, warmer: float) -> bool:
    """Return whether the numbers of a material hold; of polymers of the table only at 20 °C."""
    of_table = body.name in POLYMERS and body == shipped_materials()[body.name].material
    return warmer == 0 or not of_table


def require_known_at(body: Material, warmer: float) -> None:
    """Refuse a polymer of the table away from room temperature, where its numbers do not hold."""
    polymer = f"{body.name} is a polymer, whose modulus and yield stress in the table"
    rule = f"{polymer} are those at 20 °C"
    remedy = "in place of its name give its numbers then, '2.5 GPa, 0.38, 60 MPa, 47e-6/K'"
    require(is_known_at(body, warmer), "a joint", "temperature", None, rule, remedy)


def _plain(name: str) -> str:
    """Return a name without capitals and repeated spaces."""
    return " ".join(name.casefold().split())


def own_table(
    given: Path | str | None, folder: Path, source: str, key: str = "materials"
) -> Path | None:
    """Return a user's table of materials: the one given, or the default one if there is any."""
    path = beside_or_above(folder, given or _OWN)
    if given is not None and path is None:
        raise InputError(source, key, str(given), "no such file", "name a table of materials")
    return path


def read_materials(path: Path | str) -> dict[str, MaterialRow]:
    r"""Read a table of materials.

    It has the columns name, E_GPa and nu, in the format of tables of measurements. Optional are
    yield_stress_MPa, thermal_expansion_per_K, a note, and E_provenance, nu_provenance and
    yield_provenance, which are "paper", "derived" or "assumed", the default.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "mine.csv")
    ...     _ = path.write_text("name;E_GPa;nu\nbrass;102,5;0,34\n")
    ...     read_materials(path)["brass"].material
    Material(name='brass', E=102500.0, nu=0.34, yield_stress=None, thermal_expansion=None)
    """
    sheet = read_sheet(path, COLUMNS)
    missing = [name for name in _REQUIRED if name not in sheet.names]
    others = [n for k, n in enumerate(sheet.names) if n not in COLUMNS or n in sheet.names[:k]]
    if missing or others:
        optional = ", ".join(name for name in COLUMNS if name not in _REQUIRED)
        rule, remedy = f"lacks {', '.join(missing)}", f"add it; {optional} may be left out"
        if not missing:
            rule = f"{others[0]!r} is not known, or there twice"
            remedy = f"leave it out; besides {', '.join(_REQUIRED)} there may be {optional}"
        raise InputError(sheet.source, "columns", sheet.names, rule, remedy)
    columns = dict(zip(sheet.names, sheet.columns, strict=True))
    # An empty yield stress or expansion is none; no other number may be empty.
    filled = [
        ["0" if cell is None and name in _MAY_BE_EMPTY else cell for cell in cells]
        for name, cells in columns.items()
    ]
    complete = replace(sheet, columns=filled)
    names = [name for name in (*_ORIGINS, _EXPANSION) if name in columns]
    values = {name: numbers(complete, sheet.names.index(name)) for name in names}
    rows: dict[str, MaterialRow] = {}
    for k, line in enumerate(sheet.lines):
        source = f"{sheet.source}, {sheet.row_word} {line}"
        cells = {name: cells[k] for name, cells in columns.items()}
        row = _row(source, cells, {name: cells[k] for name, cells in values.items()})
        name = row.material.name
        if _plain(name) in map(_plain, rows):
            rule, remedy = "is used twice", "give each material another name"
            raise InputError(source, "name", name, rule, remedy)
        rows[name] = row
    return rows


def _row(source: str, cells: Mapping[str, object], numbers: Mapping[str, float]) -> MaterialRow:
    """Return the material of a row with its provenance, "assumed" in a table that says none."""
    if cells["name"] is None:
        raise InputError(source, "name", None, "is required", "name the material")
    given = {name: number for name, number in numbers.items() if cells[name] is not None}
    provenance = {
        name: str(cells.get(_ORIGINS[name], "assumed") or "") for name in given if name in _ORIGINS
    }
    for name, origin in provenance.items():
        rule = f"must be one of {', '.join(PROVENANCES)}"
        require(origin in PROVENANCES, source, _ORIGINS[name], origin, rule, "say which")
    E, others = f"{given['E_GPa']!r} GPa", [given.get(name) for name in _MAY_BE_EMPTY]
    try:
        material = Material(str(cells["name"]), E, given["nu"], *others)
    except InputError as error:
        names = {"E": "E_GPa", "yield_stress": "yield_stress_MPa", "thermal_expansion": _EXPANSION}
        column = names.get(error.key, error.key)
        remedy = "check the unit in the column's name"
        raise InputError(source, column, cells[column], error.rule, remedy) from error
    return MaterialRow(material, provenance, str(cells.get("note") or ""))
