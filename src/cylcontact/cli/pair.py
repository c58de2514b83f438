"""Options for a pair of cylinders, which `laws`, `fit` and others share.

What needs numbers is imported in the functions, as in all modules of the command line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, cast

from cylcontact.choices import CONTACTS, Contact, listed
from cylcontact.cli.options import Options, length, number, option, plain_numbers
from cylcontact.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.housing_spec import HousingSpec
    from cylcontact.materials import Material, MaterialRow
    from cylcontact.pair import CylinderPair

_PANEL = {"rich_help_panel": "The pair of cylinders"}


def _text(help: str, name: str) -> tuple[Any, Any]:
    return str | None, option(help, name, metavar="TEXT", **_PANEL)


def _number(help: str, name: str) -> tuple[Any, Any]:
    return float | None, number(help, name, **_PANEL)


def _length(help: str, name: str) -> tuple[Any, Any]:
    return float | None, length(help, name, **_PANEL)


# By their names as constants of a table, where they have one.
PAIR: Options = {
    "contact": _text(f"{listed(CONTACTS)}.", "--contact"),
    "pin": _text("The pin's material: its name, or E and ν, '207 GPa, 0.3'.", "--pin"),
    "hole": _text("The hole's material, in the same way.", "--hole"),
    "material": _text("Material of both bodies.", "--material"),
    "material_i": _text("Material of the first of two rollers.", "--material-i"),
    "material_j": _text("Material of the second of two rollers.", "--material-j"),
    "materials": _text("Your own materials; datasets/materials.csv by default.", "--materials"),
    "E_MPa": _text("Young's modulus of both bodies, MPa or e.g. '207 GPa'.", "--E"),
    "nu": _number("Poisson's ratio of both bodies.", "--nu"),
    "dR_mm": _length("ΔR: the radial clearance, or the sum of two rollers' radii.", "--dR"),
    "R_i_mm": _length("Radius R_i of the hole, or of the first roller.", "--Ri"),
    "R_j_mm": _length("Radius R_j of the pin, or of the second roller.", "--Rj"),
    "hole_diameter": _length("Diameter of the hole.", "--hole-diameter"),
    "pin_diameter": _length("Diameter of the pin.", "--pin-diameter"),
    "length_mm": _length("Axial length.", "--length"),
    "R_o": _length("Radius of the housing's rim; laws that know it take it.", "--R-o"),
    "clamp": _text("What is clamped: rim (all of it, by default), near:60 or far:60.", "--clamp"),
    "layer": (
        list[str] | None,
        option("A bonded ring, its material and inner radius; may be repeated.", "--layer",
               metavar="NAME:MM", **_PANEL),
    ),
}  # fmt: skip
# What stands for a constant under another name, and the factor from one to the other.
_OTHERS = {
    "pin": ("material_j", None),
    "hole": ("material_i", None),
    "hole_diameter": ("R_i_mm", 0.5),
    "pin_diameter": ("R_j_mm", 0.5),
}
# What a pair of rollers does not have.
OF_PIN_AND_HOLE = {*_OTHERS}
# Constants of one body alone.
_APART = {f"{name}_{of}" for of in "ij" for name in ("material", "nu")} | {"E_i_MPa", "E_j_MPa"}
# The options that `constants_of` takes.
IN_CONSTANTS = {*PAIR} - {"contact", "materials", "R_o", "clamp", "layer"}


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
) -> tuple[dict[str, float | str], dict[str, str]]:
    """Return the options as constants of a table, and the option that each comes from."""
    from cylcontact.materials import modulus_in_MPa

    values = {name: given[name] for name in given if name in IN_CONSTANTS and name not in _OTHERS}
    options = {name: option_of(name) for name in values}
    for name in filter(OF_PIN_AND_HOLE.__contains__, given):
        remedy = f"leave out {option_of(name)}; rollers have --material-i and --material-j"
        _require_internal(source, contact, remedy)
    for name, (constant, factor) in _OTHERS.items():
        if name not in given:
            continue
        rule, remedy = f"says the same as {options.get(constant)}", "keep one of them"
        require(constant not in values, source, option_of(name), given[name], rule, remedy)
        values[constant] = given[name] if factor is None else factor * given[name]
        options[constant] = option_of(name)
    for body in ("", "_i", "_j"):  # "E, ν" in the place of a name
        name, (E, nu) = f"material{body}", (f"E{body}_MPa", f"nu{body}")
        modulus, comma, ratio = str(values.get(name, "")).partition(",")
        if not comma:
            continue
        option = options[name]
        for key in {E, nu} & {*values}:
            rule = f"is given by {option} already"
            raise InputError(source, options[key], values[key], rule, "leave it out")
        numbers = plain_numbers([ratio.strip()])
        if numbers is None:
            rule, remedy = "is no material", 'write its name, or E and ν, e.g. "207 GPa, 0.3"'
            raise InputError(source, option, values[name], rule, remedy)
        del values[name]
        values |= {E: modulus.strip(), nu: numbers[0]}
        options |= {E: option, nu: option}
    for name in {"E_MPa", "E_i_MPa", "E_j_MPa"} & {*values}:
        values[name] = float(modulus_in_MPa(values[name], source, options[name]))
    return values, options


def housing_of(given: dict[str, Any], source: str, contact: str) -> HousingSpec | None:
    """Return the housing that the options give, and take them away."""
    R_o, clamp, layers = (given.pop(name, None) for name in ("R_o", "clamp", "layer"))
    if R_o is None and clamp is None and not layers:
        return None
    from cylcontact.housing_spec import HousingSpec, clamp_of, layers_of
    from cylcontact.spec import parse_spec

    _require_internal(source, contact, "leave out --R-o and --clamp, or give --contact internal")
    rule = f"is missing beside {'--layer' if clamp is None else '--clamp'}"
    require(R_o is not None, source, "--R-o", None, rule, "give the radius")
    data = {"R_o": R_o, **clamp_of(clamp or "rim", source)}
    if layers:
        data["layers"] = layers_of(layers, source)
    with blaming_options({"R_o": "--R-o", "angle": "--clamp", "layers": "--layer"}):
        return parse_spec(HousingSpec, data, source)


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
        names = [by_key[key] for key in keys]
        value = error.value
        where, remedy = source or error.source, error.remedy
        if any(name.endswith("diameter") for name in names):  # the radii are halves of these
            value = 2 * value if isinstance(value, int | float) else None
            remedy = "correct it, or exchange hole and pin"
        raise InputError(where, ", ".join(names), value, error.rule, remedy) from None


def pair_of(
    constants: Mapping[str, Any],
    options: Mapping[str, str],
    contact: str,
    rows: Mapping[str, MaterialRow],
    source: str,
    default: CylinderPair,
) -> CylinderPair:
    """Return the pair of some options; what they leave out is that of another pair."""
    from cylcontact.pair import CylinderPair, roles

    rule, remedy = "must be 'internal' or 'external'", "a pin in a hole, or two rollers"
    require(contact in CONTACTS, source, "--contact", contact, rule, remedy)
    kind = cast(Contact, contact)
    first, second = (
        _body(body, role, constants, options, rows, source, default.material_i)
        for body, role in zip("ij", roles(kind), strict=True)
    )
    dR, R_i, R_j = (constants.get(f"{name}_mm") for name in ("dR", "R_i", "R_j"))
    length = constants.get("length_mm", default.length)
    for name in ("dR_mm", "R_i_mm", "R_j_mm", "length_mm"):
        value = constants.get(name, 1.0)
        rule, remedy = "must be positive", "give it in mm"
        require(value > 0, source, options.get(name, ""), value, rule, remedy)
    with blaming_options(options, source):
        if R_i is not None and R_j is not None:
            require(dR is None, source, "dR", dR, "follows from the radii", "leave it out")
            build = CylinderPair.internal if kind == "internal" else CylinderPair.external
            return build(R_i, R_j, first, length, second)
        known = float(R_i or R_j or default.radii("the default")[0])
        if dR is None:
            dR = default.dR if kind == "internal" else 2 * known
        if R_i is None and R_j is not None:
            R_i = dR + R_j if kind == "internal" else dR - R_j
        return CylinderPair.from_dR(kind, dR, first, length, R_i or known, second)


def _body(
    body: str,
    role: str,
    constants: Mapping[str, Any],
    options: Mapping[str, str],
    rows: Mapping[str, MaterialRow],
    source: str,
    default: Material,
) -> Material:
    """Return the material of a body, its own or that of both, by its name or by E and ν."""
    from cylcontact.materials import Material, find_material

    common, own = (
        [name for name in (f"material{of}", f"E{of}_MPa", f"nu{of}") if name in constants]
        for of in ("", f"_{body}")
    )
    if own and common:
        rule = f"is of both bodies, and {options[own[0]]} is of one"
        name = common[0]
        raise InputError(source, options[name], constants[name], rule, "give each its own")
    of_other = [name for name in constants if name in _APART and name not in own]
    if of_other and not own:
        missing = option_of(role if role in ("pin", "hole") else f"material_{body}")
        rule, remedy = f"is missing beside {options[of_other[0]]}", f"name the {role}'s material"
        raise InputError(source, missing, None, rule, remedy)
    used = own or common
    if used and used[0].startswith("material"):
        name, *others = used
        for other in others:
            rule = f"is given by {options[name]} already"
            raise InputError(source, options[other], constants[other], rule, "leave it out")
        table = "the tables of materials"
        return find_material(constants[name], rows, source, options[name], table).material
    of = f"_{body}" if own else ""
    E, nu = constants.get(f"E{of}_MPa", default.E), constants.get(f"nu{of}", default.nu)
    blamed = {name.removesuffix("_MPa").removesuffix(of): options[name] for name in used}
    with blaming_options(blamed, source):
        return Material(f"the {role}" if own else default.name, f"{float(E)!r} MPa", nu)
