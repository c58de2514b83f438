"""Column names with a unit, as users write them, and factors that convert to mm, N, MPa and s."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from cylcontact.files.reading import plain_number
from cylcontact.support.errors import InputError

# For each kind of quantity, its units as they stand in the names of columns, and their value in
# mm, N, MPa and s.
_LENGTHS = {"nm": 1e-6, "um": 1e-3, "mm": 1.0, "m": 1e3}
_LINE_LOADS = {"N_per_mm": 1.0, "N_per_m": 1e-3, "kN_per_m": 1.0}
_FORCES = {"N": 1.0, "kN": 1e3}
_MODULI = {"Pa": 1e-6, "MPa": 1.0, "GPa": 1e3}
_TIMES = {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0}
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
    "time": _TIMES,
}
# Columns of text.
LABELS = ("material", "material_i", "material_j", "group")

# Other names of what is measured, in lower case unless they are a single letter.
_SYNONYMS = {
    **dict.fromkeys(("F", "P", "force", "normal_force", "applied_force"), "load"),
    **dict.fromkeys(("line_load", "normal_load", "applied_load"), "load"),
    **dict.fromkeys(("delta", "displacement", "indentation", "approach"), "penetration"),
    **dict.fromkeys(("deflection", "deformation", "indentation_depth"), "penetration"),
    "penetration_depth": "penetration",
    "t": "time",
}
# Letters for a travel, which say so only with a unit of length.
_TRAVELS = ("s", "x", "z", "u", "w")
_GREEK = str.maketrans({"\u00b5": "u", "\u03bc": "u", "δ": "delta", "Δ": "d", "ν": "nu"})
_BRACKETED = re.compile(r"(.*?)[\s_]*[\[(]\s*([^\[\]()]*?)\s*[\])]")
_CLOSING = ("]", ")")
_PER = re.compile(r"(k?N)[_·*.]?(m?m)(?:\^?-1|⁻¹)")
_MICRONS = re.compile(r"microns?|micromet(?:er|re)s?")


@dataclass(frozen=True)
class Column:
    """A column name, parsed."""

    name: str
    quantity: str
    unit: str = ""

    @property
    def factor(self) -> float:
        """Factor from the unit of the column to mm, N, MPa and s."""
        return QUANTITIES.get(self.quantity, _PURE)[self.unit]

    @property
    def symbol(self) -> str:
        """The unit as a sentence has it: N/mm, µm."""
        return self.unit.replace("_per_", "/").replace("um", "µm")

    @property
    def is_total(self) -> bool:
        """Whether it is a total force, to be divided by the axial length."""
        return self.unit in _FORCES

    @property
    def is_standard(self) -> bool:
        """Whether the table names it as the package does, e.g. load_N."""
        own = f"{self.quantity}_{self.unit}" if self.unit else self.quantity
        return self.name.translate(_GREEK) == own


def column_named(name: str) -> Column | None:
    """Return the parsed name of a column; None unless it says the quantity and its unit."""
    parsed = quantity_and_unit(name)
    return None if parsed is None else named_quantity(name, *parsed)


def named_quantity(name: str, quantity: str, unit: str) -> Column | None:
    """Return a column of a quantity in a unit as a user writes it; None if it has no such unit."""
    plain = _unit(unit)
    return Column(name, quantity, plain) if plain in QUANTITIES.get(quantity, _PURE) else None


def length_in_mm(text: str) -> float:
    """Return a length in mm; without a unit it is in mm.

    >>> length_in_mm("0.04"), length_in_mm("40 µm")
    (0.04, 0.04)
    """
    number, _, unit = text.strip().partition(" ")
    column = named_quantity("length", "length", unit or "mm")
    if column is None:
        raise ValueError(f"{text!r} is not a length")
    return plain_number(number) * column.factor


def load_in_N_per_mm(text: str, length: float | None) -> float:
    """Return a load with a unit, such as 4500 N or 225 N/mm, per unit of length in N/mm."""
    number, _, unit = text.strip().partition(" ")
    column = named_quantity("load", "load", unit)
    try:
        value = plain_number(number)
    except ValueError:
        column = None
    if column is None or not unit:
        raise InputError(
            "load", "", text, "is not a load with its unit", 'e.g. "4500 N", "225 N/mm"'
        )
    if column.is_total and length is None:
        rule = "is a total force, and no single axial length is known"
        remedy = "give the length, or the load in N/mm"
        raise InputError("load", "", text, rule, remedy)
    return value * column.factor / (length if column.is_total and length is not None else 1.0)


def quantity_and_unit(name: str) -> tuple[str, str] | None:
    """Return the quantity that a name says, and its unit as written; None without a quantity."""
    plain = " ".join(name.translate(_GREEK).split())
    quantity = _quantity(plain)
    if quantity is not None:
        return quantity, ""
    for head, unit in _splits(plain):
        if head in _TRAVELS and _has_unit("penetration", unit):
            return "penetration", unit
        quantity = _quantity(head)
        if quantity in QUANTITIES and (plain.endswith(_CLOSING) or _has_unit(quantity, unit)):
            return quantity, unit
    return None


def unit_in(name: str, quantity: str) -> str:
    """Return the unit of a quantity in a name that does not say the quantity; empty without one."""
    plain = " ".join(name.translate(_GREEK).split())
    return next((unit for _, unit in _splits(plain) if _has_unit(quantity, unit)), "")


def is_unit(text: str) -> bool:
    """Return whether a cell is a unit, as in a row of units below the names."""
    plain = _unit(text.translate(_GREEK))
    return bool(plain) and any(plain in units for units in QUANTITIES.values())


def spellings(quantity: str) -> str:
    """Return the possible column names of a quantity, for errors."""
    if quantity in LABELS:
        return quantity
    return ", ".join(f"{quantity}_{unit}" if unit else quantity for unit in QUANTITIES[quantity])


def _quantity(text: str) -> str | None:
    """Return the quantity or label that a name without a unit stands for."""
    if text in QUANTITIES or text in LABELS:
        return text
    word = text if len(text) == 1 else re.sub(r"[ _-]+", "_", text.lower())
    return word if word in ("load", "penetration", "time") else _SYNONYMS.get(word)


def _splits(plain: str) -> Iterator[tuple[str, str]]:
    """Yield the ways to read a name as a quantity and a unit."""
    if bracketed := _BRACKETED.fullmatch(plain):
        yield bracketed[1], bracketed[2]
        return
    for separator in re.finditer(r" in | ?/ ?|, ?|_| ", plain):
        yield plain[: separator.start()], plain[separator.end() :]


def _has_unit(quantity: str, unit: str) -> bool:
    """Return whether a unit as written is one of a quantity."""
    return bool(unit) and _unit(unit) in QUANTITIES.get(quantity, _PURE)


def _unit(text: str) -> str:
    """Return a unit in the spelling of column names: N/mm as N_per_mm, a dash as nothing."""
    plain = re.sub(r"^[\[(]\s*|\s*[\])]$", "", text.translate(_GREEK).strip())
    if plain in ("-", "–", "1"):
        return ""
    plain = re.sub(r"\s*/\s*", "_per_", plain)
    plain = _PER.sub(r"\1_per_\2", re.sub(r"\s+", "_", plain))
    return _MICRONS.sub("um", plain)
