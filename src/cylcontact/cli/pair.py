"""Options for a pair of cylinders, which `check`, `fit` and others share.

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
    from cylcontact.bodies.iso286 import IsoFit
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
    if side not in ("pushed", "pulled"):
        raise ValueError
    return {"clamp": "sector", "angle": plain_number(angle), "side": side}


def _layer(text: str) -> dict[str, Any]:
    """Return the keys of a layer in a table [housing]: a material, and its inner radius.

    >>> _layer("bronze:12"), _layer("110 GPa, 0.3:15")
    ({'material': 'bronze', 'R_i': 12.0}, {'E': '110000.0 MPa', 'nu': 0.3, 'R_i': 15.0})
    """
    name, _, radius = text.rpartition(":")
    material = _material(name.strip())
    keys: dict[str, Any] = {"material": material}
    if isinstance(material, tuple):
        names = ("E", "nu", "yield_stress", "thermal_expansion")
        keys = dict(zip(names, material, strict=False))
        keys["E"] = f"{keys['E']!r} MPa"
    return keys | {"R_i": length_in_mm(radius)}


_NAMED = reader(
    _material,
    "is no material; write its name, or E, ν, yield stress, expansion: "
    "'207 GPa, 0.3, 350 MPa, 12e-6/K'",
)
_RADIUS = reader(_radius, "is not a length; give mm, or e.g. '40 um'")
_CLAMP = reader(_clamp, "is no clamp; write rim, lug, pushed:60 or pulled:60, with your angle")
_LAYER = reader(
    _layer, "is no material with an inner radius; write e.g. bronze:12, or '110 GPa, 0.3:12'"
)
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
    "dR_mm": _length("Radial clearance ΔR, half of that on the diameter; for rollers R_i + R_j.",
                     "--radial-clearance"),
    "R_i_mm": _length("Radius R_i of the hole or the first roller.", "--Ri"),
    "R_j_mm": (float | None, option("Radius R_j of the pin or the second roller; inf is a plane.",
               "--Rj", metavar="MM", parser=_RADIUS, **_PANEL)),
    "hole_diameter": _length("Diameter of the hole.", "--hole-diameter"),
    "pin_diameter": _length("Diameter of the pin.", "--pin-diameter"),
    "length_mm": _length("Axial length.", "--length"),
    "plane": _text("strain for long parts, stress for thin ones.", "--plane"),
    "R_o": (float | None, length("Radius of its rim.", "--R-o", **_HOUSING)),
    "clamp": (str | None, option("rim (by default), lug, pushed:60 or pulled:60.", "--clamp",
              metavar="TEXT", parser=_CLAMP, **_HOUSING)),
    "layer": (list[str] | None, option("Outer ring, from this radius; may be repeated.",
              "--layer", metavar="MATERIAL:MM", parser=_LAYER, **_HOUSING)),
}  # fmt: skip
# The pair of a command for joints: materials are named by body, or one for both.
_OF_TABLES = ("E_MPa", "nu", "material_i", "material_j")
_BOTH = "Material of both bodies; of two rollers two, --material A --material B."
JOINT: Options = {name: each for name, each in PAIR.items() if name not in _OF_TABLES} | {
    "material": (list[str] | None, option(_BOTH, "--material", metavar="TEXT", parser=_NAMED,
                 **_PANEL)),
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
    """Return the housing that the options give with its materials, and take them away."""
    housing = housing_of(given, source, given.get("contact", "internal"))
    if housing is None:
        return None
    with blaming_options({"R_o": "--R-o", "shank": "--clamp", "angle": "--clamp"}, source):
        return housing.built(_own_table(given, source), source, "--layer")


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


def pair_of(
    given: Mapping[str, Any], source: str, iso: IsoFit | None = None, free: bool = False
) -> CylinderPair:
    """Return the pair that options give: with the radii of a fit, or with its clearance `free`."""
    from cylcontact.bodies.pair import CylinderPair, roles

    contact, plane = given.get("contact", "internal"), given.get("plane", "strain")
    rule, remedy = "must be 'internal' or 'external'", "a pin in a hole, or two rollers"
    require(contact in CONTACTS, source, "--contact", contact, rule, remedy)
    rule, remedy = "must be strain or stress", "strain for long cylinders, stress for thin ones"
    require(plane in ("strain", "stress"), source, "--plane", plane, rule, remedy)
    given = _with_bodies(given, source, contact)
    if iso is not None:
        names = ("dR_mm", "R_i_mm", "R_j_mm", "hole_diameter", "pin_diameter")
        for name in filter(given.__contains__, names):
            rule = f"is given by --iso {iso.code}"
            raise InputError(source, option_of(name), given[name], rule, "leave one of them out")
        rule, remedy = f"has no fit (--iso {iso.code})", "leave out --contact, or --iso"
        require(contact == "internal", source, "--contact", contact, rule, remedy)
    constants, options = constants_of(given, source, contact)
    bodies = [
        _body(given, constants, options, source, of, role)
        for of, role in zip(("_i", "_j"), roles(contact), strict=True)
    ]
    length = constants.get("length_mm")
    if iso is not None:
        hole, pin = iso.middle
        return CylinderPair.internal(hole, pin, bodies[0], length, bodies[1], plane=plane)
    sizes: list[Any] = [constants.get(f"{name}_mm") for name in ("dR", "R_i", "R_j")]
    dR, R_i, R_j = sizes
    if free:
        for name, value in (("dR_mm", dR), ("R_j_mm", R_j)):
            rule, remedy = "is what is sought (size clearance)", "leave it out"
            require(value is None, source, options.get(name, ""), value, rule, remedy)
        rule, remedy = "is missing", "give the radius of the hole, or of the first roller"
        require(R_i is not None, source, "--Ri", None, rule, remedy)
        dR = R_i / 2 if contact == "internal" else 2 * R_i
    if sum(number is not None for number in (dR, R_i, R_j)) < 2:
        missing = "--Ri" if R_i is None else "--Rj"
        rule = "is missing: two of --Ri, --Rj and --radial-clearance are needed"
        remedy = "give diameters (--hole-diameter, --pin-diameter), or a fit: --iso 20H7/g6"
        if contact == "external":
            rule, remedy = "is missing", "give the radii of both rollers; --Rj inf is a plane"
        raise InputError(source, missing, None, rule, remedy)
    _require_sizes(constants, options, source, contact)
    with blaming_options(options, source):
        if R_i is not None and R_j is not None:
            require(dR is None, source, "dR", dR, "follows from the radii", "leave it out")
            build = CylinderPair.internal if contact == "internal" else CylinderPair.external
            return build(R_i, R_j, bodies[0], length, bodies[1], plane=plane)
        if R_i is None and R_j is not None:
            R_i = dR + R_j if contact == "internal" else dR - R_j
        return CylinderPair.from_dR(contact, dR, bodies[0], length, R_i, bodies[1], plane=plane)


def _with_bodies(given: Mapping[str, Any], source: str, contact: str) -> dict[str, Any]:
    """Return the options with the material of each roller, where --material is given twice."""
    materials = given.get("material")
    if not isinstance(materials, list):
        return dict(given)
    others = {name: value for name, value in given.items() if name != "material"}
    if len(materials) == 1:
        return others | {"material": materials[0]}
    rule, remedy = "is given more than once", "for a pin in a hole give --pin and --hole"
    good = contact == "external" and len(materials) == 2
    remedy = remedy if contact == "internal" else "two rollers have two materials at most"
    require(good, source, "--material", None, rule, remedy)
    return others | {"material_i": materials[0], "material_j": materials[1]}


def _require_sizes(
    constants: Mapping[str, Any], options: Mapping[str, str], source: str, contact: str
) -> None:
    """Refuse sizes of a pin in a hole that leave no clearance, with what to do."""
    if contact == "external":
        return
    R_i, R_j, dR = (constants.get(f"{name}_mm") for name in ("R_i", "R_j", "dR"))
    for name, value in (("R_i_mm", R_i), ("R_j_mm", R_j)):
        if value is not None and value < 0:
            rule, remedy = "must be positive", "a concave surface is the hole of internal contact"
            remedy += f": --Ri {-value:g}, with the smaller radius as --Rj"
            raise InputError(source, options[name], value, rule, remedy)
    touching = dR == 0 or (R_i is not None and R_i == R_j)
    if touching:
        key = options["dR_mm" if dR == 0 else "R_j_mm"]
        rule = "leaves no clearance, and the laws need one"
        remedy = "give the least clearance that the joint may have, e.g. --radial-clearance 1e-4"
        if dR is None:
            remedy += f" in place of {key}"
        raise InputError(source, key, dR, rule, remedy)


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
