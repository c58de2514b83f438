"""Options for a pair of cylinders, which `check`, `fit` and others share.

What needs numbers is imported in the functions, as in all modules of the command line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from cylcontact.cli.options import Options, Read, length, number, option, reader
from cylcontact.joint.words import (
    clamp_words,
    layer_words,
    material_words,
    radius_words,
    require_pin,
)
from cylcontact.support.choices import CONTACTS, listed
from cylcontact.support.errors import InputError, require

_PANEL: dict[str, Any] = {"rich_help_panel": "The pair of cylinders"}
_HOUSING: dict[str, Any] = {"rich_help_panel": "The housing of the hole"}


def _text(help: str, name: str, metavar: str, read: Read | None = None) -> tuple[Any, Any]:
    return str | None, option(help, name, metavar=metavar, parser=read, **_PANEL)


def _length(help: str, name: str) -> tuple[Any, Any]:
    return float | None, length(help, name, **_PANEL)


def _modulus(text: str) -> float:
    from cylcontact.bodies.material import modulus_in_MPa

    return float(modulus_in_MPa(text, "", ""))


_NAMED = reader(
    material_words,
    "is not a material; write its name, or E, ν, yield stress, expansion: "
    "'207 GPa, 0.3, 350 MPa, 12e-6/K'",
)
_RADIUS = reader(radius_words, "is not a length; give mm, or e.g. '40 um'")
_CLAMP = reader(
    clamp_words, "is not a clamp; write rim, lug, pushed:60 or pulled:60, with your angle"
)
_LAYER = reader(
    layer_words,
    "is not a material with an inner radius; write e.g. bronze:12, or '110 GPa, 0.3:12'",
)
# By their names in `cylcontact.joint.words`.
PAIR: Options = {
    "contact": _text(f"{listed(CONTACTS)}.", "--contact", "CONTACT"),
    "pin": _text("The pin's material, or '207 GPa, 0.3'.", "--pin", "MATERIAL", _NAMED),
    "hole": _text("The hole's material, in the same way.", "--hole", "MATERIAL", _NAMED),
    "material": _text("Material of both bodies.", "--material", "MATERIAL", _NAMED),
    "material_i": _text("Material of the first roller.", "--material-i", "MATERIAL", _NAMED),
    "material_j": _text("Material of the second roller.", "--material-j", "MATERIAL", _NAMED),
    "materials": _text("Your own; datasets/materials.csv by default.", "--materials", "TABLE"),
    "E": _text("Young's modulus, in MPa or '207 GPa'.", "--E", "MODULUS",
                   reader(_modulus, "is not a modulus")),
    "nu": (float | None, number("Poisson's ratio of both.", "--nu", metavar="RATIO", **_PANEL)),
    "radial_clearance": _length("Half of the clearance on the diameter; for rollers R_i + R_j.",
                                "--radial-clearance"),
    "R_i": _length("Radius of the hole or the first roller.", "--Ri"),
    "R_j": (float | None, option("Radius of the pin or the second roller, inf for a plane.",
               "--Rj", metavar="MM", parser=_RADIUS, **_PANEL)),
    "hole_diameter": _length("Diameter of the hole.", "--hole-diameter"),
    "pin_diameter": _length("Diameter of the pin.", "--pin-diameter"),
    "length": _length("Axial length.", "--length"),
    "plane": _text("strain for long parts, stress for thin ones.", "--plane", "PLANE"),
    "R_o": (float | None, length("Radius of its rim.", "--R-o", **_HOUSING)),
    "clamp": (str | None, option("rim (by default), lug, pushed:60 or pulled:60.", "--clamp",
              metavar="CLAMP", parser=_CLAMP, **_HOUSING)),
    "layer": (list[str] | None, option("Outer ring, from this radius; may be repeated.",
              "--layer", metavar="MATERIAL:MM", parser=_LAYER, **_HOUSING)),
}  # fmt: skip
# What only tables of measurements take.
_OF_TABLES = ("E", "nu", "material_i", "material_j")
_BOTH = "Material of both bodies; of two rollers two, --material A --material B."
JOINT: Options = {name: each for name, each in PAIR.items() if name not in _OF_TABLES} | {
    "material": (list[str] | None, option(_BOTH, "--material", metavar="MATERIAL", parser=_NAMED,
                 **_PANEL)),
}  # fmt: skip
# What rollers do not have, and the constants of a table that options are, by other names.
PIN_AND_HOLE = ("pin", "hole", "hole_diameter", "pin_diameter")
_CONSTANTS = {
    "pin": "material_j", "hole": "material_i", "hole_diameter": "R_i_mm", "pin_diameter": "R_j_mm",
    "R_i": "R_i_mm", "R_j": "R_j_mm", "radial_clearance": "dR_mm", "length": "length_mm",
    "E": "E_MPa", **{name: name for name in ("nu", "material", "material_i", "material_j")},
}  # fmt: skip
# The options that are no settings of a fit to a table.
IN_CONSTANTS = {*_CONSTANTS}


def option_of(name: str) -> str:
    """Return the option of a value by its name.

    >>> option_of("R_i"), option_of("hole_diameter"), option_of("load_error")
    ('--Ri', '--hole-diameter', '--load-error')
    """
    if name in PAIR:
        return str(PAIR[name][1].param_decls[0])
    return "--" + name.replace("_", "-")


def constants_of(
    given: Mapping[str, Any], source: str, contact: str
) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the options as constants of a table, and the option that each comes from."""
    values: dict[str, Any] = {}
    options: dict[str, str] = {}
    # Those of pin and hole come last: they are to blame for what is said twice.
    named = [name for name in PAIR if name in IN_CONSTANTS & {*given}]
    for name in sorted(named, key=PIN_AND_HOLE.__contains__):
        option, value, constant = option_of(name), given[name], _CONSTANTS[name]
        if name in PIN_AND_HOLE:
            remedy = f"leave out {option}; rollers have --material-i and --material-j"
            require_pin(source, option_of, contact, remedy)
        new = {constant: value / 2 if name.endswith("diameter") else value}
        if isinstance(value, tuple):  # numbers in the place of a name
            body = constant.removeprefix("material")
            new = dict(zip((f"E{body}_MPa", f"nu{body}"), value[:2], strict=True))
        for key in new:
            rule = f"says the same as {options.get(key)}"
            require(key not in values, source, option, None, rule, "keep one of them")
        values |= new
        options |= dict.fromkeys(new, option)
    return values, options


@contextmanager
def blaming_options(options: Mapping[str, str], source: str = "") -> Iterator[None]:
    """Name the options in the place of what they set, in an error of the block."""
    by_key = dict(options)
    for unit in ("_mm", "_MPa"):
        by_key |= {name.removesuffix(unit): option for name, option in options.items()}
    try:
        yield
    except InputError as error:
        keys = [key.removeprefix("constants.") for key in error.key.split(", ")]
        if not {*keys} <= {*by_key}:
            raise
        blamed, value = ", ".join(by_key[key] for key in keys), error.value
        if "diameter" in blamed:
            value = None  # a radius, half of what is given
        raise InputError(source or error.source, blamed, value, error.rule, error.remedy) from None


def own_materials(given: Mapping[str, Any], source: str) -> Path | None:
    """Return the table of materials that --materials gives, or the default one."""
    from cylcontact.bodies.material import own_table

    return own_table(given.get("materials"), Path(), source, "--materials")
