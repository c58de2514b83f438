"""Column names that carry a unit, and the factors that convert them to mm, N and MPa."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["LABELS", "QUANTITIES", "Column", "column_named", "spellings"]

# For each kind of quantity, the suffixes of its columns and their value in mm, N and MPa.
_LENGTHS = {"nm": 1e-6, "um": 1e-3, "mm": 1.0, "m": 1e3}
_LINE_LOADS = {"N_per_mm": 1.0, "N_per_m": 1e-3, "kN_per_m": 1.0}
_FORCES = {"N": 1.0, "kN": 1e3}
_MODULI = {"Pa": 1e-6, "MPa": 1.0, "GPa": 1e3}
_PURE: dict[str, float] = {"": 1.0}

QUANTITIES: dict[str, dict[str, float]] = {
    "load": _LINE_LOADS | _FORCES,
    "load_std": _LINE_LOADS | _FORCES,
    "penetration": _LENGTHS,
    "penetration_std": _LENGTHS,
    "dR": _LENGTHS,
    "R_i": _LENGTHS,
    "R_j": _LENGTHS,
    "length": _LENGTHS,
    **{f"E{body}": _MODULI for body in ("", "_i", "_j")},
    **{f"nu{body}": _PURE for body in ("", "_i", "_j")},
    "weight": _PURE,
}
# Columns of text.
LABELS = ("material", "material_i", "material_j", "group")


@dataclass(frozen=True)
class Column:
    """A column name, parsed.

    Attributes
    ----------
    name : str
        The name in the table.
    quantity : str
        A key of `QUANTITIES`, or one of `LABELS`.
    factor : float
        Factor from the unit of the column to mm, N and MPa.
    is_total : bool
        Whether it is a total force, to be divided by the axial length.
    """

    name: str
    quantity: str
    factor: float = 1.0
    is_total: bool = False


def column_named(name: str) -> Column | None:
    """Return the parsed name of a column; None if the name is not known.

    Examples
    --------
    >>> column_named("penetration_um")
    Column(name='penetration_um', quantity='penetration', factor=0.001, is_total=False)
    >>> column_named("load_N").is_total
    True
    >>> column_named("temperature") is None
    True
    """
    plain = name.replace("\u00b5", "u").replace("\u03bc", "u")
    if plain in LABELS:
        return Column(name, plain)
    for quantity, units in QUANTITIES.items():
        for unit, factor in units.items():
            if plain == (f"{quantity}_{unit}" if unit else quantity):
                return Column(name, quantity, factor, units is not _PURE and unit in _FORCES)
    return None


def spellings(quantity: str) -> str:
    """Return the possible column names of a quantity, for errors.

    Examples
    --------
    >>> spellings("dR")
    'dR_nm, dR_um, dR_mm, dR_m'
    """
    if quantity in LABELS:
        return quantity
    return ", ".join(f"{quantity}_{unit}" if unit else quantity for unit in QUANTITIES[quantity])
