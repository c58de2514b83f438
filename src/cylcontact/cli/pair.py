"""Options for a pair of cylinders, which `laws`, `fit` and others share.

What needs numbers is imported in the functions, as in all modules of the command line.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cylcontact.cli.options import Options, Read, length, number, option, reader
from cylcontact.files.reading import plain_number
from cylcontact.files.units import length_in_mm
from cylcontact.support.choices import CONTACTS, listed
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.bodies.material import Material
    from cylcontact.bodies.pair import CylinderPair
    from cylcontact.laws import Housing
    from cylcontact.laws.housing_spec import HousingSpec

_PANEL: dict[str, Any] = {"rich_help_panel": "The pair of cylinders"}
_HOUSING: dict[str, Any] = {"rich_help_panel": "The housing of the hole"}


def _text(help: str, name: str, read: Read | None = None) -> tuple[Any, Any]:
    return str | None, option(help, name, metavar="TEXT", parser=read, **_PANEL)


def _length(help: str, name: str) -> tuple[Any, Any]:
    return float | None, length(help, name, **_PANEL)


def _modulus(text: str) -> float:
    from cylcontact.bodies.material import modulus_in_MPa

    return float(modulus_in_MPa(text, "", ""))


def _material(text: str) -> str | tuple[float, ...]:
    """Return the name of a material, or its E in MPa, ν and perhaps yield stress and expansion.

    >>> _material("bronze"), _material("207 GPa, 0.3, 350 MPa, 12e-6/K")
    ('bronze', (207000.0, 0.3, 350.0, 1.2e-05))
    """
    modulus, *rest = (part.strip() for part in text.split(","))
    if not rest:
        return text
    if len(rest) > 3:
        raise ValueError
    ratio, *more = rest
    numbers = [_modulus(modulus), plain_number(ratio)]
    if more:
        numbers.append(plain_number(more[0].removesuffix("MPa")))
    if len(more) == 2:
        numbers.append(plain_number(more[1].removesuffix("/K")))
    return tuple(numbers)


def _radius(text: str) -> float:
    """Return a length in mm; inf is a plane."""
    return math.inf if text.strip() == "inf" else length_in_mm(text)


def _clamp(text: str) -> dict[str, Any]:
    """Return the keys of a table [housing] for a clamp in short."""
    if text == "rim":
        return {"clamp": "rim"}
    side, colon, angle = text.partition(":")
    if side == "lug":
        return {"clamp": "lug"} | ({"shank": plain_number(angle)} if colon else {})
    if side not in ("near", "far"):
        raise ValueError
    return {"clamp": "sector", "angle": plain_number(angle), "side": side}


def _layer(text: str) -> dict[str, Any]:
    name, _, radius = text.rpartition(":")
    return {"material": name, "R_i": plain_number(radius)}


_NAMED = reader(
    _material,
    "is no material; write its name, or E, ν, yield stress, expansion: "
    "'207 GPa, 0.3, 350 MPa, 12e-6/K'",
)
_RADIUS = reader(_radius, "is not a length; give mm, or e.g. '40 um'")
_CLAMP = reader(_clamp, "is no clamp; write rim, lug, near:60 or far:60, with your angle")
_LAYER = reader(_layer, "is no material with an inner radius; write e.g. bronze:12")
# By their names as constants of a table, where they have one.
PAIR: Options = {
    "contact": _text(f"{listed(CONTACTS)}.", "--contact"),
    "pin": _text("The pin's material, or e.g. '207 GPa, 0.3'.", "--pin", read=_NAMED),
    "hole": _text("The hole's material, in the same way.", "--hole", read=_NAMED),
    "material": _text("Material of both bodies.", "--material", read=_NAMED),
    "material_i": _text("Material of the first of two rollers.", "--material-i", read=_NAMED),
    "material_j": _text("Material of the second of two rollers.", "--material-j", read=_NAMED),
    "materials": _text("Table of yours; datasets/materials.csv by default.", "--materials"),
    "E_MPa": _text("Young's modulus of both, MPa or '207 GPa'.", "--E",
                   read=reader(_modulus, "is not a modulus")),
    "nu": (float | None, number("Poisson's ratio of both bodies.", "--nu", **_PANEL)),
    "dR_mm": _length("Radial clearance ΔR; for rollers R_i + R_j.", "--dR"),
    "R_i_mm": _length("Radius R_i of the hole or the first roller.", "--Ri"),
    "R_j_mm": (float | None, option("Radius R_j of the pin or the second roller; inf is a plane.",
               "--Rj", metavar="MM", parser=_RADIUS, **_PANEL)),
    "hole_diameter": _length("Diameter of the hole.", "--hole-diameter"),
    "pin_diameter": _length("Diameter of the pin.", "--pin-diameter"),
    "length_mm": _length("Axial length.", "--length"),
    "plane": _text("strain for long parts, stress for thin ones.", "--plane"),
    "R_o": (float | None, length("Radius of its rim.", "--R-o", **_HOUSING)),
    "clamp": (str | None, option("rim (by default), lug, near:60 or far:60.", "--clamp",
              metavar="TEXT", parser=_CLAMP, **_HOUSING)),
    "layer": (list[str] | None, option("Outer ring, from this radius; may be repeated.",
              "--layer", metavar="NAME:MM", parser=_LAYER, **_HOUSING)),
}  # fmt: skip
# What stands for a constant under another name, which rollers do not have, and a factor to it.
OF_PIN_AND_HOLE = {
    "pin": ("material_j", None),
    "hole": ("material_i", None),
    "hole_diameter": ("R_i_mm", 0.5),
    "pin_diameter": ("R_j_mm", 0.5),
}
# The options that `constants_of` takes.
IN_CONSTANTS = {*PAIR} - {"contact", "materials", "plane", "R_o", "clamp", "layer"}


def option_of(name: str) -> str:
    """Return the option of a constant or of a setting.

    >>> option_of("load_error"), option_of("R_i_mm"), option_of("E_MPa")
    ('--load-error', '--Ri', '--E')
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
    # Names of their own come last, and are to blame for what is said twice.
    for name in sorted(PAIR, key=OF_PIN_AND_HOLE.__contains__):
        if name not in IN_CONSTANTS & {*given}:
            continue
        option, value = option_of(name), given[name]
        constant, factor = OF_PIN_AND_HOLE.get(name, (name, None))
        if name in OF_PIN_AND_HOLE:
            remedy = f"leave out {option}; rollers have --material-i and --material-j"
            _require_internal(source, contact, remedy)
        new = {constant: value if factor is None else factor * value}
        if isinstance(value, tuple):  # numbers in the place of a name
            body = constant.removeprefix("material")
            new = dict(zip((f"E{body}_MPa", f"nu{body}"), value[:2], strict=True))
        for key in new:
            rule = f"says the same as {options.get(key)}"
            require(key not in values, source, option, None, rule, "keep one of them")
        values |= new
        options |= dict.fromkeys(new, option)
    return values, options


def housing_of(given: dict[str, Any], source: str, contact: str) -> HousingSpec | None:
    """Return the housing that the options give, and take them away."""
    keys = ("R_o", "clamp", "layer")
    data = {key: given.pop(key) for key in keys if key in given}
    if not data:
        return None
    from cylcontact.files.spec import parse_spec
    from cylcontact.laws.housing_spec import HousingSpec

    _require_internal(source, contact, "leave out --R-o and --clamp, or give --contact internal")
    data |= data.pop("clamp", {})
    if "layer" in data:
        data["layers"] = data.pop("layer")
    with blaming_options(
        {"R_o": "--R-o", "angle": "--clamp", "shank": "--clamp", "layers": "--layer"}
    ):
        return parse_spec(HousingSpec, data, source)


def read_housing(given: dict[str, Any], source: str) -> Housing | None:
    """Return the housing that the options give with its numbers, and take them away."""
    housing = housing_of(given, source, given.get("contact", "internal"))
    if housing is None:
        return None
    return housing.with_numbers(_own_table(given, source), source, "--layer").housing


def _own_table(given: Mapping[str, Any], source: str) -> Path | None:
    from cylcontact.bodies.material import own_table

    return own_table(given.get("materials"), Path(), source, "--materials")


def _require_internal(source: str, contact: str, remedy: str) -> None:
    """Refuse for rollers what is for a pin and a hole."""
    require(contact == "internal", source, "--contact", contact, "has no pin and no hole", remedy)


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


def material_of(name: str, given: Mapping[str, Any], source: str, option: str) -> Material:
    """Return a material by its name."""
    from cylcontact.bodies.material import find_material, known_materials

    rows = known_materials(_own_table(given, source))
    return find_material(name, rows, source, option, "the tables of materials").material


def pair_of(given: Mapping[str, Any], source: str, find: str | None = None) -> CylinderPair:
    """Return the pair that options give; with `find` its clearance may be what is sought."""
    from cylcontact.bodies.pair import CylinderPair, roles

    contact, plane = given.get("contact", "internal"), given.get("plane", "strain")
    rule, remedy = "must be 'internal' or 'external'", "a pin in a hole, or two rollers"
    require(contact in CONTACTS, source, "--contact", contact, rule, remedy)
    rule, remedy = "must be strain or stress", "strain for long cylinders, stress for thin ones"
    require(plane in ("strain", "stress"), source, "--plane", plane, rule, remedy)
    constants, options = constants_of(given, source, contact)
    bodies = [
        _body(given, constants, options, source, of, role)
        for of, role in zip(("_i", "_j"), roles(contact), strict=True)
    ]
    dR, R_i, R_j = (constants.get(f"{name}_mm") for name in ("dR", "R_i", "R_j"))
    length = constants.get("length_mm")
    if find == "dR" and dR is None and R_j is None:
        dR = 1e-3 * (R_i or 1.0) if contact == "internal" else 2 * (R_i or 1.0)
    if sum(number is not None for number in (dR, R_i, R_j)) < 2 and find != "dR":
        missing = "--Ri" if R_i is None else "--Rj"
        rule = "is missing: two of --Ri, --Rj and --dR are needed"
        remedy = "give diameters (--hole-diameter, --pin-diameter), or a fit: --fit 20H7/g6"
        if contact == "external":
            rule, remedy = "is missing", "give the radii of both rollers; --Rj inf is a plane"
        raise InputError(source, missing, None, rule, remedy)
    with blaming_options(options, source):
        if R_i is not None and R_j is not None:
            require(dR is None, source, "dR", dR, "follows from the radii", "leave it out")
            build = CylinderPair.internal if contact == "internal" else CylinderPair.external
            return build(R_i, R_j, bodies[0], length, bodies[1], plane=plane)
        if R_i is None and R_j is not None:
            R_i = dR + R_j if contact == "internal" else dR - R_j
        gap = 1.0 if dR is None else dR  # sought, so that any value will do
        return CylinderPair.from_dR(contact, gap, bodies[0], length, R_i, bodies[1], plane=plane)


def _body(
    given: Mapping[str, Any],
    constants: Mapping[str, Any],
    options: Mapping[str, str],
    source: str,
    of: str,
    role: str,
) -> Material:
    """Return the material of one body: by name, by numbers, or of both bodies."""
    from cylcontact.bodies.material import Material

    names = {
        key: [name for name in (f"material{key}", f"E{key}_MPa", f"nu{key}") if name in constants]
        for key in ("", "_i", "_j")
    }
    own, both = names[of], names[""]
    if own and both:
        rule = f"is of both bodies, and {options[own[0]]} is of one"
        raise InputError(source, options[both[0]], None, rule, "give one option for each body")
    chosen = own or both
    option = option_of(role if role in PAIR else f"material{of}")
    if not chosen:
        remedy = "give e.g. --material 'low-carbon steel', or --pin and --hole"
        raise InputError(source, option, None, "is missing", remedy)
    name, *others = chosen
    if name.startswith("material"):
        if others:
            rule = f"is already given by {options[name]}"
            raise InputError(source, options[others[0]], None, rule, "leave it out")
        return material_of(constants[name], given, source, options[name])
    key = of if own else ""
    for needed in (f"E{key}_MPa", f"nu{key}"):
        missing = option_of(needed) if not key else option
        require(needed in constants, source, missing, None, "is missing", "give both E and ν")
    numbers = next((v for n, v in given.items() if option_of(n) == options[f"nu{key}"]), ())
    more = numbers[2:] if isinstance(numbers, tuple) else ()
    yields, expansion = (*more, None, None)[:2]
    with blaming_options({"nu": options[f"nu{key}"], "yield_stress": option}, source):
        E = f"{constants[f'E{key}_MPa']!r} MPa"
        return Material("", E, constants[f"nu{key}"], yields, expansion)
