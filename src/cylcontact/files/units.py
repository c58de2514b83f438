"""Units of loads, lengths, moduli and times, and what the names of columns mean."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from cylcontact.files.reading import plain_number
from cylcontact.support.errors import InputError

# Values in mm, N, MPa and s.
LENGTHS = {"um": 1e-3, "mm": 1.0, "nm": 1e-6, "cm": 10.0, "m": 1e3, "in": 25.4, "mil": 0.0254}
FORCES = {
    **{"N": 1.0, "kN": 1e3, "MN": 1e6, "mN": 1e-3, "uN": 1e-6, "nN": 1e-9, "daN": 10.0},
    **{"kgf": 9.80665, "lbf": 4.4482216152605, "kip": 4448.2216152605},
}
_LINE_LOADS = {f"{f}_per_{x}": FORCES[f] / LENGTHS[x] for f in FORCES for x in LENGTHS}
_MODULI = {"Pa": 1e-6, "MPa": 1.0, "GPa": 1e3}
_PURE = {"": 1.0}
QUANTITIES: dict[str, dict[str, float]] = {
    **dict.fromkeys(("load", "load_std"), FORCES | _LINE_LOADS),
    **dict.fromkeys(("penetration", "penetration_std", "dR", "R_i", "R_j", "length"), LENGTHS),
    **dict.fromkeys(("E", "E_i", "E_j"), _MODULI),
    **dict.fromkeys(("nu", "nu_i", "nu_j"), _PURE),
    "time": {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
}
# Columns of text.
LABELS = ("material", "material_i", "material_j", "group")

# Words for what is measured. Of several columns, that of the earlier line is taken.
_WORDS = {
    "load": (
        "load, force, F, P, Fn, kraft, prufkraft, standardkraft, last, charge, fuerza, carga, "
        "forza, carico",
        "load cell, force cell, load on sample, compressive load, compressive force, "
        "kraftaufnehmer, capteur de force",
    ),
    "penetration": (
        "penetration, penetration depth, indentation, indentation depth, approach, delta",
        "displacement, disp, displ, deflection, deformation, depth, deplacement, desplazamiento, "
        "spostamento, "
        "displacement into surface, tiefe, eindringtiefe, enfoncement, profondeur, profundidad, "
        "profondita, deformacion, deformazione, Pd",
        "travel, extension, weg, standardweg, verschiebung, langenanderung, course, allongement, "
        "carrera, alargamiento, corsa, allungamento, compressive displacement",
        "crosshead, stroke, position, traverse, traversenweg, kolbenweg, maschinenweg, "
        "course traverse, cruceta, traversa, compressive extension",
        "s, x, z, u, w",  # these with a unit only
    ),
    "time": (
        "time, t, zeit, prufzeit, temps, tiempo, tempo, elapsed time, run time, running time, "
        "test time",
    ),
}
_MEANINGS = {
    word: (quantity, rank)
    for quantity, lines in _WORDS.items()
    for rank, line in enumerate(lines)
    for word in line.split(", ")
}
LETTER = 4  # the rank of single letters for a travel
# What vendors add to a word: "Standard force", "Force standard", "Axial Displacement".
_ADDED = {"standard", "axial", "normal", "applied", "line", "total", "machine", "primary"}
_GREEK = str.maketrans({"\u00b5": "u", "\u03bc": "u", "δ": "delta", "Δ": "d", "ν": "nu"})
_BRACKETED = re.compile(r"(.*?)[\s_]*[\[(]\s*([^\[\]()]*?)\s*[\])]")
_PER = re.compile(r"\s*/\s*|[\s_·*.]?(?=(?:mm|cm|m|in)(?:\^?-1|⁻¹)$)")
_PREFIXES = {
    **{"mega": "M", "kilo": "k", "deca": "da", "milli": "m", "micro": "u", "nano": "n"},
    **{"centi": "c", "": ""},
}
_SPELT = re.compile(rf"({'|'.join(_PREFIXES)})[ _-]?(newtons?|met(?:er|re)s?|n|m)", re.IGNORECASE)
_OTHERS = {
    **dict.fromkeys(("inch", "inches", '"', "in."), "in"),
    **dict.fromkeys(("sec", "secs", "second", "seconds"), "s"),
    **{"micron": "um", "microns": "um", "thou": "mil", "kp": "kgf", "kips": "kip", "klbf": "kip"},
    **dict.fromkeys(("-", "–", "1"), ""),
}
_KNOWN = {unit for units in QUANTITIES.values() for unit in units}
# Machines that write capitals only: KN can be no other unit, and MN stays what it is.
_CAPITALS = {unit.upper(): unit for unit in _KNOWN if unit.upper() not in _KNOWN}


class Meaning(NamedTuple):
    """The quantity of a name, the rank of its word (0 is best), and the unit as written."""

    quantity: str
    rank: int
    unit: str = ""


@dataclass(frozen=True)
class Column:
    """A column of a table, with its quantity and unit."""

    name: str
    quantity: str
    unit: str = ""

    @property
    def factor(self) -> float:
        """Factor from the unit of the column to mm, N, MPa and s."""
        return units_of(self.quantity)[self.unit]

    @property
    def is_total(self) -> bool:
        """Whether it is a total force, to be divided by the axial length."""
        return self.unit in FORCES


def units_of(quantity: str) -> dict[str, float]:
    """Return the units of a quantity with their factors; the empty unit for labels."""
    return QUANTITIES.get(quantity, _PURE)


def column_named(name: str) -> Column | None:
    """Return the column of a name; None unless it has a quantity with a known unit."""
    meaning = meaning_of(name)
    if meaning is None or (unit := unit_of(meaning.unit)) not in units_of(meaning.quantity):
        return None
    return Column(name, meaning.quantity, unit)


def unit_of(text: str) -> str:
    """Return a unit in the spelling of column names, as N_per_mm; an unknown one unchanged.

    >>> unit_of("[kN / m]"), unit_of("N·mm⁻¹"), unit_of("micro N"), unit_of("Newton"), unit_of("tf")
    ('kN_per_m', 'N_per_mm', 'uN', 'N', 'tf')
    """
    plain = re.sub(r"^[\[(]\s*|\s*[\])]$", "", text.translate(_GREEK).strip())
    plain = plain.replace("_per_", "/")
    parts = [re.sub(r"\^?-1$|⁻¹$", "", part) for part in _PER.split(plain, maxsplit=1)]
    return "_per_".join(map(_simple_unit, parts))


def _simple_unit(text: str) -> str:
    if text in _KNOWN or text.lower() in _OTHERS:
        return text if text in _KNOWN else _OTHERS[text.lower()]
    if (spelt := _SPELT.fullmatch(text)) and (spelt[1] or len(spelt[2]) > 1):
        unit = _PREFIXES[spelt[1].lower()] + ("N" if spelt[2][0] in "nN" else "m")
        return unit if unit in _KNOWN else text
    return _CAPITALS.get(text, text)


def is_unit(cell: object) -> bool:
    """Return whether a cell is a unit, as in a row of units below the names."""
    return isinstance(cell, str) and bool(unit := unit_of(cell)) and unit in _KNOWN


def symbol(unit: str) -> str:
    """Return a unit as in a sentence: N/mm, µm."""
    return re.sub(r"^u(?=[Nm])|(?<=/)u(?=m)", "µ", unit.replace("_per_", "/"))


def spellings(quantity: str) -> str:
    """Return the usual names of a column of a quantity, for errors."""
    units = [unit for unit in units_of(quantity) if "_per_" not in unit]
    units += ["N_per_mm"] if quantity.startswith("load") else []
    return ", ".join(f"{quantity}_{unit}" if unit else quantity for unit in units)


def meaning_of(name: str) -> Meaning | None:
    """Return what a name means; None if it names no quantity.

    >>> meaning_of("Standard force"), meaning_of("load_micro_N")
    (Meaning(quantity='load', rank=0, unit=''), Meaning(quantity='load', rank=0, unit='micro N'))
    >>> meaning_of("load step")
    """
    plain = " ".join(name.translate(_GREEK).split())
    if whole := _plain_meaning(plain):
        return whole
    for head, unit in _splits(plain):
        meaning = _plain_meaning(head)
        has_unit = plain.endswith(("]", ")")) or (meaning and _is_of(unit, meaning.quantity))
        if meaning and meaning.quantity in QUANTITIES and has_unit:
            return meaning._replace(unit=unit.replace("_per_", "/").replace("_", " "))
    return None


def unit_in(name: str, quantity: str) -> str:
    """Return the unit of a quantity in a name, which need not name the quantity."""
    plain = " ".join(name.translate(_GREEK).split())
    brackets = _BRACKETED.fullmatch(plain)
    units = (unit for _, unit in _splits(plain) if _is_of(unit, quantity))
    return next(units, brackets[2] if brackets else "")


def _is_of(unit: str, quantity: str) -> bool:
    return bool(unit) and unit_of(unit) in QUANTITIES.get(quantity, {})


def _plain_meaning(text: str) -> Meaning | None:
    """Return the quantity or label that a name without a unit stands for."""
    if text in QUANTITIES or text in LABELS:
        return Meaning(text, 0)
    if len(text) < 3 and text in _MEANINGS:
        return Meaning(*_MEANINGS[text])
    ascii_only = unicodedata.normalize("NFKD", text.lower()).encode("ascii", "ignore").decode()
    words = re.split(r"[ ._-]+", ascii_only)
    word = " ".join(word for word in words if word and word not in _ADDED)
    return Meaning(*_MEANINGS[word]) if len(word) > 2 and word in _MEANINGS else None


def _splits(plain: str) -> Iterator[tuple[str, str]]:
    """Yield the ways to read a name as a quantity and a unit, the longest unit first."""
    if brackets := _BRACKETED.fullmatch(plain):
        yield brackets[1], brackets[2]
        return
    for separator in re.finditer(r"[ _]in[ _]|[ _]?/[ _]?|, ?|_| ", plain):
        yield plain[: separator.start()], plain[separator.end() :]


# --- numbers with a unit, as options give them --------------------------------------------------


def _number_and_unit(text: str) -> tuple[str, str]:
    """Return a number and what stands behind it, with or without a blank between.

    >>> _number_and_unit("5kN"), _number_and_unit("1e3 N/mm"), _number_and_unit("many")
    (('5', 'kN'), ('1e3', 'N/mm'), ('many', ''))
    """
    match = re.fullmatch(r"\s*([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*(.*?)\s*", text)
    return (match[1], match[2]) if match else (text.strip(), "")


def length_in_mm(text: str) -> float:
    """Return a length in mm; without a unit it is in mm.

    >>> length_in_mm("0.04"), length_in_mm("40 µm")
    (0.04, 0.04)
    """
    number, unit = _number_and_unit(text)
    factor = LENGTHS.get(unit_of(unit or "mm"))
    if factor is None:
        raise ValueError(f"{text!r} is not a length")
    return plain_number(number) * factor


def load_in_N_per_mm(text: str, length: float | None) -> float:
    """Return a load with a unit, such as 4500 N or 225 N/mm, per unit of length in N/mm."""
    number, written = _number_and_unit(text)
    unit = unit_of(written)
    try:
        value = plain_number(number) * QUANTITIES["load"][unit]
    except (KeyError, ValueError):
        rule, remedy = "is not a load with its unit", 'e.g. "4500 N", "225 N/mm"'
        raise InputError("load", "", text, rule, remedy) from None
    if unit not in FORCES:
        return value
    if length is None:
        rule = "is a total force, and no single axial length is known"
        remedy = "give the length, or the load in N/mm"
        raise InputError("load", "", text, rule, remedy)
    return value / length
