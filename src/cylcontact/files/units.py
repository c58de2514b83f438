"""Units of loads, lengths, moduli and times, and what the names of columns mean."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
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
# Beyond it no unit is of any use, and 10 to its power would not be a number.
_LARGEST_EXPONENT = 30
LETTER = 4  # the rank of single letters for a travel
# What vendors add to a word: "Standard force", "Force standard", "Axial Displacement".
_ADDED = {"standard", "axial", "normal", "applied", "line", "total", "machine", "primary"}
# Words in brackets of what a machine was told to do, which is no reading.
_SET = {"target", "set", "setpoint", "set point", "command", "cmd", "demand", "soll", "sollwert"}
_GREEK = str.maketrans({"\u00b5": "u", "\u03bc": "u", "δ": "delta", "Δ": "d", "ν": "nu"})
_PER = re.compile(r"\s*/\s*|[\s_·*.]?(?=(?:mm|cm|m|in)(?:\^?-1|⁻¹)$)")
SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻−", "0123456789+--")
# A power of ten, as 10^3, 10³, 10-3 or 1e3, and any other number, as 1000, 0.01 or 1/100.
_POWER = (
    r"10\s?(?:\^|\*\*)\s?[({]?[+\-−]?\d+[)}]?|10[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+|1(?:[.,]0+)?[eE][+\-−]?\d+"
    r"|10[+\-−]\d+"
)
_COUNT = rf"(?P<power>{_POWER})|(?P<plain>(?:1\s?/\s?)?\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)"
_BEFORE_UNIT = re.compile(rf"(?P<mark>[xX×*·]\s?)?(?:{_COUNT})[\s_]?[xX×*·]?[\s_]?(?=[^\d\s.,])")
_AFTER_UNIT = re.compile(rf"[\s_]*(?P<mark>[xX×*·/])\s?(?:{_COUNT})$")
_AFTER_WORDS = re.compile(
    rf"[\s_]*(?:(?P<mark>(?<![A-Za-z])[xX]|[×*·/])\s?|(?<![\w.,]))(?:{_COUNT})$"
)
_AMONG_WORDS = re.compile(rf"(?P<mark>(?<![A-Za-z])[xX]|[×*·])\s?(?:{_COUNT})")
_POWER_AMONG_WORDS = re.compile(rf"(?P<mark>)(?P<plain>(?!))?(?P<power>{_POWER})")
_ONE_FACTOR = re.compile(rf"(?P<mark>[xX×*·/]\s?)?(?:{_COUNT})")
# Units that are not read, so that a bracket with one is no part of the name.
_OTHER_UNIT = re.compile(
    r"[kMGTmunpcdh]?(?:Pa|N|m|g|V|A|W|J|Hz|bar|F|T|K|C|s|l|L|t|Nm|rad|eV|Ohm|strain|gf|tf)"
    r"|lbs?|lbm|oz|ozf|dyn|pdl|psi|ksi|ft|foot|feet|yd|deg|px|pixels?|counts?|digits?|steps?|tons?"
    r"|(?i:pct|percent|volts?)|.*[/%°^²³⁻\"?ÂÎ\ufffd].*",
)
_PREFIXES = {
    **{"mega": "M", "kilo": "k", "deca": "da", "milli": "m", "micro": "u", "nano": "n"},
    **{"centi": "c", "": ""},
}
_SPELT = re.compile(rf"({'|'.join(_PREFIXES)})[ _-]?(newtons?|met(?:er|re)s?|n|m)", re.IGNORECASE)
_OTHERS = {
    **dict.fromkeys(("inch", "inches", '"', "in."), "in"),
    **dict.fromkeys(("sec", "secs", "second", "seconds"), "s"),
    **{"micron": "um", "microns": "um", "thou": "mil", "kp": "kgf", "kips": "kip", "klbf": "kip"},
    **{"н": "N", "кн": "kN", "мм": "mm", "мкм": "um", "с": "s"},
    **dict.fromkeys(("-", "–", "1"), ""),
}
_KNOWN = {unit for units in QUANTITIES.values() for unit in units}
# Machines that write capitals only: KN can be no other unit, and MN stays what it is.
_CAPITALS = {unit.upper(): unit for unit in _KNOWN if unit.upper() not in _KNOWN}


class Unit(NamedTuple):
    """A unit as a name or a cell of a table has it.

    `name` is its spelling in names of columns, empty if it has none, and `factors` are those that
    a number may have to be multiplied by: more than one where that is not clear.
    """

    text: str = ""
    name: str = ""
    factors: tuple[float, ...] = (1.0,)

    @property
    def is_clear(self) -> bool:
        """Whether numbers have one factor."""
        return len(self.factors) == 1


class Meaning(NamedTuple):
    """The quantity of a name, the rank of its word (0 is best), and its unit."""

    quantity: str
    rank: float
    unit: Unit = Unit()


class _Parts(NamedTuple):
    """A name as words, words in brackets, and a unit, which may be in brackets."""

    words: str
    added: tuple[str, ...]
    unit: Unit
    in_brackets: bool


@dataclass(frozen=True)
class Column:
    """A column of a table, with its quantity and unit."""

    name: str
    quantity: str
    unit: str = ""
    times: float = 1.0  # the multiple of the unit that a cell of 1 is

    @property
    def factor(self) -> float:
        """Factor from the cells of the column to mm, N, MPa and s."""
        return self.times * units_of(self.quantity)[self.unit]

    @property
    def symbol(self) -> str:
        """What a cell of 1 is, as in a sentence: N/mm, 1000 N."""
        return f"{self.times:.12g} {symbol(self.unit)}" if self.times != 1 else symbol(self.unit)

    @property
    def is_total(self) -> bool:
        """Whether it is a total force, to be divided by the axial length."""
        return self.unit in FORCES


def units_of(quantity: str) -> dict[str, float]:
    """Return the units of a quantity with their factors; the empty unit for labels."""
    return QUANTITIES.get(quantity, _PURE)


def column_named(name: str) -> Column | None:
    """Return the column of a name; None unless it has a quantity with a known, clear unit."""
    meaning = meaning_of(name)
    if meaning is None:
        return None
    unit = meaning.unit
    if unit.name not in units_of(meaning.quantity) or not unit.is_clear:
        return None
    return Column(name, meaning.quantity, unit.name, unit.factors[0])


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


def read_unit(text: str) -> Unit:
    """Return the unit in a cell or in brackets, with the factor before or behind it.

    >>> read_unit("[kN/m]").name, read_unit("10^3 N").factors, read_unit("x10 N").factors
    ('kN_per_m', (1000.0,), (10.0, 0.1))
    """
    plain = re.sub(r"^[\[(]\s*|\s*[\])]$", "", text.strip())
    if (name := unit_of(plain)) in _KNOWN:
        return Unit(plain, name)
    rest, factors = plain, []
    for pattern in (_BEFORE_UNIT, _AFTER_UNIT):
        found = pattern.match(rest) if pattern is _BEFORE_UNIT else pattern.search(rest)
        if found:
            rest = (rest[: found.start()] + rest[found.end() :]).strip(" _")
            factors.append(_factors(found))
    if factors and (name := unit_of(rest)) in _KNOWN:
        return Unit(plain, name, _product(factors))
    return Unit(plain, unit_of(plain))


def _factors(found: re.Match[str]) -> tuple[float, ...]:
    """Return what numbers may have to be multiplied by: of 10^3 1000, of x10 10 or 0.1."""
    mark, text = (found["mark"] or "").strip(), (found["power"] or found["plain"])
    plain = re.sub(r"[\s(){}]", "", text.translate(SUPERSCRIPTS)).replace(",", ".")
    if found["power"]:
        exponent = re.sub(r"^10(?:\^|\*\*)?|^1(?:\.0+)?[eE]", "", plain)
        if abs(int(exponent)) > _LARGEST_EXPONENT:
            return (1.0, math.inf)
        value = float(f"1e{int(exponent)}")
    else:
        over, _, under = plain.rpartition("/")
        value = (1 / float(under) if over else float(under)) or 1.0
    if not mark:
        return (value,) if found["power"] else (value, 1.0)
    return (1 / value, value) if mark == "/" else (value, 1 / value)


def _product(factors: Sequence[tuple[float, ...]]) -> tuple[float, ...]:
    """Return the products of one of each, without repetition."""
    return tuple(dict.fromkeys(float(f"{math.prod(each):.12g}") for each in product(*factors)))


def is_unit(cell: object) -> bool:
    """Return whether a cell is a unit, as in a row of units below the names."""
    if not isinstance(cell, str):
        return False
    unit = read_unit(cell)
    # What begins with a number, as 25 kN, is a quantity; 10^3 N is a unit.
    return unit.name in _KNOWN and unit.name != "" and (unit.is_clear or 1.0 not in unit.factors)


def power_between(unit: str, other: str) -> int | None:
    """Return the power of ten between two units of one quantity; None if there is none.

    >>> power_between("kN", "N"), power_between("lbf", "N"), power_between("mm", "N")
    (3, None, None)
    """
    first, second = unit_of(unit), unit_of(other)
    for units in QUANTITIES.values():
        if first in units and second in units:
            power = math.log10(units[first] / units[second])
            return round(power) if math.isclose(power, round(power), abs_tol=1e-9) else None
    return None


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

    >>> meaning_of("Standard force")
    Meaning(quantity='load', rank=0, unit=Unit(text='', name='', factors=(1.0,)))
    >>> meaning_of("load_micro_N").unit, meaning_of("Force (filtered) [kN]").unit.name
    (Unit(text='micro N', name='uN', factors=(1.0,)), 'kN')
    >>> meaning_of("load step")
    """
    plain = " ".join(name.split())
    if whole := _plain_meaning(plain):
        return whole
    for words, added, unit, in_brackets in _parts(plain):
        meaning = _plain_meaning(words)
        if meaning is None or meaning.quantity not in QUANTITIES:
            continue
        if in_brackets or (unit.text and unit.name in QUANTITIES[meaning.quantity]):
            if any(word.lower() in _SET for word in added):
                return None
            text = unit.text.replace("_per_", "/").replace("_", " ")
            # A name without an addition is taken before one with it.
            rank = meaning.rank + (0.5 if added else 0)
            return Meaning(meaning.quantity, rank, unit._replace(text=text))
    return None


def unit_in(name: str, quantity: str) -> Unit:
    """Return the unit of a quantity in a name, which need not name the quantity."""
    parts = [*_parts(" ".join(name.split()))]
    known = (p.unit for p in parts if p.unit.text and p.unit.name in QUANTITIES.get(quantity, {}))
    others = (part.unit for part in parts if part.in_brackets)
    return next(known, next(others, Unit()))


def unit_after(name: str, words: str, units: Container[str]) -> Unit | None:
    """Return the unit of a name that consists of some words and one of these units.

    >>> unit_after("Pin diameter [mm]", "pin_diameter", LENGTHS).name
    'mm'
    """
    plain = " ".join(name.split())
    if _folded(plain) == _folded(words):
        return Unit()
    for part in _parts(plain):
        is_one = part.unit.name in units or part.in_brackets
        if is_one and not part.added and _folded(part.words) == _folded(words):
            return part.unit
    return None


def _folded(words: str) -> str:
    return re.sub(r"[\s_-]+", "_", words.strip().lower())


def _plain_meaning(text: str) -> Meaning | None:
    """Return the quantity or label that a name without a unit stands for."""
    text = text.translate(_GREEK)
    if text in QUANTITIES or text in LABELS:
        return Meaning(text, 0)
    if len(text) < 3 and text in _MEANINGS:
        return Meaning(*_MEANINGS[text])
    ascii_only = unicodedata.normalize("NFKD", text.lower()).encode("ascii", "ignore").decode()
    words = re.split(r"[ ._-]+", ascii_only)
    word = " ".join(word for word in words if word and word not in _ADDED)
    return Meaning(*_MEANINGS[word]) if len(word) > 2 and word in _MEANINGS else None


def _parts(plain: str) -> Iterator[_Parts]:
    """Yield the ways to read a name as words and a unit, the longest unit first."""
    outside, inside = _brackets(plain)
    units, words, factors = [], [], []
    for text in inside:
        unit = read_unit(text)
        if unit.name in _KNOWN and unit.name:
            units.append(unit)
        elif found := _ONE_FACTOR.fullmatch(text):
            if found["mark"] or found["power"] or _is_power_of_ten(text):
                factors.append(_factors(found))
            else:
                words.append(text)  # the number of a channel
        else:
            words.append(text)
    if not units:
        claimed = [text for text in words if _is_claimed(text)]
        words = [text for text in words if text not in claimed]
        units = [Unit(text, unit_of(text)) for text in claimed]
    if units:
        head, more = _without_factors(outside, beside_brackets=True)
        unit = units[0]
        if len({each.name for each in units}) > 1:
            text = ", ".join(each.text for each in units)
            unit = Unit(text, text)
        yield _Parts(head, tuple(words), _times(unit, factors + more, inside), True)
        return
    for separator in re.finditer(r"[ _]in[ _]|[ _]?/[ _]?|, ?|_| ", outside):
        unit = read_unit(outside[separator.end() :])
        head, more = _without_factors(outside[: separator.start()], beside_brackets=False)
        yield _Parts(head, tuple(words), _times(unit, factors + more, [unit.text]), False)
    if inside:
        head, more = _without_factors(outside, beside_brackets=True)
        unit = _times(Unit(", ".join(inside)), factors + more, inside)
        yield _Parts(head, tuple(words), unit, True)


def _times(unit: Unit, factors: list[tuple[float, ...]], texts: list[str]) -> Unit:
    """Return a unit with further factors, which are beside it."""
    if not factors:
        return unit
    return Unit(", ".join(texts), unit.name, _product([unit.factors, *factors]))


def _without_factors(words: str, *, beside_brackets: bool) -> tuple[str, list[tuple[float, ...]]]:
    """Return words without the factors among them, and these.

    A number at the end is one, but beside a unit in brackets only if it is a power of ten: others
    are of channels.
    """
    factors = []
    if (last := _AFTER_WORDS.search(words)) and last.start():
        is_channel = beside_brackets and not (last["mark"] or last["power"])
        if not (is_channel and not _is_power_of_ten(last["plain"])):
            # Before a unit in brackets a power may be of the unit or of the quantity.
            power = _factors(last)
            is_one = beside_brackets and len(power) == 1
            factors.append((power[0], 1 / power[0]) if is_one else power)
            words = words[: last.start()]
    for pattern in (_AMONG_WORDS, _POWER_AMONG_WORDS):
        while found := pattern.search(words):
            power = _factors(found)
            factors.append((power[0], 1 / power[0]))
            words = words[: found.start()] + words[found.end() :]
    return words.strip(" _"), factors


def _is_claimed(text: str) -> bool:
    """Return whether a bracket without a unit that is read stands for one: [-], [psi]."""
    return text in _OTHERS or _OTHER_UNIT.fullmatch(text.translate(_GREEK)) is not None


def _is_power_of_ten(text: str) -> bool:
    return re.fullmatch(r"10+|0[.,]0*1", text) is not None


def _brackets(plain: str) -> tuple[str, list[str]]:
    """Return the text outside of brackets, and that in each of the outermost pairs."""
    outside, inside, depth, start = "", [], 0, 0
    for k, letter in enumerate(plain):
        if letter in "[(":
            start, depth = (k + 1 if depth == 0 else start), depth + 1
        elif letter in "])" and depth:
            depth -= 1
            if depth == 0:
                inside.append(plain[start:k].strip())
                outside += " "
        elif depth == 0:
            outside += letter
    if depth:  # one is open
        return plain, []
    return " ".join(outside.split()).rstrip("_ ,"), inside


# --- numbers with a unit, as options give them --------------------------------------------------


def split_number(text: str) -> tuple[str, str]:
    """Return a number and what stands behind it, with or without a blank between.

    >>> split_number("5kN"), split_number("1e3 N/mm"), split_number("many")
    (('5', 'kN'), ('1e3', 'N/mm'), ('many', ''))
    """
    match = re.fullmatch(r"\s*([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*(.*?)\s*", text)
    return (match[1], match[2]) if match else (text.strip(), "")


def length_in_mm(text: str) -> float:
    """Return a length in mm; without a unit it is in mm.

    >>> length_in_mm("0.04"), length_in_mm("40 µm")
    (0.04, 0.04)
    """
    number, unit = split_number(text)
    factor = LENGTHS.get(unit_of(unit or "mm"))
    if factor is None:
        raise ValueError(f"{text!r} is not a length")
    return plain_number(number) * factor


def load_in_N_per_mm(text: str, length: float | None) -> float:
    """Return a load with a unit, such as 4500 N or 225 N/mm, per unit of length in N/mm."""
    number, written = split_number(text)
    unit = unit_of(written)
    whole, comma, decimals = number.partition(",")
    if comma and len(decimals) != 3 and "." not in number:  # 4,5 is 4.5; 4,500 may be 4500
        number = f"{whole}.{decimals}"
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
