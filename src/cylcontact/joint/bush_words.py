"""A joint with a bush as users write it in options: what `joint.words` is for other joints."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cylcontact.files.reading import plain_number
from cylcontact.files.units import length_in_mm
from cylcontact.joint.words import (
    DEFAULT_LOAD,
    Named,
    blaming,
    bodies_from_words,
    housing_from_words,
    load_from_words,
    material_from_words,
    material_words,
    rim_from_words,
)
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.joint.bush import BushCheck

EXAMPLE = "write MATERIAL, BORE, HOLE/BUSH: 'bronze, 20E6, 26H7/s6'; or 'wall 3' as the bore"
# A class of ISO 286: mm, letters, grade; and one without mm.
_CLASS, _LETTERS = (
    re.compile(r"[0-9.,]+[A-Za-z]{1,2}[0-9]{1,2}"),
    re.compile(r"[a-z]{1,2}[0-9]{1,2}"),
)
# What the bush gives, and what is for joints without one.
_GIVEN, _OTHERS = ("radial_clearance", "R_i", "hole_diameter"), ("iso", "depth", "layer")


def diameter_words(text: str) -> float | str:
    """Return a diameter in mm, or a class of ISO 286 as it is.

    >>> diameter_words("19.96"), diameter_words("20f7")
    (19.96, '20f7')
    """
    return text.strip() if _CLASS.fullmatch(text.strip()) else length_in_mm(text)


def size_words(text: str) -> Any:
    """Return a size in mm, LOW:HIGH as limits, or a class as it is."""
    low, colon, high = text.partition(":")
    if colon:
        return plain_number(low), plain_number(high)
    # A class such as 20E6 would be a number too.
    return text.strip() if _CLASS.fullmatch(text.strip()) else plain_number(text)


def bush_words(text: str) -> dict[str, Any]:
    """Return the parts of a bush on a line.

    >>> bush_words("bronze, 20E6, 26H7/s6")
    {'material': 'bronze', 'seat': '26H7/s6', 'bore': '20E6', 'wall': None, 'wrapped': False}
    """
    parts = [part.strip() for part in text.split(",")]
    wrapped = parts[-1] == "wrapped"
    parts = parts[:-1] if wrapped else parts
    if len(parts) < 3 or "/" not in parts[-1]:
        raise ValueError
    *name, inner, seat = parts
    hole, _, outer = seat.partition("/")
    is_fit = _LETTERS.fullmatch(outer.strip()) is not None
    is_wall = inner.startswith("wall ")
    size = size_words(inner.removeprefix("wall "))
    return {
        "material": material_words(", ".join(name)),
        "seat": seat if is_fit else (size_words(hole), size_words(outer)),
        "bore": None if is_wall else size,
        "wall": size if is_wall else None,
        "wrapped": wrapped,
    }


def bush_from_words(
    given: Mapping[str, Any], source: str, named: Named = str, own: Path | None = None
) -> BushCheck:
    """Return the answer for a joint with a bush, as `joint_from_words` returns other joints."""
    from cylcontact.joint.bush import Bush, check_bush

    option, bush, contact = named("bush"), given["bush"], given.get("contact", "internal")
    rule = f"is for a pin in a hole, and {named('contact')} is {contact}"
    remedy = f"leave out {named('contact')}, or {option}"
    require(contact == "internal", source, option, None, rule, remedy)
    for name in (*_GIVEN, *_OTHERS):
        rule = f"is given by {option}" if name in _GIVEN else f"is for a joint without {option}"
        remedy = f"leave one of them out; the pin's class is e.g. {named('pin_diameter')} 20f7"
        require(given.get(name) is None, source, named(name), None, rule, remedy)
    sizes = [name for name in ("pin_diameter", "R_j") if given.get(name) is not None]
    rule = "is missing" if not sizes else f"says the same as {named('R_j')}"
    remedy = "give it in mm, or a class: 20f7"
    require(len(sizes) == 1, source, named("pin_diameter"), None, rule, remedy)
    size = given[sizes[0]]
    housing = housing_from_words(given, source, named, own)
    if housing is None:
        rule, remedy = f"is missing beside {option}", "give the radius of the part around the bush"
        raise InputError(source, named("R_o"), None, rule, remedy)
    hole, pin = bodies_from_words(given, source, named, own, contact)
    material = material_from_words(bush["material"], source, option, own)
    length = given.get("length")
    load = load_from_words(given.get("load", DEFAULT_LOAD), length, source, named)
    names = {"pin": "pin_diameter"} | dict.fromkeys(("bore", "wall", "seat"), "bush")
    with blaming(named, source, names):
        return check_bush(
            Bush(material, bush["seat"], bush["bore"], bush["wall"], bush["wrapped"]),
            pin,
            2 * size if sizes == ["R_j"] else size,
            hole,
            housing,
            load,
            length=length,
            plane=given.get("plane", "strain"),
            temperature=given.get("temperature", 20.0),
            rim=rim_from_words(given.get("rim"), source, named, own),
        )
