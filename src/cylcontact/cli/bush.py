"""The option --bush of `check`: a bush on a line, and the joint of the other options."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from cylcontact.cli.pair import (
    blaming_options,
    bodies_of,
    material_in_words,
    material_of,
    option_of,
    read_housing,
)
from cylcontact.files.reading import plain_number
from cylcontact.files.units import length_in_mm
from cylcontact.support.errors import InputError, require

Load = Callable[[float | None], float]

if TYPE_CHECKING:
    from cylcontact.joint.bush import BushCheck

EXAMPLE = "write MATERIAL, BORE, HOLE/BUSH: 'bronze, 20E6, 26H7/s6'; or 'wall 3' as the bore"
# A class of ISO 286: mm, letters, grade.
_CLASS = re.compile(r"[0-9.,]+[A-Za-z]{1,2}[0-9]{1,2}")
# What the bush gives, or what has no bush.
_WITHOUT = ("dR_mm", "R_i_mm", "hole_diameter", "layer")
_OPTIONS = {
    **{"pin": "--pin-diameter", "housing": "--R-o", "rim": "--rim", "load": "--load"},
    **dict.fromkeys(("bore", "wall", "seat"), "--bush"),
}


def diameter(text: str) -> float | str:
    """Return a diameter in mm, or a class of ISO 286 as it is.

    >>> diameter("19.96"), diameter("20f7")
    (19.96, '20f7')
    """
    return text.strip() if _CLASS.fullmatch(text.strip()) else length_in_mm(text)


def _size(text: str) -> Any:
    """Return a size in mm, LOW:HIGH as limits, or a class as it is."""
    low, colon, high = text.partition(":")
    if colon:
        return plain_number(low), plain_number(high)
    # A class such as 20E6 would be a number too.
    return text.strip() if _CLASS.fullmatch(text.strip()) else plain_number(text)


def read_bush(text: str) -> dict[str, Any]:
    """Return the parts of a bush on a line.

    >>> read_bush("bronze, 20E6, 26H7/s6")
    {'material': 'bronze', 'seat': '26H7/s6', 'bore': '20E6', 'wall': None, 'wrapped': False}
    """
    parts = [part.strip() for part in text.split(",")]
    wrapped = parts[-1] == "wrapped"
    parts = parts[:-1] if wrapped else parts
    if len(parts) < 3 or "/" not in parts[-1]:
        raise ValueError
    *name, inner, seat = parts
    hole, _, outer = seat.partition("/")
    is_fit = re.fullmatch(r"[a-z]{1,2}[0-9]{1,2}", outer.strip()) is not None
    is_wall = inner.startswith("wall ")
    size = _size(inner.removeprefix("wall "))
    return {
        "material": material_in_words(", ".join(name)),
        "seat": seat if is_fit else (_size(hole), _size(outer)),
        "bore": None if is_wall else size,
        "wall": size if is_wall else None,
        "wrapped": wrapped,
    }


def bush_check(
    bush: Mapping[str, Any], pair: dict[str, Any], around: dict[str, Any], load: Load, rim: Any
) -> BushCheck:
    """Return the answer for a joint with a bush, from the options of `check`.

    `load` gives the load in N/mm for a length.
    """
    from cylcontact.bodies.material import Material
    from cylcontact.joint.bush import Bush, check_bush

    contact = pair.get("contact", "internal")
    rule = f"is for a pin in a hole, and --contact is {contact}"
    require(contact == "internal", "check", "--bush", None, rule, "leave out --contact, or --bush")
    for name in filter(pair.__contains__, _WITHOUT):
        rule = "is given by --bush" if name != "layer" else "is beside --bush, which is the ring"
        raise InputError("check", option_of(name), None, rule, "leave one of them out")
    for name in ("iso", "depth"):
        rule = "is for a joint without --bush"
        require(name not in around, "check", f"--{name}", around.get(name), rule,
                "leave one of them out; the pin's class is e.g. --pin-diameter 20f7")  # fmt: skip
    sizes = [name for name in ("pin_diameter", "R_j_mm") if name in pair]
    rule = "is missing" if not sizes else "says the same as --Rj"
    require(
        len(sizes) == 1, "check", "--pin-diameter", None, rule, "give it in mm, or a class: 20f7"
    )
    size = pair.pop(sizes[0])
    housing = read_housing(pair, "check")
    rule, remedy = "is missing beside --bush", "give the outer radius of the part around the bush"
    require(housing is not None, "check", "--R-o", None, rule, remedy)
    assert housing is not None
    hole, pin = bodies_of(pair, "check")
    own = bush["material"]
    if isinstance(own, str):
        own = material_of(own, pair, "check", "--bush")
    else:
        own = Material("", f"{own[0]!r} MPa", *own[1:])
    length = pair.get("length_mm")
    with blaming_options(_OPTIONS, "check"):
        return check_bush(
            Bush(own, bush["seat"], bush["bore"], bush["wall"], bush["wrapped"]),
            pin,
            2 * size if sizes == ["R_j_mm"] else size,
            hole,
            housing,
            load(length),
            length=length,
            plane=pair.get("plane", "strain"),
            temperature=around.get("temperature", 20.0),
            rim=rim,
        )
